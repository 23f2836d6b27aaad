// Newton's method with Cramer's rule on the projected surface: A. Sisojevs, "3D scene rendering" (doctoral thesis, Riga
// Technical University, 2011), section on NURBS surfaces, equations 10 to 13.
//
//  1. The surface is projected once for each view, to the components (x*, y*, w). The ray is a point (xR, yR), and its
//     roots are those of S*X(u,v) − xR = 0 and S*Y(u,v) − yR = 0 (equation 10).
//  2. A step is w/M·(M_U, M_V) (equation 11) with the determinants of equations 12 and 13. It is Newton's step, computed
//     without the derivatives of the quotients.
//  3. A search begins at the value of the map of preliminary values (value_map.h), as in the thesis, or in the middle of
//     the pieces of flattening.h. newton_rules.h says how it moves and when it stops.
//  4. From the map, a ray has one start, and so at most one root, which need not be the nearest. The hit of the ray is lost
//     where the map has no value, or has the value of a surface behind an outline.
//  5. Roots at which the surface is tangent to the ray are often lost: Newton's method converges only linearly there, and
//     runs out of steps.
#pragma once

#include "render/solve/solver.h"

namespace facetless {

SolverInfo NewtonCramerInfo();

}  // namespace facetless
