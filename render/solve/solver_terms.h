// The terms that solvers (solver.h), options and reports share: where solves begin, why they end, and what is counted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace facetless {

// Where solves begin.
enum class SolverStarts : std::uint8_t {
  kPieces,        // in the pieces that the ray meets, which an acceleration structure finds
  kMap,           // at the value of the wide map of preliminary values (value_map.h, law 1)
  kPublishedMap,  // the same with 8 bits for each number, and at most 255 surfaces, as in the thesis
};
inline constexpr std::array<const char*, 3> kSolverStartsNames = {"pieces", "map", "published-map"};

// Why a solve ended.
enum class SolverStop : std::uint8_t {
  kRoot,      // with at least one root
  kNoRoot,    // the method found that there is none
  kDiverged,  // the residual grew, or did not become small
  kLeft,      // the iterate, or the root, lies outside the surface
  kSingular,  // the equations have no unique solution at the iterate
  kSteps,     // the method reached its own limit of steps, or of roots
  kWork,      // no work was left for the ray (solver.h, law 4)
};
inline constexpr std::array<const char*, 7> kSolverStopNames = {"root",     "no_root", "diverged", "left",
                                                                "singular", "steps",   "work"};

struct SolverCounters {
  std::uint64_t solves = 0, iterations = 0, roots = 0;
  std::array<std::uint64_t, kSolverStopNames.size()> stops{};

  void Add(const SolverCounters& other) {
    solves += other.solves;
    iterations += other.iterations;
    roots += other.roots;
    for (std::size_t i = 0; i < stops.size(); ++i) stops[i] += other.stops[i];
  }
};

}  // namespace facetless
