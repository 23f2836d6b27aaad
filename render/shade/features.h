// Edges in a picture: silhouettes and creases, found in the samples.
//
//  1. There is a *jump* between two neighbouring pixels if only one of them shows a surface, or if their
//     depths differ by more than a continuous surface would explain. A surface explains a change that lies
//     between the changes predicted by the two tangent planes (a kink or a bend), or that is at most twice
//     the smaller of them (the rim of a sphere bends like a square root, for which this is the bound). A
//     change of two pixel widths is always explained. A plane steeper than 30 pixel widths of depth per pixel
//     explains nothing by itself, because a grazing ray sees past its edge.
//  2. Between two neighbouring pixels there is a *crease* if they show different faces, no jump, and
//     normals (flipped to the viewer) whose angle has a smaller cosine than the one given.
#pragma once

#include <cstdint>
#include <vector>

#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

enum class Step : std::uint8_t { kNone, kCrease, kJump };

// The step between the pixels `a` and `b` (indices of horizontal, vertical or diagonal neighbours).
// `cos_crease` is the cosine of the angle of law 2.
Step StepBetween(const SampleBuffer& samples, const CameraFrame& frame, std::size_t a, std::size_t b,
                 double cos_crease);

}  // namespace facetless
