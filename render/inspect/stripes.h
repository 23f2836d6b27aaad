// Stripe patterns that show the smoothness of a surface: zebra stripes, isophotes and reflection lines.
//
//  1. A pattern depends only on the normal (oriented to the viewer) and the direction to the eye; reflection
//     lines also depend on the position. Where the normals of two faces differ (G0), stripes end at their
//     border. Where the normals agree (G1), stripes meet with a kink. Where the curvatures agree, too (G2),
//     stripes continue smoothly.
//  2. Zebra: the reflected ray meets a sphere at infinity with stripes of equal angles of latitude about
//     `axis`.
//  3. Isophotes: lines of equal N·L, in equal steps of N·L. Both signs are distinguished.
//  4. Reflection: the reflected ray meets a tunnel of lamps. The tunnel is a cylinder about the model's
//     centre along `direction`, whose radius is the model's diagonal, with `lines` lines of light along it.
//     Rays that meet it more than kFarthest diagonals away along its axis see no line.
//  5. A sample is either in a stripe or not. Only several samples per pixel smooth the borders. sqrt is the
//     only libm function used, so the bytes are the same on every machine.
#pragma once

#include <cstdint>

#include "render/base/vec.h"
#include "render/inspect/inspection.h"

namespace facetless {

enum class Stripe : std::uint8_t { kLight, kDark, kNone };

class StripePattern {
 public:
  // Makes the pattern of a view. `bounds` are the model's. Requires kZebra, kIsophotes or kReflection.
  StripePattern(const Inspection& inspection, const CameraFrame& frame, const Box3& bounds);

  // The stripe at a surface point. `normal` and `toward` (to the eye) are unit vectors in model axes with
  // normal · toward >= 0.
  Stripe At(Vec3 position, Vec3 normal, Vec3 toward) const;

 private:
  Stripe AtReflection(Vec3 position, Vec3 mirrored) const;

  InspectionKind kind_;
  double count_;
  Vec3 direction_, across_, above_, center_;  // across_ and above_ are perpendicular to direction_
  double diagonal_;
};

}  // namespace facetless
