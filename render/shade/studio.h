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
  bool shadows = false;  // whether shadows are cast; if not, all of the key light arrives
  double key = 1;        // share of the key light, 0 … 1
  double open = 1;       // share of all other light, 0 … 1
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
  // The same where only a share of the light arrives. If shadows are cast, the key light lights only surfaces that face
  // it; without shadows, it also reaches a little around the surface.
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

// The tone curve, per channel: maps linear light, which may exceed 1, to 0 … 1. Values below a shoulder do not change.
Vec3 StudioTone(Vec3 light);

// The light that arrives at the floor, as a share of its light without any shadow and occlusion, 0 … 1. `key_cosine`
// is the cosine of the angle between the floor's normal and the direction towards the key light; below 0, the floor
// gets no key light.
double FloorLight(double key_cosine, const LightShare& share);

}  // namespace facetless
