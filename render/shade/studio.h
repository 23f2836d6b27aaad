// The studio: the appearance of a surface under its lights. Private to render/shade.
//
//  1. All vectors are in viewer axes: x right, y up, z towards the viewer. The lights are fixed in these
//     axes.
//  2. The code uses only sums, products, quotients and square roots of doubles, in a fixed order.
#pragma once

#include "render/base/vec.h"

namespace facetless {

// The lighting for one view direction. In an orthographic view, all pixels have the same direction.
class StudioView {
 public:
  // `toward` is the unit vector from the surface to the eye.
  explicit StudioView(Vec3 toward);

  Vec3 toward() const { return toward_; }
  // Reflected light, linear, 0 … 1 per channel. `normal` is a unit vector with normal · toward >= 0; `albedo`
  // is linear.
  Vec3 Light(Vec3 normal, Vec3 albedo) const;

 private:
  Vec3 toward_, half_;  // half_: unit vector halfway between the eye and the key light
};

// The linear light of the studio's background.
Vec3 StudioBackground();

}  // namespace facetless
