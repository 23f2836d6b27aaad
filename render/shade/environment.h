// The surroundings that mirrors, metals and glasses show where their rays meet nothing.
//
//  1. The built-in studio is a function of the direction in viewer axes (studio.h, law 1): a bright backdrop behind the
//     model, a dim room behind the viewer, a ceiling, a floor, and a soft box for each of the two lights. It moves with
//     the camera, as the lights do.
//  2. The code uses only sums, products, quotients and square roots of doubles, in a fixed order.
#pragma once

#include "render/base/vec.h"

namespace facetless {

// Linear light from a direction, which is a unit vector in viewer axes; it may exceed 1.
Vec3 StudioSurroundings(Vec3 direction);

}  // namespace facetless
