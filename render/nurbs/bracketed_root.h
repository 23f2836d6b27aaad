// Bracketed root finding: the place where a continuous function of one variable changes its sign.
//
//     const double root = BracketedRoot([&](double t) { return t * t - 0.5; }, -0.5, 0.5, 1e-12);
#pragma once

namespace facetless {

// Every third step halves the bracket. A double has 53 bits, so about 160 steps are always enough.
inline constexpr int kMostBracketSteps = 200;

// Returns the point in [0, 1], to within `width`, at which f changes from the sign of f(0) to the sign of
// f(1). f_0 and f_1 are the values f(0) and f(1). The method is regula falsi (Illinois variant) with a
// bisection at every third step: it converges superlinearly for smooth f, and takes at most three times the
// steps of bisection.
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
