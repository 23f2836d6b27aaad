// The studio: how a surface looks under its two lights. Private to shade/.
//
//  1. All vectors are in the viewer's axes: x right, y up, z towards the viewer. The lights stand still
//     there.
//  2. Sums, products, quotients and square roots of doubles only, in a fixed order.
#pragma once

#include "render/model/vec.h"

namespace facetless {

// Reflected light, linear, 0 … 1 per channel. `normal` and `view` are unit vectors with normal · view >= 0;
// `view` points from the surface to the eye; `albedo` is linear.
Vec3 StudioLight(Vec3 normal, Vec3 view, Vec3 albedo);

// Linear light of the studio's background.
Vec3 StudioBackground();

}  // namespace facetless
