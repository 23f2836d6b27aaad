// Patterns that show how smooth a surface is: zebra stripes, isophotes, reflection lines.
//
//  1. A pattern depends on the normal (turned to the viewer), the direction to the eye, and reflection lines
//     on the position too; on nothing else. Where two faces meet with the same normal (G1) stripes meet, but
//     have a kink; where they share the curvature too (G2) stripes run through smoothly; where normals differ
//     (G0) stripes end.
//  2. Zebra: the reflected ray meets a sphere at infinity, striped by latitude about `axis` in equal angles.
//  3. Isophotes: lines of equal N·L, in equal steps of N·L. Both signs of L are kept apart.
//  4. Reflection: the reflected ray meets a tunnel of lamps: a cylinder about the model's centre along
//     `direction`, its radius the model's diagonal, with `lines` lines of light along it. Rays that meet it
//     farther than kFarthest diagonals along see no line.
//  5. A sample is in a stripe or not: only samples per pixel smooth the edges. No libm but sqrt: the same
//     bytes everywhere.
#pragma once

#include <cstdint>

#include "render/base/vec.h"
#include "render/inspect/inspection.h"

namespace facetless {

enum class Stripe : std::uint8_t { kLight, kDark, kNone };

class StripePattern {
 public:
  // The direction is resolved for the view; `bounds` are the model's. Requires a kind of law 1.
  StripePattern(const Inspection& inspection, const CameraFrame& frame, const Box3& bounds);

  // `normal` and `toward` (to the eye) are unit vectors in model axes with normal · toward >= 0.
  Stripe At(Vec3 position, Vec3 normal, Vec3 toward) const;

 private:
  Stripe AtReflection(Vec3 position, Vec3 mirrored) const;

  InspectionKind kind_;
  double count_;
  Vec3 direction_, across_, above_, center_;  // across and above: perpendicular to the direction
  double diagonal_;
};

}  // namespace facetless
