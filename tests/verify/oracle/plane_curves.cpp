#include "tests/verify/oracle/plane_curves.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace facetless::oracle {
namespace {

std::pair<HomogeneousCurve, HomogeneousCurve> Halves(HomogeneousCurve upper) {
  HomogeneousCurve lower = upper;
  for (std::size_t level = 1; level < upper.size(); ++level) {
    for (std::size_t k = 0; k + level < upper.size(); ++k) upper[k] = Real(0.5) * (upper[k] + upper[k + 1]);
    lower[level] = upper[0];
  }
  return {std::move(lower), std::move(upper)};
}

struct Rectangle {
  Real x_low, x_high, y_low, y_high;
};
// Returns the hull of a curve with positive weights.
Rectangle HullOf(const HomogeneousCurve& curve) {
  Rectangle hull{curve[0].x / curve[0].z, curve[0].x / curve[0].z, curve[0].y / curve[0].z,
                 curve[0].y / curve[0].z};
  for (const Real3& p : curve) {
    const Real x = p.x / p.z, y = p.y / p.z;
    hull = {Min(hull.x_low, x), Max(hull.x_high, x), Min(hull.y_low, y), Max(hull.y_high, y)};
  }
  return hull;
}

// A piece of a curve, in double.
struct Piece {
  std::vector<double> x, y, w;
  double begin = 0, end = 1;

  // Returns a lower bound of the distance of the piece, by the box of its hull.
  double Bound() const {
    double x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x_low = std::min(x_low, x[i] / w[i]);
      x_high = std::max(x_high, x[i] / w[i]);
      y_low = std::min(y_low, y[i] / w[i]);
      y_high = std::max(y_high, y[i] / w[i]);
    }
    return std::hypot(std::max({x_low, -x_high, 0.0}), std::max({y_low, -y_high, 0.0}));
  }
  std::pair<Piece, Piece> Halves() const {
    Piece lower = *this, upper = *this;
    lower.end = upper.begin = 0.5 * (begin + end);
    const auto halve = [](std::vector<double>& low, std::vector<double>& high) {
      for (std::size_t level = 1; level < high.size(); ++level) {
        for (std::size_t k = 0; k + level < high.size(); ++k) high[k] = 0.5 * (high[k] + high[k + 1]);
        low[level] = high[0];
      }
    };
    halve(lower.x, upper.x);
    halve(lower.y, upper.y);
    halve(lower.w, upper.w);
    return {std::move(lower), std::move(upper)};
  }
};

}  // namespace

Real3 PointAt(std::vector<Real3> points, Real t) {
  for (std::size_t last = points.size() - 1; last > 0; --last)
    for (std::size_t k = 0; k < last; ++k) points[k] = (1 - t) * points[k] + t * points[k + 1];
  return points[0];
}

Parity CrossesUpwardAxis(const HomogeneousCurve& curve, Real floor) {
  bool left = false, right = false, above = false, below = false;
  for (const Real3& p : curve) {
    (p.x < 0 ? left : right) = true;
    (p.y > 0 ? above : below) = true;
  }
  if (!left || !right || !above) return Parity::kEven;
  // If the curve is above the origin throughout, its ends decide.
  if (!below) return (curve.front().x < 0) != (curve.back().x < 0) ? Parity::kOdd : Parity::kEven;
  const Rectangle hull = HullOf(curve);
  if (Max(-hull.x_low, hull.x_high) <= floor && Max(-hull.y_low, hull.y_high) <= floor)
    return Parity::kUnsure;
  const auto [lower, upper] = Halves(curve);
  const Parity a = CrossesUpwardAxis(lower, floor), b = CrossesUpwardAxis(upper, floor);
  if (a == Parity::kUnsure || b == Parity::kUnsure) return Parity::kUnsure;
  return a == b ? Parity::kEven : Parity::kOdd;
}

Nearest NearestTo(const HomogeneousCurve& curve, double limit) {
  Piece whole;
  for (const Real3& p : curve) {
    whole.x.push_back(static_cast<double>(p.x));
    whole.y.push_back(static_cast<double>(p.y));
    whole.w.push_back(static_cast<double>(p.z));
  }
  constexpr double kPrecision = 1e-6, kShortest = 0x1p-48;
  Nearest best{INFINITY, 0};
  const auto try_end = [&](const Piece& piece, bool last) {
    const std::size_t i = last ? piece.x.size() - 1 : 0;
    const double distance = std::hypot(piece.x[i] / piece.w[i], piece.y[i] / piece.w[i]);
    if (distance < best.distance) best = {distance, last ? piece.end : piece.begin};
  };
  try_end(whole, false);
  try_end(whole, true);
  std::vector<std::pair<double, Piece>> stack;
  stack.emplace_back(whole.Bound(), whole);
  while (!stack.empty()) {
    const auto [bound, piece] = std::move(stack.back());
    stack.pop_back();
    if (bound > limit || bound >= best.distance * (1 - kPrecision)) continue;
    if (piece.end - piece.begin < kShortest) continue;
    // Continue with the nearer half.
    auto [lower, upper] = piece.Halves();
    try_end(lower, true);
    const double lower_bound = lower.Bound(), upper_bound = upper.Bound();
    const bool lower_first = lower_bound <= upper_bound;
    stack.emplace_back(lower_first ? upper_bound : lower_bound,
                       lower_first ? std::move(upper) : std::move(lower));
    stack.emplace_back(lower_first ? lower_bound : upper_bound,
                       lower_first ? std::move(lower) : std::move(upper));
  }
  return best;
}

}  // namespace facetless::oracle
