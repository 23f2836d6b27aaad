#include "render/base/trigonometry.h"

#include <cmath>
#include <cstddef>

namespace facetless {
namespace {

constexpr double kQuarterPi = 0.78539816339744830962;
constexpr double kHalfPi = 1.57079632679489661923;
constexpr double kHalfPiRest = 6.123233995736766036e-17;  // π/2 − kHalfPi
constexpr double kTanEighthPi = 0.41421356237309504880;

// Minimax polynomials in z = x², computed by the Remez exchange with 60 digits. sin x = x + x·z·P(z) for
// |x| <= 0.793, with a relative error of 8e-21.
constexpr double kSin[] = {-0.16666666666666666,   0.008333333333333331,   -0.00019841269841264572,
                           2.7557319218958595e-06, -2.505210610148728e-08, 1.605851105751305e-10,
                           -7.585496585090376e-13};
// cos x = 1 − z/2 + z²·P(z) for |x| <= 0.793, with an error of 6e-19.
constexpr double kCos[] = {0.041666666666666664,    -0.0013888888888887244, 2.480158729853495e-05,
                           -2.7557317153131834e-07, 2.0876121779649795e-09, -1.1380884626244858e-11};
// arctan x = x + x·z·P(z) for |x| <= 0.418, with a relative error of 7e-18.
constexpr double kAtan[] = {-0.3333333333333333,  0.19999999999994938,  -0.14285714284540257,
                            0.11111111004807121,  -0.09090904144216462, 0.07692172940196018,
                            -0.06664365184199883, 0.05856865789407917,  -0.05078685722338586,
                            0.03903520833911732,  -0.018935425164264663};

template <std::size_t kCount>
double Horner(const double (&coefficients)[kCount], double z) {
  double sum = coefficients[kCount - 1];
  for (std::size_t i = kCount - 1; i-- > 0;) sum = sum * z + coefficients[i];
  return sum;
}

// The tangent for |x| <= π/4.
double TanSmall(double x) {
  const double z = x * x;
  const double sine = x + x * (z * Horner(kSin, z));
  const double cosine = 1 - (0.5 * z - z * z * Horner(kCos, z));
  return sine / cosine;
}

// The arctangent for |x| <= tan(π/8).
double AtanSmall(double x) {
  const double z = x * x;
  return x + x * (z * Horner(kAtan, z));
}

}  // namespace

double PolyTan(double x) {
  const double size = std::fabs(x);
  if (size <= kQuarterPi) return TanSmall(x);
  // tan x = 1 / tan(π/2 − x).
  const double value = 1 / TanSmall((kHalfPi - size) + kHalfPiRest);
  return x < 0 ? -value : value;
}

double PolyAtan(double x) {
  const double size = std::fabs(x);
  if (size <= kTanEighthPi) return AtanSmall(x);
  // arctan x = π/4 + arctan((x − 1)/(x + 1)) = π/2 − arctan(1/x).
  const double value = size <= 1 / kTanEighthPi
                           ? kQuarterPi + (AtanSmall((size - 1) / (size + 1)) + 0.5 * kHalfPiRest)
                           : kHalfPi - (AtanSmall(1 / size) - kHalfPiRest);
  return x < 0 ? -value : value;
}

}  // namespace facetless
