// Curvature of a surface from its first and second derivatives.
//
//  1. Curvature is positive where the surface bends away from its outward normal: a ball of radius R has max
//     = min = mean = 1/R and gaussian 1/R² outside, and −1/R seen from the inside of a bubble.
//  2. The principal curvatures are the eigenvalues of the shape operator in an orthonormal basis of the
//     tangent plane, a symmetric 2×2 matrix: their error is that of its entries also where both are equal, as
//     everywhere on a sphere.
//  3. There is no number where the parametrisation is degenerate (a pole, a collapsed edge, du parallel to
//     dv) or anything is not finite: kLeastExtent says when.
//  4. Placements may turn, scale, shear and mirror: derivatives are placed first, which is exact.
//  5. No libm function but sqrt.
#pragma once

#include <optional>

#include "render/model/model.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {

struct Curvature {
  double max = 0, min = 0;  // principal, 1/mm; max >= min
  Vec3 max_direction;       // unit, of `max`, in the tangent plane
  double mean() const { return 0.5 * (max + min); }
  double gaussian() const { return max * min; }
};

// Point and derivatives after the placement.
SurfacePoint Placed(const SurfacePoint& point, const Placement& placement);

// What turns du × dv of a placed point outwards: +1 or −1.
double OutwardSign(const Face& face, const Placement& placement);

// An orthonormal frame of the tangent plane, and how it comes from the derivatives: first = a·du, second =
// b·du + c·dv.
struct TangentFrame {
  Vec3 first, second, normal;  // `normal` is outward
  double a = 0, b = 0, c = 0;
};

// `extent_u`, `extent_v`: the widths of the native rectangle, which make lengths of the derivatives. None:
// law 3.
std::optional<TangentFrame> FrameAt(const SurfacePoint& point, double outward, double extent_u,
                                    double extent_v);

// `point` with second derivatives.
std::optional<Curvature> CurvatureAt(const SurfacePoint& point, double outward, double extent_u,
                                     double extent_v);

// Curvature of the section of the surface along the unit tangent `direction`, by the same sign.
double NormalCurvature(const SurfacePoint& point, const TangentFrame& frame, Vec3 direction);

}  // namespace facetless
