// Projection: the 4×4 matrix that takes homogeneous model points to a view's (X, Y, W, Q).
//
//  1. X/W is the sample column and Y/W the sample row, both relative to the image centre; W > 0 in front of
//     the eye.
//  2. Depth along the view direction is Q/W in orthographic views (W is the surface's own weight) and W/Q in
//     perspective ones (Q is): perspective moves into the weight, the surface stays rational.
//  3. Points are taken relative to the eye before anything is multiplied: a model far from the origin loses
//     no digits here.
#pragma once

#include "render/base/vec.h"
#include "render/nurbs/leaf.h"
#include "render/view/camera.h"

namespace facetless {

class ViewProjection {
 public:
  // Of the part that `placement` places, seen through `frame`.
  ViewProjection(const CameraFrame& frame, const Placement& placement);

  struct Point {
    double x, y, w, q;
  };
  // Requires p.w > 0; `p` is (w·x, w·y, w·z, w) in part coordinates.
  Point operator()(Vec4 p) const;
  // Bounds the errors of the components of what p gives, by net component: the placement's, the camera's
  // axes' and the arithmetic's rounding together.
  Point Error(Vec4 p) const;
  bool perspective() const { return perspective_; }

 private:
  Vec3 right_, down_, forward_;   // in part coordinates, the first two divided by the pixel size
  Vec3 origin_;                   // the eye in part coordinates, subtracted first
  double x_ = 0, y_ = 0, z_ = 0;  // of what is left of it, in the camera's axes
  double origin_size_ = 0;        // |x| + |y| + |z| of the origin
  double placed_error_ = 0;       // mm: of placing a point
  Vec3 scale_;                    // lengths of the three axes
  bool perspective_ = false;
};

}  // namespace facetless
