// The intersections of a line with a plane, a sphere, a cylinder, a cone or a torus, in closed form. The
// subdivision of patches is compared with them.
//
//  1. A line is origin + t·direction. The answers are all t, ascending. A root of even multiplicity occurs
//     once or twice. Cylinders and cones are unbounded, and a cone has both halves.
//  2. Each intersection is a polynomial in t of degree at most 4, relative to the line's point nearest to the
//     surface's centre. PolynomialRoots brackets its roots between those of its derivative and bisects.
#pragma once

#include <vector>

#include "tests/verify/oracle/real.h"

namespace facetless::oracle {

struct Line {
  Real3 origin, direction;
};

std::vector<Real> LinePlane(const Line& line, Real3 point, Real3 normal);
std::vector<Real> LineSphere(const Line& line, Real3 center, Real radius);
// `axis` is a unit vector, here and below.
std::vector<Real> LineCylinder(const Line& line, Real3 center, Real3 axis, Real radius);
// `slope` is the radius per length along the axis.
std::vector<Real> LineCone(const Line& line, Real3 apex, Real3 axis, Real slope);
std::vector<Real> LineTorus(const Line& line, Real3 center, Real3 axis, Real major, Real minor);

// Returns the real roots of Σ coefficients[i]·t^i, ascending. A root of even multiplicity is found once if
// the polynomial is exactly zero there, and otherwise as two roots or none.
std::vector<Real> PolynomialRoots(std::vector<Real> coefficients);

}  // namespace facetless::oracle
