// Where a line meets a plane, a sphere, a cylinder, a cone or a torus, in closed form: what the subdivision
// of patches is held against.
//
//  1. A line is origin + t·direction; the answers are all t, ascending, each root of even multiplicity once
//     or twice. Cylinders and cones are unbounded; a cone has both its halves.
//  2. Each is a polynomial in t of degree 4 at most, about the line's point nearest to the surface's centre.
//     PolynomialRoots brackets its roots between those of its derivative and bisects.
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
// `slope`: radius per length along the axis.
std::vector<Real> LineCone(const Line& line, Real3 apex, Real3 axis, Real slope);
std::vector<Real> LineTorus(const Line& line, Real3 center, Real3 axis, Real major, Real minor);

// The real roots of Σ coefficients[i]·t^i, ascending. A root of even multiplicity is found when the
// polynomial is zero there to the last bit, and as two or none otherwise.
std::vector<Real> PolynomialRoots(std::vector<Real> coefficients);

}  // namespace facetless::oracle
