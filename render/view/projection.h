// Projection: the 4×4 matrix that maps homogeneous model points to the components (X, Y, W, Q) of a view.
//
//     const ViewProjection projection(frame, instance.placement);
//     const ViewProjection::Point point = projection(control_point);
//     const double column = point.x / point.w;  // relative to the image centre
//
//  1. X/W is the sample column and Y/W the sample row, both relative to the image centre. W > 0 in front of
//     the eye.
//  2. The depth along the view direction is Q/W in orthographic views, where W is the weight of the surface,
//     and W/Q in perspective views, where Q is the weight of the surface. The perspective division becomes
//     part of the weight, so the projected surface stays rational.
//  3. The eye is subtracted from points before they are multiplied, so a model far from the origin loses no
//     precision here.
#pragma once

#include "render/base/vec.h"
#include "render/nurbs/leaf.h"
#include "render/view/camera.h"

namespace facetless {

class ViewProjection {
 public:
  // The projection of a part placed by `placement` and seen through `frame`.
  ViewProjection(const CameraFrame& frame, const Placement& placement);

  struct Point {
    double x, y, w, q;
  };
  // Projects the point p = (w·x, w·y, w·z, w), in part coordinates. Requires p.w > 0.
  Point operator()(Vec4 p) const;
  // Bounds the error of each component of the projection of p. It includes the rounding errors of the
  // placement, of the camera's axes and of the arithmetic.
  Point Error(Vec4 p) const;
  bool perspective() const { return perspective_; }

 private:
  Vec3 right_, down_, forward_;   // in part coordinates, the first two divided by the pixel size
  Vec3 origin_;                   // the eye in part coordinates, subtracted first
  double x_ = 0, y_ = 0, z_ = 0;  // remaining translation after subtracting the origin, in camera axes
  double origin_size_ = 0;        // |x| + |y| + |z| of the origin
  double placed_error_ = 0;       // error of placing a point, mm
  Vec3 scale_;                    // lengths of the three axes
  bool perspective_ = false;
};

}  // namespace facetless
