// Solvers: methods that intersect a ray with parametric surfaces, by name.
//
//     const SolverInfo* info = FindSolver("bezier-clipping");
//     Result<std::unique_ptr<const Solver>> solver = info->make(scene, 0, execution);
//     if (!solver) return solver.error();
//     const auto state = solver.value()->MakeState();  // one for each thread
//     for each row: solver.value()->BeginRow(row, *state);
//       for each ray: state->BeginRay();
//         for each piece that the ray may meet:
//           solver.value()->Solve(ray, StartOf(piece), *state);  // appends to state->roots
//
//  1. A solver is prepared for one SolverScene, and is immutable afterwards. Any number of threads may use it, each with a
//     state of its own.
//  2. Solve appends the roots that it finds to state.roots, and counts in state.counters why it stopped. A root need not
//     lie inside the trimmed face, and the same root may be found from two pieces. The caller drops the former, and
//     takes the nearest of the others.
//  3. The roots depend on the ray, on the start, and on the rays of the same row that were solved before it, from left to
//     right. They depend neither on the number of threads nor on other rows. A solver whose source uses random numbers
//     derives them from the ray and the start.
//  4. The work of a ray is bounded: Solve takes one unit of state.work_left for each evaluation or subdivision of a
//     surface, and stops with kWork when it needs one and none is left.
//  5. A root is finite, and its parameters lie in [0,1] of its patch, or outside by no more than kRootBorder.
//  6. No solver proves that a ray has no further root. SolverInfo says what each one does not promise.
//     render/trace/direct.h traces proven images.
//  7. A solver that claims a degree works for every pair of degrees up to it.
//
// A new solver needs one file and one row of BuiltIn() (solver.cpp). Programs outside this library register theirs:
//
//   const RegisterSolver kMine({.name = "mine", .title = "Mine", .source = "...", ..., .make = MakeMine});
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/solve/solver_scene.h"
#include "render/solve/solver_terms.h"

namespace facetless {

// A root on the border of a patch may lie outside of it by this much, in parameters of the patch.
inline constexpr double kRootBorder = 1e-8;

// The evaluations and subdivisions that a ray may use. Most rays need far fewer. The limit ends searches that do not
// converge, such as clipping at a double root.
inline constexpr std::int64_t kMostRayWork = 20'000;

struct SolverRay {
  int column = 0, row = 0;
  // Pixel coordinates of the ray, relative to the image centre. The ray is the intersection of the planes
  // X − x·W = 0 and Y − y·W = 0 of projected nets.
  double x = 0, y = 0;
  // The same ray in space, relative to SolverScene::origin. The component of the direction along the view is 1.
  Vec3 origin, direction;
};

// What a surface is for a solver: a Bézier patch, with parameters in [0,1], or a whole face. The parameters of a face run
// from 0 to the number of its patches in each direction: patch (i, j) covers [i, i+1] × [j, j+1].
enum class SolverUnit : std::uint8_t { kPatch, kFace };

// A part of a surface in which rays look for roots.
struct SolverPiece {
  std::uint32_t surface = 0;  // index into SolverScene::patches or SolverScene::faces, as the unit says
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  Box3 box;  // holds the surface over this rectangle; relative to SolverScene::origin, mm
};

// Where a solve begins.
struct SolverStart {
  std::uint32_t surface = 0;
  double u = 0.5, v = 0.5;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;  // the piece
  bool from_map =
      false;  // (u,v) comes from the map of preliminary values; else it is the middle of the piece
};
inline SolverStart StartOf(const SolverPiece& piece) {
  return {piece.surface,
          0.5 * (piece.u_low + piece.u_high),
          0.5 * (piece.v_low + piece.v_high),
          piece.u_low,
          piece.u_high,
          piece.v_low,
          piece.v_high,
          false};
}

struct SolverRoot {
  std::uint32_t patch = 0;  // index into SolverScene::patches
  double u = 0, v = 0;      // parameters of the patch
};

// What a thread needs for its rays. A solver that needs more derives its own state from this one.
struct SolverState {
  virtual ~SolverState() = default;

  void BeginRay() {
    roots.clear();
    work_left = kMostRayWork;
    nearest = INFINITY;
  }
  // Takes one unit of work. Returns false if none is left.
  bool Work() { return work_left-- > 0; }
  // Counts the end of a solve.
  void End(SolverStop stop) { ++counters.stops[static_cast<std::size_t>(stop)]; }
  void AddRoot(const SolverRoot& root) {
    roots.push_back(root);
    ++counters.roots;
  }

  std::vector<SolverRoot> roots;  // of the present ray
  std::int64_t work_left = 0;
  double nearest = INFINITY;  // depth of the nearest hit of the ray so far; the caller sets it
  SolverCounters counters;
};

class Solver {
 public:
  virtual ~Solver() = default;

  // The parts in which rays look for roots. They cover all of the scene's surfaces.
  virtual std::span<const SolverPiece> pieces() const = 0;
  // Memory of the solver, its pieces included, without the scene.
  virtual std::uint64_t bytes() const = 0;

  virtual std::unique_ptr<SolverState> MakeState() const { return std::make_unique<SolverState>(); }
  // Begins a row of rays, which are solved from left to right.
  virtual void BeginRow(int row, SolverState& state) const;
  // Requires a start whose surface is one of the scene's.
  virtual void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const = 0;
};

struct SolverInfo {
  std::string name;      // of [a-z0-9-], unique
  std::string title;     // "Bézier clipping"
  std::string source;    // where the method is described: authors, year, equations
  std::string does;      // one sentence
  std::string does_not;  // one sentence: what the method does not promise
  SolverUnit unit = SolverUnit::kPatch;
  SolverStarts starts = SolverStarts::kPieces;  // where it begins if the caller does not say
  bool takes_map = false;                       // whether it may begin at a value of the map
  int max_degree = kMaxDegree;                  // the highest degree that it claims, in each direction
  bool rational = true;                         // whether it claims rational surfaces
  // The distance from the ray, in pixels, within which the method means its roots to lie. `does_not` and the header of the
  // method name the cases in which they are less exact.
  double tolerance_px = 1e-8;
  // Prepares the solver. The scene must outlive it. `max_bytes`: 0 means no limit. Requires that the solver claims the
  // degrees and the weights of the scene (CheckClaims).
  // Errors: kLimitExceeded (`max_bytes`), kCancelled.
  Result<std::unique_ptr<const Solver>> (*make)(const SolverScene& scene, std::uint64_t max_bytes,
                                                const Execution& execution) = nullptr;
};

// All solvers, built in and registered, in the order of their registration.
std::vector<const SolverInfo*> Solvers();
// Returns null if there is none of that name.
const SolverInfo* FindSolver(std::string_view name);

// Error: kBadUsage (the scene has a degree, or weights, that the solver does not claim; the message names the face and the
// methods that claim them).
Result<void> CheckClaims(const SolverInfo& info, const SolverScene& scene);

// Registers a solver for the rest of the program. It must be a variable of static duration. It throws
// std::invalid_argument if the name is malformed or taken, or if `make` is missing, which ends the program before main.
class RegisterSolver {
 public:
  explicit RegisterSolver(SolverInfo info);
};

}  // namespace facetless
