// Methods: ways to make a representation of a model, by name. `compare --with NAME` compares any of them with
// the exact surfaces beside the baseline, and `trade --with NAME` measures each at all of its settings.
//
//  1. A method's name is of [a-z0-9-] and no other method's, nor "direct", "baseline" or "difference": it
//     stands in names of files and in roles of the report.
//  2. A method that has a setting (a resolution, a size) names its usual values, coarse first; one that has
//     none is measured once.
//  3. What a method needs to begin with is the model as exact surfaces.
//
// A new method is one file and one row of kBuiltIn (method.cpp). Programs outside this library register
// theirs:
//
//   const RegisterMethod kPoints({.name = "points", .title = "Points", .help = "...", .make = MakePoints});
#pragma once

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
#include "render/trace/direct.h"

namespace facetless {

// What a method makes a representation of; all of it must outlive the representation.
struct MethodInput {
  const Scene& scene;
  const DirectOptions& direct;        // how the reference traces the exact surfaces, sections included
  std::string name = {}, title = {};  // of the representation
  Execution execution;
  std::uint64_t max_bytes = 0;  // what the representation may hold
};

struct Method {
  std::string name;           // law 1
  std::string title;          // for people: "Voxels"
  std::string help;           // one sentence
  std::string setting;        // what its number is, with its unit: "cells per axis"; empty: it has none
  std::vector<double> usual;  // law 2; the first is used where no number is given
  // Errors: kBadUsage (the number, or sections that the method cannot cut), kLimitExceeded, kCancelled.
  std::function<Result<std::unique_ptr<const Representation>>(const MethodInput& input, double setting)> make;
};

// A method and the number that it is used with.
struct MethodChoice {
  const Method* method = nullptr;
  double setting = 0;  // meaningless for a method without one
  bool given = false;  // false: `setting` is the method's usual one

  // The method's name, and its number where it has one: "voxels-128". A role in reports, and part of names of
  // files.
  std::string Name() const;
  // "Voxels 128".
  std::string Title() const;
};

// All methods, built in and registered, by name.
std::vector<const Method*> Methods();

// Reads "NAME" or "NAME:NUMBER". Error: kBadUsage names the methods that there are.
Result<MethodChoice> ParseMethod(const std::string& text);
// "voxels:128", as ParseMethod reads it.
std::string FormatMethod(const MethodChoice& choice);

// The representation, under the name and the title of the choice. Errors: those of Method::make.
Result<std::unique_ptr<const Representation>> MakeRepresentation(const MethodChoice& choice,
                                                                 MethodInput input);

// Registers a method for the rest of the program, from a variable of static duration. Throws
// std::invalid_argument where law 1 or 2 is broken, which ends the program before it begins.
class RegisterMethod {
 public:
  explicit RegisterMethod(Method method);
};

}  // namespace facetless
