// Newton's method on two planes: W. Martin, E. Cohen, R. Fish and P. Shirley, "Practical Ray Tracing of Trimmed NURBS
// Surfaces", Journal of Graphics Tools 5 (2000).
//
//  1. The ray is the intersection of two planes with unit normals N1 and N2. The iteration finds the zero of the
//     distances F = N·S(u,v) + d. S and its derivatives are points and vectors in space, by the quotient rule.
//  2. Searches begin in the middle of the pieces of flattening.h, whose boxes are in space.
//  3. newton_rules.h says how a search moves and when it stops. At a singular Jacobian, the paper moves by random numbers;
//     here they follow from the ray and the start.
//  4. The tolerance is in pixels at the depth of the iterate. The paper leaves it to the user, in lengths.
//  5. At most one root is found in each piece. Roots are lost where the residual grows on the way, which the paper takes
//     as a miss, and often where the surface is tangent to the ray.
#pragma once

#include "render/solve/solver.h"

namespace facetless {

SolverInfo MartinInfo();

}  // namespace facetless
