// Rational Bézier curves in a plane, relative to the origin: how often they cross a half-line, and how close
// they come.
//
//  1. A HomogeneousCurve's points are (w·x, w·y, w) with positive weights, relative to the point in question.
//  2. CrossesUpwardAxis says whether the curve crosses the half-line x = 0, y > 0 an odd number of times. A
//     point with x = 0 counts as lying on the right, so that curves with exactly the same end point count it
//     consistently. The answer is kUnsure only if the curve passes the origin closer than the floor.
//  3. NearestTo is a branch and bound over halves. The error of the answer is a millionth of itself plus the
//     rounding of double.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/verify/oracle/real.h"

namespace facetless::oracle {

using HomogeneousCurve = std::vector<Real3>;

enum class Parity : std::uint8_t { kEven, kOdd, kUnsure };

// `floor`: a piece that stays within it of the origin, in x and in y, is not divided any more.
Parity CrossesUpwardAxis(const HomogeneousCurve& curve, Real floor);

struct Nearest {
  double distance = 0, t = 0;
};
// Stops early, with any value above `limit`, if nothing is nearer than that.
Nearest NearestTo(const HomogeneousCurve& curve, double limit);

// Returns the point (x, y, w) of a curve, or of any coefficients with three components, at t.
Real3 PointAt(std::vector<Real3> points, Real t);

}  // namespace facetless::oracle
