// Where a picture has edges: silhouettes and creases, found in the samples.
//
//  1. Between two neighbouring pixels there is a *jump* if one shows a surface and the other doesn't, or if
//     the change of depth is more than a surface there would explain. What explains it: the change that the
//     two tangent planes predict, if it lies between them (a kink, a bend), or up to twice the smaller of
//     them (the rim of a sphere bends like a square root, for which this is the bound). Two pixels' width
//     of depth are always explained; a plane steeper than 30 pixels of depth per pixel explains nothing
//     alone, since a ray that grazes it sees past its edge.
//  2. Between two neighbouring pixels there is a *crease* if they show different faces, no jump, and
//     normals (flipped to the viewer) whose angle has a smaller cosine than the one given.
#pragma once

#include <cstdint>
#include <vector>

#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

enum class Step : std::uint8_t { kNone, kCrease, kJump };

// What lies between pixels `a` and `b` (indices of horizontal, vertical or diagonal neighbours).
// cos_crease: of law 2's angle.
Step StepBetween(const SampleBuffer& samples, const CameraFrame& frame, std::size_t a, std::size_t b,
                 double cos_crease);

}  // namespace facetless
