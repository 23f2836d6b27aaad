// The method of steepest descent: A. Sisojevs, "3D scene rendering" (doctoral thesis, Riga Technical University, 2011),
// section on B-spline surfaces, equations 7 to 9 and steps 1 to 4.
//
//  1. The surface of a face is one B-spline (face_spline.h), evaluated from its knots. g is the squared distance
//     from the ray on the screen, as in gradient.h, with the same extension to rational surfaces.
//  2. Step 1 computes the direction −(∂g/∂s, ∂g/∂t) at a point. Step 2 moves by the weight h times the direction. Step 3
//     repeats step 2 with the same direction while g falls, which needs no derivatives. When g does not fall, step 4
//     goes back to the best point, multiplies h by the inverse of the golden ratio, and continues with step 1.
//  3. The thesis does not say with which h step 1 begins at a new point. Here h begins at ½ / (|S_s|² + |S_t|²) there. If
//     the surface extends on the screen along one parameter only, this step reaches the minimum at once. The smaller
//     values of step 4 are kept only while the point is the same. With an h that never grows again, a third of the hits of
//     a fluted column is lost after five times the steps, because the steps become too short before the tolerance is
//     reached.
//  4. The three rules for stopping are: g is below the square of the tolerance (kRoot); the step is below kResolution,
//     which is a minimum without a root (kDiverged, or kLeft if the last refused step went out of the range of
//     parameters); more than kMostDescentSteps steps were tried (kSteps). The search also ends with kLeft if the start is
//     behind the eye, or if the start or an iterate lies in a patch that is trimmed away, because there is no surface. A
//     step that goes out of the range of parameters, or behind the eye, is refused as if g had grown. The search ends with
//     kWork if the ray has no work left.
//  5. A search begins at the value of the map of preliminary values, as in the thesis, or in the middle of each patch.
//  6. The search finds one minimum of g for each start. It need not be a root, and a root need not be the nearest.
//     Convergence is linear, as that of the gradient method.
#pragma once

#include "render/solve/solver.h"

namespace facetless {

inline constexpr int kMostDescentSteps = 500;

SolverInfo SteepestDescentInfo();

}  // namespace facetless
