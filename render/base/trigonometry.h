// Tangent and arctangent from polynomials of our own: the C library's differ from machine to machine in the
// last bit, and these do not.
#pragma once

namespace facetless {

// The tangent of x, in radians, for |x| ≤ 1.6 and away from the pole; to a few units in the last place.
double PolyTan(double x);
// The arctangent of any x, in radians; to a few units in the last place.
double PolyAtan(double x);

}  // namespace facetless
