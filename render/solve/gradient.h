// The gradient method: A. Sisojevs, "3D scene rendering" (doctoral thesis, Riga Technical University, 2011), section on
// Bézier surfaces, equations 1 to 4.
//
//  1. The root of a ray is where g(u,v) = S_X² + S_Y² is 0 (equations 1 and 2). S_X and S_Y are the distances from the ray
//     on the screen, in pixels. The thesis has polynomial surfaces; rational ones, and perspective views, which make every
//     surface rational, are an extension here, by the quotient rule.
//  2. Without the map, a preliminary search compares g at the middle of the patch and at kRandomPoints random points.
//     A descent begins at each point whose g is no more than ε₀ above the least (equation 3). ε₀ is the square of
//     kAccuracyShare times the diagonal of the patch on the screen. The random numbers follow from the ray and the patch.
//     With the map of preliminary values, the value of the pixel is the only start.
//  3. A step is −h·(∂g/∂u, ∂g/∂v) (equation 4). The weight h stays the same during a descent: kWeight / (|S_u|² + |S_v|²),
//     with the derivatives on the screen at the start of the descent. With kWeight = 1, h would be the best constant
//     weight for a surface with constant derivatives on the screen.
//  4. A descent ends
//       kRoot      if g is below the square of the tolerance, at the iterate or at the point of the patch nearest to it,
//       kLeft      if the iterate is outside the patch by more than a tenth of its length or behind the eye, or if g is
//                  that small only outside the patch,
//       kDiverged  if g is more than four times what it was at the start, or if the step is below kResolution: the
//                  descent has reached a minimum without a root,
//       kSteps     after kMostGradientSteps steps,
//       kWork      if the ray has no work left.
//     A solve ends with kWork if one of its descents does. Otherwise it ends with kRoot if any of them found a root, and
//     else as the last of them did.
//  5. The descent converges linearly, by about 1 − (σ₂/σ₁)² in each step, with the singular values of the Jacobian. Near
//     outlines, and on patches that are much longer than wide, it runs out of steps. The tolerance is therefore coarse:
//     where the surface is steep, a depth may be off by much more than a thousandth of a pixel.
#pragma once

#include "render/solve/solver.h"

namespace facetless {

inline constexpr double kDescentTolerancePx = 1e-3;
inline constexpr int kRandomPoints = 24;
inline constexpr double kAccuracyShare = 0.1;
inline constexpr double kWeight = 0.75;
inline constexpr int kMostGradientSteps = 500;
// A step below this, in parameters of a patch, does not change g any more.
inline constexpr double kResolution = 0x1p-30;

SolverInfo GradientInfo();

}  // namespace facetless
