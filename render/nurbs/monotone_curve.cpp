#include "render/nurbs/monotone_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/nurbs/bracketed_root.h"

namespace facetless {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// The precision of a root of a derivative, in the parameter of the curve. The coefficients are not accurate
// enough for a shorter interval.
constexpr double kRootWidth = 0x1p-48;

// Horner's scheme in Bernstein form. `point(i)` is coefficient i of `degree`.
template <typename T, typename Coefficient>
T Bernstein(int degree, double t, const Coefficient& point) {
  if (degree == 0) return point(0);
  const double s = 1 - t;
  double power = 1, binomial = 1;
  T sum = s * point(0);
  for (int i = 1; i < degree; ++i) {
    power *= t;
    binomial = binomial * (degree - i + 1) / i;
    sum = s * (sum + power * binomial * point(i));
  }
  return sum + power * t * point(degree);
}

// The binomials of the degrees up to this one are looked up.
constexpr int kMostTabulated = 15;

constexpr auto kBinomials = [] {
  std::array<std::array<double, kMostTabulated + 1>, kMostTabulated + 1> table{};
  for (int n = 0; n <= kMostTabulated; ++n) {
    table[n][0] = table[n][n] = 1;
    for (int i = 1; i < n; ++i) table[n][i] = table[n - 1][i - 1] + table[n - 1][i];
  }
  return table;
}();

// The same as Bernstein, to the bit, for a degree up to kMostTabulated, which is known to the compiler if kDegree > 0.
// Binomials of these degrees are integers without rounding.
template <int kDegree, typename Coefficient>
inline Vec3 TabulatedBernstein(int any_degree, double t, const Coefficient& point) {
  const int degree = kDegree > 0 ? kDegree : any_degree;
  if (degree == 0) return point(0);
  const double s = 1 - t;
  double power = 1;
  Vec3 sum = s * point(0);
  for (int i = 1; i < degree; ++i) {
    power *= t;
    sum = s * (sum + power * kBinomials[degree][i] * point(i));
  }
  return sum + power * t * point(degree);
}

template <typename Coefficient>
inline Vec3 HomogeneousBernstein(int degree, double t, const Coefficient& point) {
  if (degree == 1) return TabulatedBernstein<1>(degree, t, point);
  if (degree == 2) return TabulatedBernstein<2>(degree, t, point);
  if (degree == 3) return TabulatedBernstein<3>(degree, t, point);
  if (degree <= kMostTabulated) return TabulatedBernstein<-1>(degree, t, point);
  return Bernstein<Vec3>(degree, t, point);
}

inline Vec3 HomogeneousPoint(const PlaneCurve& curve, double t) {
  return HomogeneousBernstein(curve.degree, t, [&](int i) { return curve.points[i]; });
}

Vec2 Projected(Vec3 h) {
  return {h.x / h.z, h.y / h.z};
}

// The derivative at t, where the curve is at `h`.
Vec2 TangentAt(const PlaneCurve& curve, double t, Vec3 h) {
  const Vec3 d = HomogeneousBernstein(curve.degree - 1, t, [&](int i) {
    return double(curve.degree) * (curve.points[i + 1] - curve.points[i]);
  });
  return {(d.x - d.z * h.x / h.z) / h.z, (d.y - d.z * h.y / h.z) / h.z};
}

// A polynomial in Bernstein form with coefficients within ±noise of the true ones.
struct Polynomial {
  std::vector<double> coefficients;
  double noise = 0;

  int Sign(std::size_t i) const {
    const double c = coefficients[i];
    return std::fabs(c) <= noise ? 0 : (c > 0 ? 1 : -1);
  }
  bool IsNoise() const {
    return std::all_of(coefficients.begin(), coefficients.end(),
                       [this](double c) { return std::fabs(c) <= noise; });
  }
  int Variations() const {
    int count = 0, last = 0;
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      const int sign = Sign(i);
      if (sign != 0 && last != 0 && sign != last) ++count;
      if (sign != 0) last = sign;
    }
    return count;
  }
  double At(double t) const {
    return Bernstein<double>(static_cast<int>(coefficients.size()) - 1, t,
                             [this](int i) { return coefficients[static_cast<std::size_t>(i)]; });
  }
};

// De Casteljau's algorithm at 1/2. The left half replaces `p`, and the right half is returned.
Polynomial SplitInHalf(Polynomial& p) {
  Polynomial right = p;
  auto& c = p.coefficients;
  for (std::size_t i = 1, n = c.size(); i < n; ++i) {
    right.coefficients[n - i] = c[n - 1];
    for (std::size_t k = n - 1; k >= i; --k) c[k] = 0.5 * (c[k - 1] + c[k]);
  }
  right.coefficients[0] = c.back();
  return right;
}

// Appends the roots in (a, b), the interval that corresponds to [0,1] of `p`.
void AppendRoots(Polynomial p, double a, double b, std::vector<double>& roots) {
  const int variations = p.Variations();
  if (variations == 0) {
    // A multiple root: an interval in which the polynomial does not exceed its noise.
    if (b - a < 1 && p.IsNoise()) roots.push_back(0.5 * (a + b));
    return;
  }
  const bool ends_differ = p.Sign(0) * p.Sign(p.coefficients.size() - 1) < 0;
  if (variations == 1 && ends_differ) {
    const double root = BracketedRoot([&p](double t) { return p.At(t); }, p.coefficients.front(),
                                      p.coefficients.back(), kRootWidth);
    roots.push_back(a + (b - a) * root);
    return;
  }
  const double middle = 0.5 * (a + b);
  if (b - a <= kRootWidth) {
    roots.push_back(middle);
    return;
  }
  Polynomial right = SplitInHalf(p);
  // Neither half contains a root exactly at the middle.
  if (right.Sign(0) == 0) roots.push_back(middle);
  AppendRoots(std::move(p), a, middle, roots);
  AppendRoots(std::move(right), middle, b, roots);
}

double Coordinate(const Vec3& p, int axis) {
  return axis == 0 ? p.x : p.y;
}

bool Polynomially(const PlaneCurve& curve) {
  return std::all_of(curve.points, curve.points + curve.degree + 1,
                     [&](const Vec3& p) { return p.z == curve.points[0].z; });
}

// The numerator of the derivative of coordinate `axis`: X' if all weights are equal, and X'·W − X·W'
// otherwise, with X relative to the first point.
Polynomial DerivativeNumerator(const PlaneCurve& curve, int axis) {
  const int n = curve.degree;
  const double origin = Coordinate(curve.points[0], axis) / curve.points[0].z;
  double size = 0, weight = 0;
  std::vector<double> x;
  for (int i = 0; i <= n; ++i) {
    const Vec3& p = curve.points[i];
    x.push_back(Coordinate(p, axis) - origin * p.z);
    size = std::max(size, std::fabs(Coordinate(p, axis)) + std::fabs(origin * p.z));
    weight = std::max(weight, p.z);
  }

  Polynomial result;
  if (Polynomially(curve)) {
    for (int i = 0; i < n; ++i) result.coefficients.push_back(x[i + 1] - x[i]);
    result.noise = 4 * kEpsilon * size;  // four roundings of numbers up to `size`
    return result;
  }

  // Product of degrees n − 1 and n: c_k = Σ C(n−1,i)·C(n,j)/C(2n−1,k)·(ΔX_i·W_j − ΔW_i·X_j), i + j = k.
  result.coefficients.assign(2 * n, 0.0);
  double outer = 1;  // C(n−1, i)
  for (int i = 0; i < n; ++i) {
    double inner = outer;  // C(n−1,i)·C(n,j)
    for (int j = 0; j <= n; ++j) {
      result.coefficients[i + j] += inner * ((x[i + 1] - x[i]) * curve.points[j].z -
                                             (curve.points[i + 1].z - curve.points[i].z) * x[j]);
      inner = inner * (n - j) / (j + 1);
    }
    outer = outer * (n - 1 - i) / (i + 1);
  }
  double total = 1;  // C(2n−1, k)
  for (int k = 0; k < 2 * n; ++k) {
    result.coefficients[k] /= total;
    total = total * (2 * n - 1 - k) / (k + 1);
  }
  // The products are convex sums of terms up to 4·size·weight, each with a few roundings, and n of them are
  // added.
  result.noise = (n + 8) * 4 * kEpsilon * size * weight;
  return result;
}

}  // namespace

Vec2 PointOn(const PlaneCurve& curve, double t) {
  return Projected(HomogeneousPoint(curve, t));
}

Vec2 TangentOn(const PlaneCurve& curve, double t) {
  return TangentAt(curve, t, HomogeneousPoint(curve, t));
}

Vec2 EvaluationError(const PlaneCurve& curve) {
  Vec2 size;
  for (int i = 0; i <= curve.degree; ++i) {
    const Vec3& p = curve.points[i];
    size = {std::max(size.x, std::fabs(p.x / p.z)), std::max(size.y, std::fabs(p.y / p.z))};
  }
  // There are four roundings per step for the numerator, four for the weight, and one for the quotient. All
  // terms have the same sign.
  return (8 * curve.degree + 4) * 0.5 * kEpsilon * size;
}

void AppendTurns(const PlaneCurve& curve, std::vector<double>& parameters) {
  if (curve.degree < 2) return;
  for (int axis = 0; axis < 2; ++axis) AppendRoots(DerivativeNumerator(curve, axis), 0, 1, parameters);
}

void StretchHull(const PlaneCurve& curve, double t0, double t1, std::vector<Vec2>& hull) {
  const int n = curve.degree;
  std::vector<Vec3> p(curve.points, curve.points + n + 1);
  // Restrict the curve to [0, t1], and then to [t0 / t1, 1] of that.
  for (int i = 1; i <= n; ++i)
    for (int k = n; k >= i; --k) p[k] = (1 - t1) * p[k - 1] + t1 * p[k];
  const double s = t0 / t1;
  for (int i = 1; i <= n; ++i)
    for (int k = 0; k <= n - i; ++k) p[k] = (1 - s) * p[k] + s * p[k + 1];
  hull.clear();
  for (const Vec3& h : p) hull.push_back({h.x / h.z, h.y / h.z});
}

namespace {

// Every so many steps, the bracket of SideOf is halved, however the curve is shaped.
constexpr int kStepsToBisection = 4;

// The factor for the value at the end that stays, when the value at the other end changes from `before` to `now`.
double Reduction(double now, double before) {
  const double factor = 1 - now / before;
  return factor > 0 ? factor : 0.5;
}

}  // namespace

CurveSide SideOf(const MonotonePiece& piece, Vec2 q) {
  // A piece along an axis, such as a border of the patch: every point of its box is closer than the error.
  if (std::fabs(piece.high.x - piece.low.x) <= piece.error.x || piece.high.y - piece.low.y <= piece.error.y)
    return CurveSide::kOn;
  // Mirror u if the piece falls, so that both coordinates increase from a to b.
  const double mirror = piece.high.x >= piece.low.x ? 1 : -1;
  const Vec2 span = piece.high - piece.low;
  const double scale_u = span.x != 0 ? mirror / span.x : 0, scale_v = span.y != 0 ? 1 / span.y : 0;
  const double above = mirror > 0 ? 1 : -1;  // the sign of kLeft for a point above the curve
  double a = piece.t_low, b = piece.t_high;
  double fa = mirror * (piece.low.x - q.x) * scale_u + (piece.low.y - q.y) * scale_v;
  double fb = mirror * (piece.high.x - q.x) * scale_u + (piece.high.y - q.y) * scale_v;

  // Along the piece, f = Δu/|span u| + Δv/|span v|, relative to q, increases. At its root, the curve passes q
  // on one side. The root is found by the method of Anderson and Björck: where an end of the bracket stays
  // for a second time, its value is reduced by as much as the other one has changed.
  int kept = 0;  // +1 or −1: the last step left b or a in place
  for (int step = 0; step < kMostBracketSteps; ++step) {
    double t =
        step % kStepsToBisection == kStepsToBisection - 1 ? 0.5 * (a + b) : a + (b - a) * (fa / (fa - fb));
    if (!((t > a && t < b) || (t < a && t > b))) t = 0.5 * (a + b);
    if (t == a || t == b) break;
    const Vec2 c = PointOn(piece.curve, t);
    const double x = mirror * (c.x - q.x), y = c.y - q.y;
    // The curve passes through c with both coordinates increasing, so q is decided if it lies above and to
    // the left of c, or below and to the right.
    if (x > piece.error.x && y < -piece.error.y) return static_cast<CurveSide>(above);
    if (x < -piece.error.x && y > piece.error.y) return static_cast<CurveSide>(-above);
    if (std::fabs(x) <= piece.error.x && std::fabs(y) <= piece.error.y) break;
    const double f = x * scale_u + y * scale_v;
    if (f < 0) {
      if (kept > 0) fb *= Reduction(f, fa);
      a = t;
      fa = f;
      kept = 1;
    } else {
      if (kept < 0) fa *= Reduction(f, fb);
      b = t;
      fb = f;
      kept = -1;
    }
  }
  return CurveSide::kOn;
}

double NearestParameter(const MonotonePiece& piece, Vec2 q, Vec2 scale) {
  const auto scaled = [&](Vec2 a) { return Vec2{scale.x * a.x, scale.y * a.y}; };
  const double t_min = std::min(piece.t_low, piece.t_high), t_max = std::max(piece.t_low, piece.t_high);
  // Start at the foot on the chord.
  const Vec2 chord = scaled(piece.high - piece.low), offset = scaled(q - piece.low);
  const double length = Dot(chord, chord);
  const double along = length > 0 ? std::clamp(Dot(offset, chord) / length, 0.0, 1.0) : 0.5;
  double t = piece.t_low + along * (piece.t_high - piece.t_low);
  if (piece.curve.degree == 1 && piece.curve.points[0].z == piece.curve.points[1].z) return t;

  Vec3 at = HomogeneousPoint(piece.curve, t);
  Vec2 d = scaled(Projected(at) - q);
  double best = Length(d);
  constexpr int kSteps = 12;  // convergence is quadratic near the curve, where queries lie
  for (int step = 0; step < kSteps; ++step) {
    const Vec2 tangent = scaled(TangentAt(piece.curve, t, at));
    const double speed = Dot(tangent, tangent);
    if (!(speed > 0)) break;
    const double next = std::clamp(t - Dot(d, tangent) / speed, t_min, t_max);
    const Vec3 next_at = HomogeneousPoint(piece.curve, next);
    const Vec2 next_d = scaled(Projected(next_at) - q);
    const double reached = Length(next_d);
    if (!(reached < best)) break;
    t = next;
    at = next_at;
    d = next_d;
    best = reached;
  }
  return t;
}

}  // namespace facetless
