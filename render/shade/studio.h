// The studio: the appearance of a surface under its lights. Private to render/shade.
//
//  1. All vectors are in viewer axes: x right, y up, z towards the viewer. The lights are fixed in these
//     axes.
//  2. The code uses only sums, products, quotients and square roots of doubles, in a fixed order.
#pragma once

#include "render/base/vec.h"

namespace facetless {

// The share of the light that arrives at a point.
struct LightShare {
  bool shadows = false;  // `key` is known
  double key = 1;        // of the key light, 0 … 1
  double open = 1;       // of all other light, 0 … 1
};

// The lighting for one view direction. In an orthographic view, all pixels have the same direction.
class StudioView {
 public:
  // `toward` is the unit vector from the surface to the eye.
  explicit StudioView(Vec3 toward);

  Vec3 toward() const { return toward_; }
  // Reflected light, linear, 0 … 1 per channel. `normal` is a unit vector with normal · toward >= 0; `albedo`
  // is linear.
  Vec3 Light(Vec3 normal, Vec3 albedo) const;
  // The same where only a part of the light arrives. A key light that casts shadows ends at the terminator: it is not
  // wrapped around the surface.
  Vec3 Light(Vec3 normal, Vec3 albedo, const LightShare& share) const;

 private:
  double KeyHighlight(Vec3 normal) const;
  double Rim(Vec3 normal) const;

  Vec3 toward_, half_;  // half_: unit vector halfway between the eye and the key light
};

// The linear light of the studio's background.
Vec3 StudioBackground();

// The direction towards the key light, a unit vector in viewer axes.
Vec3 KeyDirection();

// The curve by which light becomes what is shown, per channel: 0 … 1, unchanged up to a shoulder.
Vec3 StudioTone(Vec3 light);

// The share of the light of a horizontal floor that arrives, 0 … 1, if the key light shines on it from above with the
// cosine `key_cosine` to the floor's normal.
double FloorLight(double key_cosine, const LightShare& share);

}  // namespace facetless
