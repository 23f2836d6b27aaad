// RayProjection: projects pieces (space_pieces.h) along a ray in any direction. The result is a net like that of a
// view, in which the ray passes through pixel (0, 0): a root of the ray is a point of the net with X = Y = 0.
//
//     const RayFrame ray(origin, direction, pixel);
//     const RayProjection projection(ray, placed_part);
//     net.SetDegrees(surface.degree_u, surface.degree_v);
//     projection.Project(piece, surface.rational, pieces.origin(piece.face), &net.net);
//     // X/W and Y/W of the net are the distances from the ray in pixels, and Q/W is the distance along the ray in mm.
//
//  1. With unit vectors n1 and n2 across the ray from O along d, the components of a homogeneous point (w·P, w) are
//     X = n1·(P − O)·w/pixel, Y = n2·(P − O)·w/pixel, W = w and Q = d·(P − O)·w. The three axes form a right-handed
//     frame as those of a camera do (view/camera.h), with d as `forward`. The size of a pixel in mm is a power of two
//     that depends on the size of the scene, so that models of all sizes are solved alike.
//  2. The net's errors bound the distance of each component from that of the exact surface and the exact line through
//     O along d. O and d are taken as exact; the bounds include the rounding of the axes.
//  3. The start is subtracted from the control points before anything else is computed, and the rounding error of this
//     subtraction is added afterwards. Near the start, the precision therefore does not depend on the distance of the
//     model's origin.
//  4. d must have a length of 1 within a few units in the last place.
#pragma once

#include "render/nurbs/bezier.h"
#include "render/rays/space_pieces.h"
#include "render/view/camera.h"

namespace facetless {

// An occurrence of a part, prepared for rays.
class PlacedPart {
 public:
  explicit PlacedPart(const Placement& placement);

  const Placement& placement() const { return placement_; }
  const Placement& inverse() const { return inverse_; }  // of the linear part; the translation is zero
  bool shifted_only() const { return shifted_only_; }
  double outward() const { return outward_; }  // −1 if the placement contains a reflection, else 1

 private:
  Placement placement_, inverse_;
  bool shifted_only_ = true;  // the linear part is the identity
  double outward_ = 1;
};

// A ray with two axes across it.
struct RayFrame {
  // Requires a direction of length 1 (law 4), and a pixel that is a power of two.
  RayFrame(Vec3 origin, Vec3 direction, double pixel);
  // An orthographic camera that looks along the ray, which passes through pixel (0, 0).
  CameraFrame camera;
};

// The size of a pixel for a scene, mm: a power of two between 1/2048 and 1/1024 of its diagonal; 1 without a diagonal.
double PixelOf(double diagonal_mm);

class RayProjection {
 public:
  RayProjection(const RayFrame& ray, const PlacedPart& part);

  // Projects a piece of the part. `face_origin` is SpacePieces::origin of its face. `net` must have the degrees of the
  // surface. Set `rational` if its weights differ.
  void Project(const SpacePiece& piece, bool rational, Vec3 face_origin, BezierNet* net) const;

 private:
  Vec3 right_, down_, forward_;  // in the part's coordinates
  Vec3 scale_;                   // the lengths of these three vectors
  Vec3 axes_[3];                 // the axes of the ray in model axes, unit vectors
  const PlacedPart* part_;
  // The start minus the translation of the part: in the part's coordinates, and the rounding error of the subtraction.
  Vec3 start_, lost_;
  // The linear part applied to start_, minus the start relative to the translation; model axes, mm.
  Vec3 rest_;
  double placed_error_ = 0;  // of rest_, mm
  double pixels_per_mm_ = 1;
};

}  // namespace facetless
