// RayProjection: a ray in any direction as two planes through it. The net of a piece (space_pieces.h), projected onto
// the two planes, becomes a net of two unknowns like that of a view, in which the ray passes through pixel (0, 0).
//
//     const RayFrame ray(origin, direction, pixel);
//     const RayProjection projection(ray, placed);
//     projection.Project(piece, degree_u, degree_v, rational, pieces.origin(piece.face), &net);
//     // now net.X/W and net.Y/W are pixels off the ray, and net.Q/W is the distance along it in mm
//
//  1. With unit vectors n1 and n2 across the ray from O along d, the components of a homogeneous point (w·P, w) are
//     X = n1·(P − O)·w/pixel, Y = n2·(P − O)·w/pixel, W = w and Q = d·(P − O)·w. The three axes form a right-handed
//     frame as those of a camera (view/camera.h), with d as `forward`. A pixel is a power of two of millimetres, chosen
//     by the size of the scene, so that models of all sizes are solved alike.
//  2. The net's errors bound the distance of each component from that of the exact surface and the exact line through
//     O along d, where O and d are the numbers given, whatever the rounding of the axes.
//  3. The start is subtracted from control points before anything else, and what is lost in that is added afterwards:
//     near the start nothing depends on how far the model's origin is.
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
  double outward() const { return outward_; }  // −1 if the placement mirrors

 private:
  Placement placement_, inverse_;
  bool shifted_only_ = true;  // the linear part is the identity
  double outward_ = 1;
};

// A ray with two axes across it.
struct RayFrame {
  // Requires a direction of length 1 (law 4), and a pixel that is a power of two.
  RayFrame(Vec3 origin, Vec3 direction, double pixel);
  // As a camera that looks along the ray: orthographic, the ray at pixel (0, 0).
  CameraFrame camera;
};

// The pixel of a scene: about a thousandth of its diagonal.
double PixelOf(double diagonal_mm);

class RayProjection {
 public:
  RayProjection(const RayFrame& ray, const PlacedPart& part);

  // Projects a piece of the part. `face_origin` is that of its face. `net` has the degrees of the piece.
  void Project(const SpacePiece& piece, bool rational, Vec3 face_origin, BezierNet* net) const;

 private:
  Vec3 right_, down_, forward_;  // in the part's coordinates
  Vec3 scale_;                   // their lengths
  Vec3 axes_[3];                 // the ray's own
  const PlacedPart* part_;
  // The start less the translation of the part, in the part's coordinates, and what was lost in computing it.
  Vec3 start_, lost_;
  Vec3 rest_;  // of the linear part: what the placement of start_ differs from the start by, model axes
  double placed_error_ = 0;  // of rest_, mm
  double pixels_per_mm_ = 1;
};

}  // namespace facetless
