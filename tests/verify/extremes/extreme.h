// An extreme: a model and views at the limits of numbers, with the expected and the measured results.
//
//  1. Each extreme is rendered in all three precisions. The oracle (tests/verify/oracle), which takes the
//     model's patches and the camera as exact, judges samples of each picture, including those where
//     renderers usually fail.
//  2. A row fails in these cases: a certified sample is wrong; `certified` precision certifies a face other
//     than the nearest; certified samples of two precisions contradict each other anywhere in the picture; a
//     picture contains a NaN or a normal that is not of unit length; fewer samples are certified than
//     promised; a certified depth's stated bound is larger than promised; a doubt has another reason than
//     those that the row allows; an error occurs where none is expected, or the expected error does not
//     occur.
//  3. A sample without a certificate may be wrong. The table lists how often.
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
  // The smallest allowed share of certified samples, in `fast`, `standard` and `certified`.
  std::array<double, 3> certified = {1, 1, 1};
  std::uint8_t doubts = 0;  // bits of Doubt that samples may have
  // The largest allowed bound of a certified depth, mm, in `certified`.
  double depth_bound_mm = 0;
  std::optional<ErrorCode> error = {};  // the expected answer of Validate or TraceDirect
  std::size_t judged = 60;              // samples of each picture
  bool by_hand = false;                 // takes too long for ctest: only in the table
};

// The results in one precision, over all views.
struct Outcome {
  std::optional<Error> error;
  std::uint64_t samples = 0, hits = 0, leaves = 0, scene_bytes = 0;
  std::array<std::uint64_t, 3> certificates{};  // by Certificate
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};
  double bound_mm = 0;  // the largest bound that a certified depth states
  double milliseconds = 0;
  // Of the judged samples, by Certificate.
  std::array<std::uint64_t, 3> judged{}, wrong{};
  double off_mm = 0;                                 // the largest error of a certified depth
  std::uint64_t undecided = 0, within_rounding = 0;  // certified ones that the oracle can't settle or that
                                                     // only the camera's rounding turns
  double CertifiedShare() const {
    return samples == 0 ? 0 : static_cast<double>(certificates[0]) / static_cast<double>(samples);
  }
};

struct Measurement {
  std::array<Outcome, 3> outcomes;    // by kPrecisions
  std::vector<std::string> failures;  // violations of law 2, one sentence each
};

Measurement Measure(const Extreme& extreme);

// Returns all rows, in the table's order.
const std::vector<Extreme>& Catalogue();

}  // namespace facetless::extremes
