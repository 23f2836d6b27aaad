#include "tests/verify/oracle/real.h"

#include <cmath>

namespace facetless::oracle {
namespace {

// Computes sin x and cos x by their series. Requires |x| <= π/8: the 18th pair of terms is below 2^-160.
void SinCos(Real x, Real& sine, Real& cosine) {
  Real term = 1;
  sine = cosine = 0;
  for (int n = 0; n < 18; ++n) {
    cosine += term;
    const Real odd = term * x / (2 * n + 1);
    sine += odd;
    term = -odd * x / (2 * n + 2);
  }
}

}  // namespace

Real Pi() {
  // The formula is 16·arctan(1/5) − 4·arctan(1/239) (J. Machin, 1706).
  static const Real pi = [] {
    const auto series = [](Real x) {
      Real sum = 0, power = x;
      for (int n = 0; n < 60; ++n) {
        sum += (n % 2 == 0 ? power : -power) / (2 * n + 1);
        power *= x * x;
      }
      return sum;
    };
    return 16 * series(Real(1) / 5) - 4 * series(Real(1) / 239);
  }();
  return pi;
}

Real Sqrt(Real x) {
  if (!(x > 0)) return 0;
  // Each of Heron's steps doubles the correct digits: 53, 106, 113.
  Real root = std::sqrt(static_cast<double>(x));
  if (!(root > 0)) return 0;
  for (int step = 0; step < 2; ++step) root = (root + x / root) / 2;
  return root;
}

Real Tan(Real x) {
  // Compute the tangent of a quarter of the angle, and double the angle twice.
  Real sine, cosine;
  SinCos(x / 4, sine, cosine);
  Real tangent = sine / cosine;
  for (int doubling = 0; doubling < 2; ++doubling) tangent = 2 * tangent / (1 - tangent * tangent);
  return tangent;
}

Real Atan(Real x) {
  // arctan x = a + arctan((x − tan a)/(1 + x·tan a)), with a computed in double. The remainder is about
  // 1e-16, and its cube is the last term that matters.
  const Real guess = std::atan(static_cast<double>(x));
  const Real tangent = Tan(guess);
  const Real rest = (x - tangent) / (1 + x * tangent);
  return guess + (rest - rest * rest * rest / 3);
}

}  // namespace facetless::oracle
