// What the methods by name (render/solve/solver.h, and `fast`) make of the extremes: docs/method-extremes.md.
//
//  1. Each picture of a row is rendered with `certified`, with `fast` and with every solver, with at most `size` pixels in
//     each direction. An odd number of pixels stays odd, so that rays through the middle stay there.
//  2. A sample that `certified` has proven judges those of the methods (render/compare/hit_errors.h): they are lost,
//     invented, imprecise, or open. Where `certified` is in doubt, the oracle judges some samples of each picture
//     (kJudgedDoubts): a hit that is no crossing is invented; a missing hit, or one behind a crossing that certainly counts,
//     is lost; a hit that is off a crossing by more than kDoubtShare of the model's diagonal, but not by the half pixel
//     that tells roots apart, is imprecise.
//  3. A sample that is not a number is a failure, whatever the method is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/verify/extremes/extreme.h"

namespace facetless::extremes {

inline constexpr std::size_t kJudgedDoubts = 8;
inline constexpr double kDoubtShare = 1e-6;

struct MethodMeasureOptions {
  int size = 33;
  std::vector<std::string> methods = {};  // empty: all
};

// The results of one method, over all views of a row.
struct MethodOutcome {
  std::string method;
  std::optional<Error> error;
  std::uint64_t lost = 0, invented = 0, imprecise = 0, open = 0;
  std::uint64_t not_numbers = 0;
  double milliseconds = 0;
  std::uint64_t wrong() const { return lost + invented + imprecise + open; }
};

struct MethodMeasurement {
  std::optional<Error> error;  // of the model, or of `certified`: then there are no outcomes
  std::uint64_t samples = 0, doubts = 0, judged_doubts = 0;
  std::vector<MethodOutcome> outcomes;  // in the order of MethodNames()
};

// "fast", and the names of all solvers.
std::vector<std::string> MethodNames();

MethodMeasurement MeasureMethods(const Extreme& extreme, const MethodMeasureOptions& options);

}  // namespace facetless::extremes
