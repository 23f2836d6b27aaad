// Where a continuous function of one variable changes its sign.
#pragma once

namespace facetless {

// Every third step halves, so 150 are more than the 53 halvings that doubles have, thrice.
inline constexpr int kMostBracketSteps = 200;

// The place in [0, 1], to within `width`, at which f changes from the sign of f(0) to that of f(1), given as
// f_0 and f_1. Regula falsi (Illinois) with a halving at every third step: superlinear where f is smooth, and
// never more than thrice the steps of bisection.
template <typename Function>
double BracketedRoot(const Function& f, double f_0, double f_1, double width) {
  double a = 0, b = 1;
  for (int step = 0; step < kMostBracketSteps && b - a > width; ++step) {
    double t = step % 3 == 2 ? 0.5 * (a + b) : a + (b - a) * (f_0 / (f_0 - f_1));
    if (!(t > a && t < b)) t = 0.5 * (a + b);
    const double value = f(t);
    if (value == 0) return t;
    if ((value > 0) == (f_0 > 0)) {
      a = t;
      f_0 = value;
      f_1 *= 0.5;
    } else {
      b = t;
      f_1 = value;
      f_0 *= 0.5;
    }
  }
  return 0.5 * (a + b);
}

}  // namespace facetless
