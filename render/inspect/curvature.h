// The curvature of a surface, from its first and second derivatives.
//
//     const SurfacePoint point = Placed(surface.Second(u, v), instance.placement);
//     const auto curvature = CurvatureAt(point, OutwardSign(face, instance.placement), extent_u, extent_v);
//     if (curvature) Print(curvature->mean(), curvature->gaussian());
//
//  1. Curvature is positive if the surface bends away from its outward normal. A solid ball of radius R has
//     max = min = mean = 1/R and gaussian = 1/R²; a spherical cavity has −1/R.
//  2. The principal curvatures are the eigenvalues of the shape operator in an orthonormal basis of the
//     tangent plane, a symmetric 2×2 matrix. Their error is that of its entries even if both are equal, as
//     everywhere on a sphere.
//  3. There is no curvature if the parametrisation is degenerate (a pole, a collapsed edge, du parallel to
//     dv; kLeastExtent is the limit) or if a value is not finite.
//  4. Placements may rotate, scale, shear and mirror. The derivatives are placed first, which is exact.
//  5. sqrt is the only libm function used.
#pragma once

#include <optional>

#include "render/model/model.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {

struct Curvature {
  double max = 0, min = 0;  // principal curvatures, 1/mm; max >= min
  Vec3 max_direction;       // unit vector: direction of `max` in the tangent plane
  double mean() const { return 0.5 * (max + min); }
  double gaussian() const { return max * min; }
};

// The point and its derivatives after the placement.
SurfacePoint Placed(const SurfacePoint& point, const Placement& placement);

// The sign, +1 or −1, by which du × dv of a placed point is multiplied to point outward.
double OutwardSign(const Face& face, const Placement& placement);

// An orthonormal frame of the tangent plane, with its representation by the derivatives: first = a·du, second
// = b·du + c·dv.
struct TangentFrame {
  Vec3 first, second, normal;  // `normal` is outward
  double a = 0, b = 0, c = 0;
};

// The tangent frame at a point; nothing in the cases of law 3. `extent_u` and `extent_v` are the widths of
// the native rectangle, which convert derivatives to lengths.
std::optional<TangentFrame> FrameAt(const SurfacePoint& point, double outward, double extent_u,
                                    double extent_v);

// The curvature at a point; nothing in the cases of law 3. Requires a point with second derivatives.
std::optional<Curvature> CurvatureAt(const SurfacePoint& point, double outward, double extent_u,
                                     double extent_v);

// The normal curvature of the surface along the unit tangent `direction`, 1/mm, with the sign of law 1.
double NormalCurvature(const SurfacePoint& point, const TangentFrame& frame, Vec3 direction);

}  // namespace facetless
