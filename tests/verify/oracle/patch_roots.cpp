#include "tests/verify/oracle/patch_roots.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace facetless::oracle {
namespace {

constexpr double kGrown = 0.125;          // law 2: share of a box's side, on each side
constexpr double kMostContraction = 0.8;  // the largest ‖1 − C·J‖ over the grown box that is accepted
constexpr double kWorthTrying = 0.6;      // the limit over the box itself, before the grown one is tried
constexpr int kNewtonSteps = 24;          // with a contraction of 0.6, five to eight are usual
constexpr double kNewtonDone = 0x1p-106;

std::size_t Index(int degree_v, int i, int j) {
  return static_cast<std::size_t>(i) * static_cast<std::size_t>(degree_v + 1) + static_cast<std::size_t>(j);
}

Real Largest(const std::vector<Real>& coefficients) {
  Real largest = 0;
  for (const Real c : coefficients) largest = Max(largest, Abs(c));
  return largest;
}

// Returns the error that Restrict and Evaluate may add to coefficients of that size when they reach `beyond`
// past the square: each of the degree_u + degree_v steps multiplies sizes by at most 1 + 2·beyond and rounds
// three times.
Real GrownError(Real error, Real size, int degrees, double beyond) {
  return std::pow(1 + 2 * beyond, degrees) * (error + 4 * degrees * kHalfUlp * size);
}

struct Box {
  BernsteinPair pair;
  Real u = 0, v = 0, width_u = 1, width_v = 1;
};

bool KeepsSign(const std::vector<Real>& coefficients, Real error) {
  bool positive = true, negative = true;
  for (const Real c : coefficients) {
    positive = positive && c > error;
    negative = negative && c < -error;
  }
  return positive || negative;
}

// Returns the combination a·f + b·g with |a|, |b| <= 1.
std::vector<Real> Combined(const BernsteinPair& pair, double a, double b) {
  std::vector<Real> result(pair.f.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = a * pair.f[i] + b * pair.g[i];
  return result;
}

struct Matrix {
  double a = 0, b = 0, c = 0, d = 0;
};

// Returns the derivatives of f (first row) and g at the box's centre, by the box's own parameters.
Matrix JacobianAtCentre(const BernsteinPair& pair) {
  const Jet f = Evaluate(pair.f, pair.degree_u, pair.degree_v, 0.5, 0.5);
  const Jet g = Evaluate(pair.g, pair.degree_u, pair.degree_v, 0.5, 0.5);
  return {static_cast<double>(f.du), static_cast<double>(f.dv), static_cast<double>(g.du),
          static_cast<double>(g.dv)};
}

// Returns a bound of ‖1 − C·J‖ (the larger sum of absolute values of a row) over the unit square.
double Contraction(const BernsteinPair& pair, const Matrix& inverse) {
  // Rounding to double, and the products below, have an error of less than this share of the sum of the
  // sizes.
  constexpr double kShare = 0x1p-48;
  double low[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
  double high[4] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
  double slack = 0;
  const auto add = [&](int column, Real df, Real dg) {
    const double f = static_cast<double>(df), g = static_cast<double>(dg);
    const double rows[2] = {inverse.a * f + inverse.b * g, inverse.c * f + inverse.d * g};
    for (int row = 0; row < 2; ++row) {
      low[2 * row + column] = std::min(low[2 * row + column], rows[row]);
      high[2 * row + column] = std::max(high[2 * row + column], rows[row]);
    }
    slack = std::max({slack, std::fabs(inverse.a * f) + std::fabs(inverse.b * g),
                      std::fabs(inverse.c * f) + std::fabs(inverse.d * g)});
  };
  const int n = pair.degree_u, m = pair.degree_v;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= m; ++j) {
      const std::size_t at = Index(m, i, j), up = Index(m, i + 1, j), right = Index(m, i, j + 1);
      if (i < n) add(0, n * (pair.f[up] - pair.f[at]), n * (pair.g[up] - pair.g[at]));
      if (j < m) add(1, m * (pair.f[right] - pair.f[at]), m * (pair.g[right] - pair.g[at]));
    }
  }
  const auto farthest = [&](int entry, double from) {
    return std::max(std::fabs(low[entry] - from), std::fabs(high[entry] - from));
  };
  // Add the errors of the coefficients themselves.
  const double size =
      std::fabs(inverse.a) + std::fabs(inverse.b) + std::fabs(inverse.c) + std::fabs(inverse.d);
  const double error = 2 * (n + m) * size * static_cast<double>(pair.error) + 4 * kShare * slack;
  return std::max(farthest(0, 1) + farthest(1, 0), farthest(2, 0) + farthest(3, 1)) + error;
}

enum class Found { kRoot, kNone, kUndecided };

// Law 2.
Found TryToProve(const Box& box, const Matrix& jacobian, PatchRoot& root) {
  const double determinant = jacobian.a * jacobian.d - jacobian.b * jacobian.c;
  const Matrix inverse{jacobian.d / determinant, -jacobian.b / determinant, -jacobian.c / determinant,
                       jacobian.a / determinant};
  if (!std::isfinite(inverse.a + inverse.b + inverse.c + inverse.d)) return Found::kUndecided;
  if (!(Contraction(box.pair, inverse) < kWorthTrying)) return Found::kUndecided;

  // Examine the grown box.
  const int n = box.pair.degree_u, m = box.pair.degree_v;
  const Real size = Max(Largest(box.pair.f), Largest(box.pair.g));
  const Real error = GrownError(box.pair.error, size, n + m, kGrown);
  const BernsteinPair grown{n, m, Restrict(box.pair.f, n, m, -kGrown, 1 + kGrown, -kGrown, 1 + kGrown),
                            Restrict(box.pair.g, n, m, -kGrown, 1 + kGrown, -kGrown, 1 + kGrown), error};
  constexpr double kSide = 1 + 2 * kGrown;  // derivatives of `grown` are by its own, longer sides
  const double contraction =
      Contraction(grown, {inverse.a / kSide, inverse.b / kSide, inverse.c / kSide, inverse.d / kSide});
  if (!(contraction < kMostContraction)) return Found::kUndecided;

  // Run Newton's method from the centre, within the grown box.
  Real u = 0.5, v = 0.5, residual = 0;
  const auto residual_at = [&](const Jet& f, const Jet& g) {
    const Real first = inverse.a * f.value + inverse.b * g.value;
    const Real second = inverse.c * f.value + inverse.d * g.value;
    const double rows =
        std::max(std::fabs(inverse.a) + std::fabs(inverse.b), std::fabs(inverse.c) + std::fabs(inverse.d));
    return Max(Abs(first), Abs(second)) + rows * (error + 4 * kHalfUlp * (Abs(f.value) + Abs(g.value)));
  };
  Real at_centre = 0;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Jet f = Evaluate(box.pair.f, n, m, u, v), g = Evaluate(box.pair.g, n, m, u, v);
    if (step == 0) at_centre = residual_at(f, g);
    const Real area = f.du * g.dv - f.dv * g.du;
    if (area == 0) break;
    const Real next_u = Max(-kGrown, Min(1 + kGrown, u - (f.value * g.dv - g.value * f.dv) / area));
    const Real next_v = Max(-kGrown, Min(1 + kGrown, v - (g.value * f.du - f.value * g.du) / area));
    const Real move = Max(Abs(next_u - u), Abs(next_v - v));
    u = next_u;
    v = next_v;
    if (move < kNewtonDone) break;
  }
  residual = residual_at(Evaluate(box.pair.f, n, m, u, v), Evaluate(box.pair.g, n, m, u, v));
  const Real radius = residual / (1 - contraction);
  if (u - radius >= -kGrown && u + radius <= 1 + kGrown && v - radius >= -kGrown &&
      v + radius <= 1 + kGrown) {
    // Test whether the only root of the grown box belongs to this box.
    if (u + radius < 0 || u - radius > 1 || v + radius < 0 || v - radius > 1) return Found::kNone;
    root.proven = true;
    root.u = box.u + u * box.width_u;
    root.v = box.v + v * box.width_v;
    root.radius = radius * Max(box.width_u, box.width_v) + 4 * kHalfUlp;
    return Found::kRoot;
  }
  // A root in the box is within 1/2 of its centre.
  const Real centre_error =
      2 * (std::fabs(inverse.a) + std::fabs(inverse.b) + std::fabs(inverse.c) + std::fabs(inverse.d)) * error;
  return (at_centre - centre_error) / (1 + contraction) > 0.5 ? Found::kNone : Found::kUndecided;
}

// Returns both halves of the coefficients, along u or along v.
std::pair<std::vector<Real>, std::vector<Real>> Halved(std::vector<Real> upper, int degree_u, int degree_v,
                                                       bool along_u) {
  std::vector<Real> lower = upper;
  const int degree = along_u ? degree_u : degree_v, lines = along_u ? degree_v : degree_u;
  for (int line = 0; line <= lines; ++line) {
    const auto at = [&](int k) { return along_u ? Index(degree_v, k, line) : Index(degree_v, line, k); };
    // De Casteljau: `upper` ends as the half next to 1, and its first entries pass through the half next to
    // 0.
    for (int level = 1; level <= degree; ++level) {
      for (int k = 0; k <= degree - level; ++k) upper[at(k)] = (upper[at(k)] + upper[at(k + 1)]) * Real(0.5);
      lower[at(level)] = upper[at(0)];
    }
  }
  return {std::move(lower), std::move(upper)};
}

// Returns the largest change of f and g along u, or along v, over one step of the net.
double Variation(const BernsteinPair& pair, bool along_u) {
  double most = 0;
  const int n = pair.degree_u, m = pair.degree_v;
  for (int i = 0; i + (along_u ? 1 : 0) <= n; ++i) {
    for (int j = 0; j + (along_u ? 0 : 1) <= m; ++j) {
      const std::size_t at = Index(m, i, j), next = along_u ? Index(m, i + 1, j) : Index(m, i, j + 1);
      most = std::max({most, std::fabs(static_cast<double>(pair.f[next] - pair.f[at])),
                       std::fabs(static_cast<double>(pair.g[next] - pair.g[at]))});
    }
  }
  return most * (along_u ? n : m);
}

PatchRoot DoubtOf(const Box& box) {
  PatchRoot doubt;
  doubt.half_u = box.width_u / 2;
  doubt.half_v = box.width_v / 2;
  doubt.u = box.u + doubt.half_u;
  doubt.v = box.v + doubt.half_v;
  return doubt;
}

// Extends a doubt's box so that it contains another's.
void Merge(PatchRoot& into, const PatchRoot& other) {
  const Real u_low = Min(into.u - into.half_u, other.u - other.half_u),
             u_high = Max(into.u + into.half_u, other.u + other.half_u),
             v_low = Min(into.v - into.half_v, other.v - other.half_v),
             v_high = Max(into.v + into.half_v, other.v + other.half_v);
  into.u = (u_low + u_high) / 2;
  into.v = (v_low + v_high) / 2;
  into.half_u = (u_high - u_low) / 2;
  into.half_v = (v_high - v_low) / 2;
}

// Two boxes share a border if their distance is less than a fourth of their sides.
bool Touch(const PatchRoot& a, const PatchRoot& b) {
  return Abs(a.u - b.u) <= Real(1.25) * (a.half_u + b.half_u) &&
         Abs(a.v - b.v) <= Real(1.25) * (a.half_v + b.half_v);
}

void AddDoubt(std::vector<PatchRoot>& doubts, PatchRoot doubt) {
  for (std::size_t i = 0; i < doubts.size();) {
    if (!Touch(doubts[i], doubt)) {
      ++i;
      continue;
    }
    Merge(doubt, doubts[i]);
    doubts.erase(doubts.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
  doubts.push_back(doubt);
}

// Neighbouring boxes may both find a root on their common border.
void AddRoot(std::vector<PatchRoot>& roots, const PatchRoot& root) {
  for (const PatchRoot& known : roots) {
    const Real reach = known.radius + root.radius + 0x1p-100;
    if (Abs(known.u - root.u) <= reach && Abs(known.v - root.v) <= reach) return;
  }
  roots.push_back(root);
}

}  // namespace

Jet Evaluate(const std::vector<Real>& coefficients, int degree_u, int degree_v, Real u, Real v) {
  // Evaluate along v, to a value and a derivative per row, and then both along u.
  const auto rows = static_cast<std::size_t>(degree_u) + 1;
  std::vector<Real> value(rows), derivative(rows), line(static_cast<std::size_t>(degree_v) + 1);
  for (int i = 0; i <= degree_u; ++i) {
    for (int j = 0; j <= degree_v; ++j)
      line[static_cast<std::size_t>(j)] = coefficients[Index(degree_v, i, j)];
    for (std::size_t last = static_cast<std::size_t>(degree_v); last > 1; --last)
      for (std::size_t j = 0; j < last; ++j) line[j] = (1 - v) * line[j] + v * line[j + 1];
    value[static_cast<std::size_t>(i)] = (1 - v) * line[0] + v * line[1];
    derivative[static_cast<std::size_t>(i)] = degree_v * (line[1] - line[0]);
  }
  for (std::size_t last = rows - 1; last > 1; --last) {
    for (std::size_t i = 0; i < last; ++i) {
      value[i] = (1 - u) * value[i] + u * value[i + 1];
      derivative[i] = (1 - u) * derivative[i] + u * derivative[i + 1];
    }
  }
  return {(1 - u) * value[0] + u * value[1], degree_u * (value[1] - value[0]),
          (1 - u) * derivative[0] + u * derivative[1]};
}

std::vector<Real> Restrict(std::vector<Real> coefficients, int degree_u, int degree_v, Real u0, Real u1,
                           Real v0, Real v1) {
  for (const bool along_u : {true, false}) {
    const int degree = along_u ? degree_u : degree_v, lines = along_u ? degree_v : degree_u;
    const Real begin = along_u ? u0 : v0, end = along_u ? u1 : v1;
    std::vector<Real> old(static_cast<std::size_t>(degree) + 1), line(old.size());
    for (int k = 0; k <= lines; ++k) {
      const auto at = [&](int l) { return along_u ? Index(degree_v, l, k) : Index(degree_v, k, l); };
      for (int l = 0; l <= degree; ++l) old[static_cast<std::size_t>(l)] = coefficients[at(l)];
      // By the blossom, the l-th new coefficient has degree − l arguments `begin` and l arguments `end`.
      for (int l = 0; l <= degree; ++l) {
        line = old;
        for (int level = 0; level < degree; ++level) {
          const Real t = level < l ? end : begin;
          for (std::size_t i = 0; i < static_cast<std::size_t>(degree - level); ++i)
            line[i] = (1 - t) * line[i] + t * line[i + 1];
        }
        coefficients[at(l)] = line[0];
      }
    }
  }
  return coefficients;
}

std::vector<PatchRoot> FindRoots(const BernsteinPair& pair, Real floor) {
  const int n = pair.degree_u, m = pair.degree_v;
  const Real size = Max(Largest(pair.f), Largest(pair.g));
  std::vector<PatchRoot> roots, doubts;
  // Begin with the square and its overlap.
  std::vector<Box> stack(1);
  const Real low = -kOverlap, high = 1 + Real(kOverlap);
  stack[0] = {{n, m, Restrict(pair.f, n, m, low, high, low, high),
               Restrict(pair.g, n, m, low, high, low, high), GrownError(pair.error, size, n + m, kOverlap)},
              low,
              low,
              high - low,
              high - low};
  for (int boxes = 0; !stack.empty(); ++boxes) {
    Box box = std::move(stack.back());
    stack.pop_back();
    // Law 5.
    if (boxes >= kMostBoxes) {
      PatchRoot rest = DoubtOf(box);
      for (const Box& other : stack) Merge(rest, DoubtOf(other));
      AddDoubt(doubts, rest);
      break;
    }
    // Law 1.
    const BernsteinPair& now = box.pair;
    if (KeepsSign(now.f, now.error) || KeepsSign(now.g, now.error)) continue;
    const Matrix jacobian = JacobianAtCentre(now);
    const double entry = std::max(
        {std::fabs(jacobian.a), std::fabs(jacobian.b), std::fabs(jacobian.c), std::fabs(jacobian.d)});
    bool dropped = false, same = false;
    if (entry > 0) {
      // These are the rows of the adjugate. Each gives a combination of f and g that one parameter hardly
      // changes; where the Jacobian is singular, neither parameter changes it much.
      const Real error = 2 * now.error + 8 * kHalfUlp * size;
      for (const bool first : {true, false}) {
        const std::vector<Real> combined = first ? Combined(now, jacobian.d / entry, -jacobian.b / entry)
                                                 : Combined(now, -jacobian.c / entry, jacobian.a / entry);
        const double row = first ? std::max(std::fabs(jacobian.d), std::fabs(jacobian.b))
                                 : std::max(std::fabs(jacobian.c), std::fabs(jacobian.a));
        dropped = dropped || KeepsSign(combined, error);
        same = same || (row > 0x1p-40 * entry && Largest(combined) <= 4 * error);
      }
    }
    if (dropped) continue;
    // Law 2.
    PatchRoot root;
    const Found found = TryToProve(box, jacobian, root);
    if (found == Found::kRoot) AddRoot(roots, root);
    if (found != Found::kUndecided) continue;
    // Law 3.
    const double along_u = Variation(now, true), along_v = Variation(now, false);
    if (same || std::max(along_u, along_v) <= floor) {
      AddDoubt(doubts, DoubtOf(box));
      continue;
    }
    const bool halve_u = along_u >= along_v;
    auto [f_low, f_high] = Halved(now.f, n, m, halve_u);
    auto [g_low, g_high] = Halved(now.g, n, m, halve_u);
    const Real error = now.error + 2 * (halve_u ? n : m) * kHalfUlp * size;
    const Real width_u = halve_u ? box.width_u / 2 : box.width_u,
               width_v = halve_u ? box.width_v : box.width_v / 2;
    stack.push_back({{n, m, std::move(f_low), std::move(g_low), error}, box.u, box.v, width_u, width_v});
    stack.push_back({{n, m, std::move(f_high), std::move(g_high), error},
                     halve_u ? box.u + width_u : box.u,
                     halve_u ? box.v : box.v + width_v,
                     width_u,
                     width_v});
  }
  roots.insert(roots.end(), doubts.begin(), doubts.end());
  return roots;
}

}  // namespace facetless::oracle
