// All common roots of two polynomials in Bernstein form over the unit square, with a proof for each.
//
//  1. A box of parameters is dropped when f, g or a combination of the two keeps one sign on it: its
//     Bernstein coefficients, less what rounding may have done to them, are all positive or all negative.
//     Nothing else is ever dropped.
//  2. A box is accepted when, with C the inverse of the Jacobian J at its centre, ‖1 − C·J‖ stays below 1
//     over the box grown by an eighth on each side, by the Bernstein coefficients of J: then it holds one
//     root at most, and x with residual r = ‖C·(f, g)(x)‖ has the root within r/(1 − ‖1 − C·J‖). Newton's
//     method finds x; if that ball lies in the grown box, the root is proven.
//  3. What is neither dropped nor accepted is halved. A box over which (f, g) varies by less than `floor`,
//     and one on which f and g are the same but for a factor, is kept as a doubt: it may hold no root, one or
//     many (a tangency, a pole, a surface seen edge-on).
//  4. Roots that lie outside the square by no more than kOverlap are found too.
//  5. More than kMostBoxes boxes end the search: what is left becomes one doubt. Nothing is dropped silently.
#pragma once

#include <vector>

#include "tests/verify/oracle/real.h"

namespace facetless::oracle {

// Where two patches share a border, each looks this far beyond it, so that rounding of the shared control
// points leaves no crack: a few hundred units in the last place of a parameter in double.
inline constexpr double kOverlap = 0x1p-44;
inline constexpr int kMostBoxes = 20000;

struct BernsteinPair {
  int degree_u = 1, degree_v = 1;
  std::vector<Real> f, g;  // (degree_u + 1)·(degree_v + 1) each, v runs fastest
  Real error = 0;          // bound of the error of each coefficient
};

struct PatchRoot {
  bool proven = false;
  Real u = 0, v = 0;            // the root; of a doubt the centre of its box
  Real radius = 0;              // the root is within this of u and of v
  Real half_u = 0, half_v = 0;  // of a doubt, half the sides of its box
  // How far the root lies outside the unit square; 0 inside.
  Real Outside() const { return Max(Max(Max(-u, u - 1), Max(-v, v - 1)), 0); }
};

std::vector<PatchRoot> FindRoots(const BernsteinPair& pair, Real floor);

// The coefficients of the same polynomial over [u0, u1] × [v0, v1], which may reach beyond the unit square.
std::vector<Real> Restrict(std::vector<Real> coefficients, int degree_u, int degree_v, Real u0, Real u1,
                           Real v0, Real v1);
// Value and derivatives by u and v.
struct Jet {
  Real value = 0, du = 0, dv = 0;
};
Jet Evaluate(const std::vector<Real>& coefficients, int degree_u, int degree_v, Real u, Real v);

}  // namespace facetless::oracle
