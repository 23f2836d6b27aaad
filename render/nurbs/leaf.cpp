#include "render/nurbs/leaf.h"

#include <cmath>

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;  // unit roundoff

// kEnlarged^n
const double* EnlargedPowers() {
  static const auto powers = [] {
    struct Table {
      double value[2 * kMaxDegree + 2];
    } table{};
    table.value[0] = 1;
    for (int i = 1; i < 2 * kMaxDegree + 2; ++i) table.value[i] = table.value[i - 1] * kEnlarged;
    return table;
  }();
  return powers.value;
}

// Sums of |coefficients| that bound a polynomial in s, t over the enlarged leaf.
struct Bounds {
  double value = 0;       // without the constant term
  double ds = 0, dt = 0;  // of the first derivatives, without their constant terms
  double second = 0;      // |∂ss| + 2|∂st| + |∂tt|
};

template <int P, int Q>
Bounds BoundOf(const double* monomials, int degree_u, int degree_v) {
  const int pu = P > 0 ? P : degree_u, pv = Q > 0 ? Q : degree_v;
  const double* r = EnlargedPowers();
  // Terms of s^i·t^j are r^(i+j) at most; along a row their sum, and its first and second moments by j. Constant and
  // linear terms apart: only values count the latter.
  double value = 0, by_s = 0, by_t = 0, second = 0;
  for (int i = 0; i <= pu; ++i) {
    double sum = 0, first = 0, second_t = 0;
    for (int j = i < 2 ? 2 - i : 0; j <= pv; ++j) {
      const double term = std::fabs(monomials[i * (pv + 1) + j]) * r[i + j];
      sum += term;
      first += j * term;
      second_t += j * (j - 1) * term;
    }
    value += sum;
    by_s += i * sum;
    by_t += first;
    second += i * (i - 1) * sum + 2 * i * first + second_t;
  }
  Bounds b;
  b.value = value + kEnlarged * (std::fabs(monomials[pv + 1]) + std::fabs(monomials[1]));
  b.ds = by_s / kEnlarged;
  b.dt = by_t / kEnlarged;
  b.second = second / (kEnlarged * kEnlarged);
  return b;
}

Bounds Bound(const double* monomials, int degree_u, int degree_v) {
  return ByDegrees(degree_u, degree_v,
                   [&]<int P, int Q>() { return BoundOf<P, Q>(monomials, degree_u, degree_v); });
}

// ‖I − H'‖ to expect after halving in u or in v: the monomial s^i·t^j shrinks by 2^−i or 2^−j, and the row of C
// that belongs to the halved direction doubles.
template <int P, int Q>
Verdict AfterHalving(const double* g1, const double* g2, const double* w, int degree_u, int degree_v) {
  const int pu = P > 0 ? P : degree_u, pv = Q > 0 ? Q : degree_v;
  struct Sums {
    double row1 = 0, row2 = 0, slope = 0;
  } u, v;
  double factor_u = 1;
  for (int i = 0; i <= pu; ++i, factor_u *= 0.5) {
    double factor_v = 1;
    for (int j = 0; j <= pv; ++j, factor_v *= 0.5) {
      const int k = i * (pv + 1) + j;
      const double by_u = (i + j) * factor_u, by_v = (i + j) * factor_v;
      if (i + j >= 2) {
        const double one = std::fabs(g1[k]), two = std::fabs(g2[k]);
        u.row1 += one * by_u, u.row2 += two * by_u;
        v.row1 += one * by_v, v.row2 += two * by_v;
      }
      if (w) u.slope += std::fabs(w[k]) * by_u, v.slope += std::fabs(w[k]) * by_v;
    }
  }
  return {false, std::fmax(2 * u.row1, u.row2) + u.slope, std::fmax(v.row1, 2 * v.row2) + v.slope};
}

// A bound of |f| and of |∂s f| + |∂t f| over the enlarged leaf, constant and linear terms included.
struct Range {
  double rest, slope;  // rest: of f without its constant term
};
Range RangeOf(const double* monomials, int degree_u, int degree_v) {
  const Bounds b = Bound(monomials, degree_u, degree_v);
  return {b.value, b.ds + b.dt + std::fabs(monomials[degree_v + 1]) + std::fabs(monomials[1])};
}

// Forms the planes that the depth needs and its bounds (Law 6). `weight`: the monomials of W/W(0,0), null where it
// is constant. False where Q may vanish.
bool CertifyDepth(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic, double w0,
                  double w_low, Range w, const double* weight, Leaf* leaf, double* monomials) {
  const int n = net.points(), pu = net.degree_u, pv = net.degree_v;
  const int middle = (pu / 2) * net.stride() + pv / 2;
  const double growth = EnlargedPowers()[pu + pv];
  // Conversion and Horner lose a few units per degree.
  const double units = 4 * (pu + pv + 2) * arithmetic.epsilon;
  double slope = 0, evaluation = 0, far = 0, divisor = 0;
  if (rule.perspective) {
    Range q{0, 0};
    double q0 = net.value[kQ][0];
    if (rule.depth_varies) {
      ToCenteredMonomials(net.value[kQ], pu, pv, monomials);
      q0 = monomials[0];
      for (int i = 0; i < n; ++i) monomials[i] /= q0;
      q = RangeOf(monomials, pu, pv);
    }
    const double q_low = 1 - q.rest;
    if (!(q0 > 0 && q_low > 0)) return false;
    // depth = scale + scale·(w − q)/(1 + q), w and q without their constant terms. From afar, a rational patch
    // has a w and a q that vary together, and their difference hardly at all.
    leaf->depth_scale = w0 / q0;
    Range difference = w;
    if (rule.depth_varies) {
      double d[kMaxNetPoints];
      for (int i = 0; i < n; ++i) d[i] = (weight ? weight[i] : 0) - monomials[i];
      d[0] = 0;
      difference = RangeOf(d, pu, pv);
    }
    const double range = w.rest + q.rest;
    slope = leaf->depth_scale * (difference.slope / q_low + difference.rest * q.slope / (q_low * q_low));
    evaluation = leaf->depth_scale * (units * range / q_low * (1 + 1 / q_low) + 4 * kEpsilon);
    far = leaf->depth_scale * (1 + range / q_low);
    divisor = q0 * q_low / growth;
  } else {
    // Relative to the depth of the middle, for the digits.
    leaf->depth_scale = net.value[kQ][middle] / (rule.weight_varies ? net.value[kW][middle] : 1);
    double q_size = 0;
    if (rule.depth_varies) {
      double q[kMaxNetPoints];
      for (int i = 0; i < n; ++i)
        q[i] = net.value[kQ][i] - leaf->depth_scale * (rule.weight_varies ? net.value[kW][i] : 1);
      ToCenteredMonomials(q, pu, pv, monomials);
      for (int i = 0; i < n; ++i) monomials[i] /= w0;
      const Range range = RangeOf(monomials, pu, pv);
      q_size = std::fabs(monomials[0]) + range.rest;
      slope = range.slope / w_low + q_size * w.slope / (w_low * w_low);
    }
    evaluation = units * q_size / w_low * (1 + 1 / w_low) +
                 4 * kEpsilon * (std::fabs(leaf->depth_scale) + q_size / w_low);
    far = std::fabs(leaf->depth_scale) + q_size / w_low;
    divisor = w0 * w_low / growth;
  }
  leaf->depth_error = slope * leaf->root_error + evaluation + NetDepthError(net, rule, far, divisor);
  return true;
}

}  // namespace

double NetDepthError(const BezierNet& net, DepthRule rule, double far, double divisor) {
  const double own = rule.perspective ? net.error[kW] : net.error[kQ];
  const double of_divisor = rule.perspective ? net.error[kQ] : net.error[kW];
  return (own + far * of_divisor) / divisor;
}

Verdict Certify(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic, Leaf* leaf,
                double* monomials) {
  const int n = net.points();
  const int pu = net.degree_u, pv = net.degree_v, stride = net.stride();

  // Shift to the pixel of the middle control points, so that what follows has the leaf's size and not the
  // image's.
  const int middle = (pu / 2) * stride + pv / 2;
  const double w_middle = rule.weight_varies ? net.value[kW][middle] : 1;
  if (!(w_middle > 0)) return {};
  const double shift_x = net.value[kX][middle] / w_middle, shift_y = net.value[kY][middle] / w_middle;
  double x[kMaxNetPoints], y[kMaxNetPoints], mx[kMaxNetPoints], my[kMaxNetPoints], mw[kMaxNetPoints];
  x[0] = y[0] = 0;
  for (int i = 0; i < n; ++i) {
    const double w = rule.weight_varies ? net.value[kW][i] : 1;
    x[i] = net.value[kX][i] - shift_x * w;
    y[i] = net.value[kY][i] - shift_y * w;
  }
  ToCenteredMonomials(x, pu, pv, mx);
  ToCenteredMonomials(y, pu, pv, my);
  const double size = MaxAbs(x, n) + MaxAbs(y, n);
  if (rule.weight_varies) ToCenteredMonomials(net.value[kW], pu, pv, mw);

  // Move the origin to the pixel of (0,0).
  const double w0 = rule.weight_varies ? mw[0] : 1;
  if (!(w0 > 0)) return {};
  // The centre is rounded first and the net moved by what is left, so that both belong together.
  leaf->center_x = shift_x + mx[0] / w0;
  leaf->center_y = shift_y + my[0] / w0;
  const double offset_x = leaf->center_x - shift_x, offset_y = leaf->center_y - shift_y;
  if (rule.weight_varies) {
    for (int i = 0; i < n; ++i) {
      mx[i] -= offset_x * mw[i];
      my[i] -= offset_y * mw[i];
    }
  } else {
    mx[0] -= offset_x;
    my[0] -= offset_y;
  }

  // Invert the Jacobian there.
  const double a = mx[stride] / w0, b = mx[1] / w0;
  const double c = my[stride] / w0, d = my[1] / w0;
  const double determinant = a * d - b * c;
  // A determinant within its own rounding has no sign to trust.
  if (!(std::fabs(determinant) > 8 * kEpsilon * (std::fabs(a * d) + std::fabs(b * c)))) return {};
  leaf->c11 = d / determinant;
  leaf->c12 = -b / determinant;
  leaf->c21 = -c / determinant;
  leaf->c22 = a / determinant;

  // Form G, W and Q in the leaf's own scale.
  double* g1 = monomials;
  double* g2 = monomials + n;
  const double c11 = leaf->c11 / w0, c12 = leaf->c12 / w0, c21 = leaf->c21 / w0, c22 = leaf->c22 / w0;
  for (int i = 0; i < n; ++i) {
    g1[i] = c11 * mx[i] + c12 * my[i];
    g2[i] = c21 * mx[i] + c22 * my[i];
  }
  const double scale =
      std::fmax(std::fabs(leaf->c11) + std::fabs(leaf->c12), std::fabs(leaf->c21) + std::fabs(leaf->c22));
  double* next = monomials + 2 * n;
  Bounds bw;
  if (rule.weight_varies) {
    for (int i = 0; i < n; ++i) next[i] = mw[i] / w0;
    bw = Bound(next, pu, pv);
    next += n;
  }

  // Bound ‖I − G'‖, the range of b, and then ‖I − H'‖ = ‖I − G' + b⊗W'‖ (Laws 1 and 2).
  Bounds b1 = Bound(g1, pu, pv), b2 = Bound(g2, pu, pv);
  // (The linear terms of G are the identity but for rounding.)
  b1.ds += std::fabs(g1[stride] - 1);
  b1.dt += std::fabs(g1[1]);
  b2.ds += std::fabs(g2[stride]);
  b2.dt += std::fabs(g2[1] - 1);
  const auto fail = [&] {
    const double* w = rule.weight_varies ? monomials + 2 * n : nullptr;
    return ByDegrees(pu, pv, [&]<int P, int Q>() { return AfterHalving<P, Q>(g1, g2, w, pu, pv); });
  };
  const double kappa_g = std::fmax(b1.ds + b1.dt, b2.ds + b2.dt);
  if (!(kappa_g <= kMaxKappa)) return fail();
  double w_low = 1, slope = 0;
  if (rule.weight_varies) {
    w_low = 1 - bw.value;
    if (!(w_low > 0)) return fail();
    slope = bw.ds + bw.dt + std::fabs(monomials[2 * n + stride]) + std::fabs(monomials[2 * n + 1]);
  }
  const double b_limit = (1 + kappa_g) * kEnlarged / w_low;
  double kappa = kappa_g + b_limit * slope;
  if (!(kappa <= kMaxKappa)) return fail();
  // The kernel's H differs from the surface's by its rounding: conversion loses a few units per degree of the
  // net's size, evaluation a few of G's, and the net's own error counts in full.
  const double growth =
      std::ldexp(1.0, (pu + pv + 1) / 2);  // of |CenteredMonomialMatrix| on smooth data, see tests
  const double magnitude = std::fabs(shift_x) + std::fabs(shift_y);
  const double net_error =
      EnlargedPowers()[pu + pv] *
      (std::fmax(net.error[kX], net.error[kY]) + (magnitude + size / w0) * net.error[kW]) / w0;
  leaf->rounding = arithmetic.epsilon * 4 * (pu + pv + 2) * (b_limit + 1) +
                   scale * (kEpsilon * (growth * (pu + pv) * size / w0 + 4 * magnitude) + net_error);
  // So does its derivative, by Markov's inequality.
  const double degree = std::fmax(pu, pv);
  const double kappa_net = 2 * degree * degree * leaf->rounding;
  kappa += kappa_net;
  if (!(kappa_net <= 0.0625)) return {};
  const double lipschitz = std::fmax(b1.second, b2.second) + b_limit * bw.second;
  const double inverse_gap = 1 / (1 - kappa);
  const double newton_factor = 0.5 * lipschitz * inverse_gap;
  // The start x = b is off by at most kappa·kEnlarged (H(0) = −b).
  if (!(newton_factor * kappa * kEnlarged < 0.5)) return fail();

  leaf->b_limit = b_limit * (1 + 8 * arithmetic.epsilon) + leaf->rounding;
  leaf->inverse_gap = inverse_gap;
  leaf->newton_factor = newton_factor;

  leaf->root_error = arithmetic.tolerance + 2 * leaf->rounding * inverse_gap;
  if (!(leaf->root_error <= kMaxRootError)) return {};
  leaf->flags = static_cast<std::uint16_t>((rule.weight_varies ? kLeafWeightVaries : 0) |
                                           (rule.perspective ? kLeafPerspective : 0) |
                                           (rule.depth_varies ? kLeafDepthVaries : 0));
  const double* weight = rule.weight_varies ? monomials + 2 * n : nullptr;
  if (!CertifyDepth(net, rule, arithmetic, w0, w_low, {bw.value, slope}, weight, leaf, next)) return fail();
  leaf->degree_u = static_cast<std::uint8_t>(pu);
  leaf->degree_v = static_cast<std::uint8_t>(pv);
  return {true, 0, 0};
}

}  // namespace facetless
