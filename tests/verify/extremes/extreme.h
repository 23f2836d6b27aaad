// An extreme: a model and views at the border of what numbers can do, what must come out of them, and what
// did.
//
//  1. Each extreme is rendered in all three precisions. Samples of each picture, those where renderers fail
//     among them, are judged by the oracle (tests/verify/oracle), which takes the model's patches and the
//     camera for exact.
//  2. A row fails if a certified sample is wrong; if `certified` precision certifies a face other than the
//     nearest; if certified samples of two precisions contradict each other anywhere in the picture; if a
//     picture holds a NaN or a normal that is not one; if fewer samples are certified than promised, or a
//     certified depth's stated bound is larger than promised; if a doubt has another name than those that the
//     row allows; if an error comes where none is expected, or another one, or none.
//  3. What is not certified may be wrong: it says so. How often it is, the table tells.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/trace/direct.h"

namespace facetless::extremes {

inline constexpr std::array<Precision, 3> kPrecisions = {Precision::kFast, Precision::kStandard,
                                                         Precision::kCertified};
inline constexpr std::array<const char*, 3> kPrecisionNames = {"fast", "standard", "certified"};

struct Extreme {
  std::string group = {}, input = {};
  std::string expected = {};  // in words
  std::function<Model()> model = {};
  std::function<std::vector<Camera>(const Model&)> cameras = {};
  // The least share of certified samples, in `fast`, `standard` and `certified`.
  std::array<double, 3> certified = {1, 1, 1};
  std::uint8_t doubts = 0;  // bits of Doubt that samples may have
  // The largest stated bound of a certified depth, mm, in `certified`.
  double depth_bound_mm = 0;
  std::optional<ErrorCode> error = {};  // what Validate or TraceDirect answers instead
  std::size_t judged = 60;              // samples of each picture
  bool by_hand = false;                 // too long for ctest: in the table only
};

// What came out in one precision, all views together.
struct Outcome {
  std::optional<Error> error;
  std::uint64_t samples = 0, hits = 0, leaves = 0, scene_bytes = 0;
  std::array<std::uint64_t, 3> certificates{};  // by Certificate
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};
  double bound_mm = 0;  // the largest that a certified depth states
  double milliseconds = 0;
  // Of the judged ones, by Certificate.
  std::array<std::uint64_t, 3> judged{}, wrong{};
  double off_mm = 0;                                 // the largest of a certified depth
  std::uint64_t undecided = 0, within_rounding = 0;  // certified ones that the oracle can't settle or that
                                                     // only the camera's rounding turns
  double CertifiedShare() const {
    return samples == 0 ? 0 : static_cast<double>(certificates[0]) / static_cast<double>(samples);
  }
};

struct Measurement {
  std::array<Outcome, 3> outcomes;    // by kPrecisions
  std::vector<std::string> failures;  // by law 2, one sentence each
};

Measurement Measure(const Extreme& extreme);

// All rows, in the table's order.
const std::vector<Extreme>& Catalogue();

}  // namespace facetless::extremes
