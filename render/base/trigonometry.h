// Tangent and arctangent, computed from polynomials. The C library's functions differ between machines in the
// last bit; these return the same bits everywhere.
#pragma once

namespace facetless {

// The tangent of x radians, accurate to a few units in the last place. Requires |x| ≤ 1.6, away from the
// pole.
double PolyTan(double x);
// The arctangent of x in radians, accurate to a few units in the last place, for any x.
double PolyAtan(double x);

}  // namespace facetless
