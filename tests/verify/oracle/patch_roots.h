// Finds all common roots of two polynomials in Bernstein form over the unit square, with a proof for each.
//
//  1. A box of parameters is dropped if f, g or a combination of the two has one sign on it: its Bernstein
//     coefficients, less their rounding errors, are all positive or all negative. Nothing else is ever
//     dropped.
//  2. Let C be the inverse of the Jacobian J at the centre of a box. The box is accepted if ‖1 − C·J‖ stays
//     below 1 over the box grown by an eighth on each side, by the Bernstein coefficients of J. Then it
//     contains at most one root, and x with residual r = ‖C·(f, g)(x)‖ has the root within r/(1 − ‖1 − C·J‖).
//     Newton's method finds x. If that ball lies in the grown box, the root is proven.
//  3. A box that is neither dropped nor accepted is halved. A box over which (f, g) varies by less than
//     `floor`, or on which f and g are proportional, is kept as a doubt: it may contain no root, one or many
//     (a tangency, a pole, a surface seen edge-on).
//  4. Roots that lie outside the square by no more than kOverlap are found, too.
//  5. More than kMostBoxes boxes end the search, and the rest becomes one doubt. Nothing is dropped silently.
#pragma once

#include <vector>

#include "tests/verify/oracle/real.h"

namespace facetless::oracle {

// Where two patches share a border, each is searched this far beyond it, so that the rounding of the shared
// control points leaves no gap. It is a few hundred units in the last place of a parameter in double.
inline constexpr double kOverlap = 0x1p-44;
inline constexpr int kMostBoxes = 20000;

struct BernsteinPair {
  int degree_u = 1, degree_v = 1;
  std::vector<Real> f, g;  // (degree_u + 1)·(degree_v + 1) each, v runs fastest
  Real error = 0;          // bound of the error of each coefficient
};

struct PatchRoot {
  bool proven = false;
  Real u = 0, v = 0;            // the root; for a doubt, the centre of its box
  Real radius = 0;              // the distance of the root from u and from v is at most this
  Real half_u = 0, half_v = 0;  // for a doubt, half the sides of its box
  // Returns how far the root lies outside the unit square; 0 inside.
  Real Outside() const { return Max(Max(Max(-u, u - 1), Max(-v, v - 1)), 0); }
};

std::vector<PatchRoot> FindRoots(const BernsteinPair& pair, Real floor);

// Returns the coefficients of the same polynomial over [u0, u1] × [v0, v1], which may extend beyond the unit
// square.
std::vector<Real> Restrict(std::vector<Real> coefficients, int degree_u, int degree_v, Real u0, Real u1,
                           Real v0, Real v1);
// Value and derivatives by u and v.
struct Jet {
  Real value = 0, du = 0, dv = 0;
};
Jet Evaluate(const std::vector<Real>& coefficients, int degree_u, int degree_v, Real u, Real v);

}  // namespace facetless::oracle
