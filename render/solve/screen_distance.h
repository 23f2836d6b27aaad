// The function that the descents of gradient.h and steepest_descent.h minimise: g(u,v) = S_X² + S_Y², the square of the
// distance from a ray on the screen, in pixels; and its gradient.
//
//     const ScreenDistance at = DistanceFrom(ray, EvaluatePatch<3>(points, degree_u, degree_v, u, v));
//     u -= h * at.du;
#pragma once

#include <cmath>

#include "render/solve/patch_jet.h"
#include "render/solve/solver.h"

namespace facetless {

struct ScreenDistance {
  double g = INFINITY;    // infinite behind the eye
  double du = 0, dv = 0;  // ∂g/∂u, ∂g/∂v
  double speed2 = 0;      // |S_u|² + |S_v|²
};

// `jet`: of the components (X, Y, W) of a projected surface.
inline ScreenDistance DistanceFrom(const SolverRay& ray, const PatchJet<3>& jet) {
  const auto& [x, y, w] = jet.value;
  if (!(w > 0)) return {};
  // Apply the quotient rule.
  const double inverse = 1 / w, px = inverse * x, py = inverse * y;
  const double ux = inverse * (jet.du[0] - jet.du[2] * px), uy = inverse * (jet.du[1] - jet.du[2] * py),
               vx = inverse * (jet.dv[0] - jet.dv[2] * px), vy = inverse * (jet.dv[1] - jet.dv[2] * py);
  const double off_x = px - ray.x, off_y = py - ray.y;
  return {off_x * off_x + off_y * off_y, 2 * (off_x * ux + off_y * uy), 2 * (off_x * vx + off_y * vy),
          ux * ux + uy * uy + vx * vx + vy * vy};
}

}  // namespace facetless
