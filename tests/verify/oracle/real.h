// Real: the oracle's number with 113 bits of significand, and the few functions that it needs.
//
//  1. Sums, products and quotients are rounded correctly: each has a relative error of at most kHalfUlp.
//  2. Sqrt, Tan and Atan have an error of less than 2^-104 of the result (or of 1, if that is larger). They
//     are implemented here with plain series, so that the oracle needs no library except the compiler's own.
//  3. Doubles become Real exactly.
#pragma once

#include <cfloat>

namespace facetless::oracle {

#if LDBL_MANT_DIG == 113
using Real = long double;  // the machine's own long double has this format
#else
using Real = __float128;
#endif

inline constexpr double kHalfUlp = 0x1p-113;

inline Real Abs(Real x) {
  return x < 0 ? -x : x;
}
inline Real Min(Real a, Real b) {
  return b < a ? b : a;
}
inline Real Max(Real a, Real b) {
  return a < b ? b : a;
}

Real Pi();
// Requires x >= 0, within the range of double.
Real Sqrt(Real x);
// Requires |x| < π/2.
Real Tan(Real x);
// Requires |x| <= 4.
Real Atan(Real x);

struct Real3 {
  Real x = 0, y = 0, z = 0;
};
inline Real3 operator+(Real3 a, Real3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Real3 operator-(Real3 a, Real3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Real3 operator*(Real s, Real3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Real Dot(Real3 a, Real3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Real3 Cross(Real3 a, Real3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real Length(Real3 a) {
  return Sqrt(Dot(a, a));
}
// Requires that a is not zero.
inline Real3 Normalized(Real3 a) {
  return (1 / Length(a)) * a;
}

}  // namespace facetless::oracle
