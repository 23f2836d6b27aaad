// The method of steepest descent: A. Sisojevs, "3D scene rendering" (doctoral thesis, Riga Technical University, 2011),
// section on B-spline surfaces, equations 7 to 9 and steps 1 to 4.
//
//  1. The surface of a face is one B-spline (face_spline.h), evaluated from its knots. g is the squared distance
//     from the ray on the screen, as in gradient.h, with the same extension to rational surfaces.
//  2. Step 1 computes the direction −(∂g/∂s, ∂g/∂t) at a point. Step 2 moves by the weight h times the direction. Step 3
//     repeats that with the same direction while g falls, so that no derivative is needed. When g does not fall, step 4
//     goes back to the best point, multiplies h by the inverse of the golden ratio, and continues with step 1.
//  3. The thesis does not say with which h step 1 begins at a new point. Here h begins at ½ / (|S_s|² + |S_t|²) there,
//     which reaches the minimum at once along a direction in which alone the surface extends on the screen, and keeps its
//     smaller value only while the point is the same. With an h that never grows again, a third of the hits of a fluted
//     column is lost after five times the steps, because the steps become too short before the tolerance is reached.
//  4. The three rules for stopping are: g is below the square of the tolerance (kRoot); the step is below kResolution,
//     which is a minimum without a root (kDiverged, or kLeft if a step out of the range of parameters was the last that
//     was refused); kMostDescentSteps evaluations (kSteps). A start or an iterate in a patch that is trimmed away ends
//     the search with kLeft, because there is no surface; so does a start behind the eye. A step out of the range of
//     parameters, or behind the eye, is refused as if g had grown. kWork: the ray has no work left.
//  5. A search begins at the value of the map of preliminary values, as in the thesis, or in the middle of each patch.
//  6. It descends into one minimum of g for each start. That need not be a root, and need not be the nearest root.
//     Convergence is linear, as that of the gradient method.
#pragma once

#include "render/solve/solver.h"

namespace facetless {

inline constexpr int kMostDescentSteps = 500;

SolverInfo SteepestDescentInfo();

}  // namespace facetless
