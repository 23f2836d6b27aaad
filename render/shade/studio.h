// The studio: how a surface looks under its two lights. Private to shade/.
//
//  1. All vectors are in the viewer's axes: x right, y up, z towards the viewer. The lights stand still
//     there.
//  2. Sums, products, quotients and square roots of doubles only, in a fixed order.
#pragma once

#include "render/base/vec.h"

namespace facetless {

// What the lights do for one direction of view: everybody's in an orthographic view.
class StudioView {
 public:
  // `toward`: unit, from the surface to the eye.
  explicit StudioView(Vec3 toward);

  Vec3 toward() const { return toward_; }
  // Reflected light, linear, 0 … 1 per channel. `normal` is a unit vector with normal · toward >= 0; `albedo`
  // is linear.
  Vec3 Light(Vec3 normal, Vec3 albedo) const;

 private:
  Vec3 toward_, half_;  // half_: between the eye and the key light, unit
};

// Linear light of the studio's background.
Vec3 StudioBackground();

}  // namespace facetless
