// What a method gets wrong in a view, sample by sample, judged by the certified samples of the same camera.
//
//     const HitErrors errors = JudgeHits({certified, frame}, samples, info.tolerance_px);
//     Print(errors.lost, errors.invented, errors.imprecise);
//     MarkHitErrors(errors, &picture);
//
//  1. A sample is judged if the reference has a certificate for it. The distance of two hits is measured along the
//     normal of the reference: the difference of the depths times the cosine between the ray and the normal.
//  2. A hit is *lost* if the method shows nothing, or a hit farther away. It is *invented* if the reference shows nothing,
//     or a hit farther away. Two hits count as different if they are at least kOtherRootPx pixels apart: along the normal
//     if they lie on the same face, and otherwise along the ray.
//  3. A hit is *imprecise* if it is the right one, but off by more than the sum of the tolerance that the method states
//     (times kToleranceSlack, since the surface is curved) and the depth error of the reference.
//  4. A sample is *unresolved* if the method says so itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/image/film.h"
#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

inline constexpr double kOtherRootPx = 0.5;
inline constexpr double kToleranceSlack = 4;

enum class HitError : std::uint8_t { kNone, kLost, kInvented, kImprecise, kUnresolved, kNotJudged };
inline constexpr std::array<const char*, 6> kHitErrorNames = {"none",      "lost",       "invented",
                                                              "imprecise", "unresolved", "not_judged"};

struct HitErrors {
  int width = 0, height = 0;
  std::vector<HitError> of;  // each sample
  std::array<std::uint64_t, kHitErrorNames.size()> counts{};
  double largest_px = 0;  // the largest distance among the hits without an error, in pixels

  std::uint64_t count(HitError error) const { return counts[static_cast<std::size_t>(error)]; }
  // The samples that are wrong, or that the method left open.
  std::uint64_t wrong() const {
    return count(HitError::kLost) + count(HitError::kInvented) + count(HitError::kImprecise) +
           count(HitError::kUnresolved);
  }
};

// The certified samples of a view. They need their certificates; their depth errors are used if they have them.
struct HitReference {
  const SampleBuffer& samples;
  const CameraFrame& frame;
};

// Requires samples of the same size.
HitErrors JudgeHits(const HitReference& reference, const SampleBuffer& samples, double tolerance_px);

// Turns a picture grey, which has a pixel for each sample, and marks each error by a square of 3×3 pixels: lost
// vermilion, invented blue, imprecise yellow, unresolved purple (M. Okabe and K. Ito's colours, which colour-blind
// people can tell apart).
void MarkHitErrors(const HitErrors& errors, Image8* picture);

}  // namespace facetless
