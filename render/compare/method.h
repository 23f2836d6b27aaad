// Methods: named ways to make a representation of a model. `compare --with NAME` compares a method with the
// exact surfaces, in addition to the baseline, and `trade --with NAME` measures it at all of its usual
// settings.
//
//  1. The name of a method consists of [a-z0-9-] and is unique; it is not "direct", "baseline" or
//     "difference". File names and roles of the report contain it.
//  2. A method with a setting (a resolution, a size) lists its usual values, coarse first. A method without a
//     setting is measured once.
//  3. A method starts from the model as exact surfaces.
//  4. Every solver of render/solve/solver.h is a method of the same name, without a row of its own.
//
// A new method needs one file and one row of BuiltIn() (method.cpp). Programs outside this library register
// their methods:
//
//   const RegisterMethod kPoints({.name = "points", .title = "Points", .help = "...", .make = MakePoints});
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/compare/representation.h"
#include "render/model/model.h"
#include "render/solve/solver_trace.h"
#include "render/trace/direct.h"

namespace facetless {

// Where the normals of voxels come from: from the exact surfaces that touch them, from the mean direction to empty voxels,
// or from the side through which a ray enters.
enum class VoxelNormals : std::uint8_t { kExact, kGrid, kSide };
inline constexpr std::array<const char*, 3> kVoxelNormalsNames = {"exact", "grid", "side"};

// How voxels are held and shown.
struct VoxelLook {
  std::string encoding = "octree";  // a name of VoxelEncodings()
  VoxelNormals normals = VoxelNormals::kExact;
};

// The input of a method. All references must outlive the representation.
struct MethodInput {
  const Scene& scene;
  const DirectOptions&
      direct;  // the options with which the reference traces the exact surfaces, sections included
  std::string name = {}, title = {};  // of the representation
  Execution execution;
  std::uint64_t max_bytes = 0;  // memory limit of the representation
  SolverOptions solver = {};    // for methods that are solvers; max_bytes is the one above
  VoxelLook voxels = {};        // for the method voxels
};

struct Method {
  std::string name;                    // law 1
  std::string title;                   // readable name: "Voxels"
  std::string help;                    // one sentence: what the method does
  std::string source = {};             // where it is described
  std::string does_not = {};           // one sentence: what it does not promise
  const SolverInfo* solver = nullptr;  // law 4; null: it is not a solver
  std::string setting =
      {};  // meaning and unit of its number: "cells per axis"; empty: the method has no number
  std::vector<double> usual = {};  // usual values (law 2); the first is the default
  // Errors: kBadUsage (the number, or sections that the method cannot cut), kLimitExceeded, kCancelled.
  std::function<Result<std::unique_ptr<const Representation>>(const MethodInput& input, double setting)>
      make = nullptr;
};

// A method and its setting.
struct MethodChoice {
  const Method* method = nullptr;
  double setting = 0;  // meaningless for a method without one
  bool given = false;  // false: `setting` is the default of the method

  // The name of the method and its number, if it has one: "voxels-128". It is used as a role in reports and
  // as a part of file names.
  std::string Name() const;
  // The readable name, such as "Voxels 128".
  std::string Title() const;
};

// All methods, built in and registered, by name.
std::vector<const Method*> Methods();

// The names of all methods: "fast, voxels:NUMBER".
std::string MethodNames();

// Parses "NAME" or "NAME:NUMBER". `option` is the name of the option in error messages. Error: kBadUsage, which lists
// the methods.
Result<MethodChoice> ParseMethod(const std::string& text, const std::string& option = "with");
// The method of the project's own tracer, whose name is "certified".
const Method& CertifiedMethod();

// The text form, such as "voxels:128", which ParseMethod reads.
std::string FormatMethod(const MethodChoice& choice);

// Makes the representation, with the name and the title of the choice. Errors: the errors of Method::make.
Result<std::unique_ptr<const Representation>> MakeRepresentation(const MethodChoice& choice,
                                                                 MethodInput input);

// Registers a method for the rest of the program. It must be a variable of static duration. It throws
// std::invalid_argument if law 1 or 2 is violated, which ends the program before main.
class RegisterMethod {
 public:
  explicit RegisterMethod(Method method);
};

}  // namespace facetless
