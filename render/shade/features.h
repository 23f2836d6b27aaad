// Where a picture has edges: silhouettes and creases, found in the samples.
//
//  1. Between two neighbouring pixels there is a *jump* if one shows a surface and the other doesn't, or if
//  neither side's tangent
//     plane, extended to the other's ray, comes near the depth that is found there.
//  2. Between two neighbouring pixels there is a *crease* if they show different faces, no jump, and normals
//  (flipped to the viewer) that
//     differ by more than the given angle.
#pragma once

#include <cstdint>
#include <vector>

#include "render/trace/camera.h"
#include "render/trace/samples.h"

namespace facetless {

enum class Step : std::uint8_t { kNone, kCrease, kJump };

// What lies between pixels `a` and `b` (indices of horizontal, vertical or diagonal neighbours). cos_crease:
// of law 2's angle.
Step StepBetween(const SampleBuffer& samples, const CameraFrame& frame, std::size_t a, std::size_t b,
                 double cos_crease);

// The depth at which the ray through pixel `to` meets the tangent plane of the hit at pixel `from`, mm; NaN
// where they are parallel or `from` shows nothing.
double TangentDepth(const SampleBuffer& samples, const CameraFrame& frame, std::size_t from, std::size_t to);

}  // namespace facetless
