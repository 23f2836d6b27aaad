// The bodies of NetOperations (nurbs/net_operations.h). Each net_kernel_<isa>.cpp includes this file once,
// after it has set its target.

#include <cmath>

#include "render/kernels/planes.h"
#include "render/nurbs/net_operations.h"

namespace facetless::FACETLESS_PLANES_NAMESPACE {

namespace {

constexpr double kEpsilon = 0x1p-53;  // unit roundoff
constexpr int kNumbers = kNetComponents * kMaxNetPoints;

inline Planes At(const double* net, int i) {
  return LoadPlanes(net + kNetComponents * i);
}
inline void Put(Planes a, double* net, int i) {
  Store(a, net + kNetComponents * i);
}

// The compile-time degree if there is one, or else the degree of the net.
template <int Known>
inline int Degree(int degree) {
  return Known > 0 ? Known : degree;
}

// Halving.

// Halves a line of N+1 points that are `step` apart; if N < 0, its degree is `degree`. Returns the largest
// magnitudes so far, including those of the line.
template <int N>
inline Planes HalveLine(const double* in, int degree, int step, double* low, double* high, Planes largest) {
  const int n = Degree<N>(degree);
  Planes work[(N > 0 ? N : kMaxDegree) + 1];
  for (int k = 0; k <= n; ++k) {
    work[k] = At(in, k * step);
    largest = Grown(largest, Abs(work[k]));
  }
  Put(work[0], low, 0);
  for (int level = 1; level <= n; ++level) {
    for (int k = 0; k <= n - level; ++k) work[k] = Same(0.5) * (work[k] + work[k + 1]);
    Put(work[0], low, level * step);
  }
  for (int k = 0; k <= n; ++k) Put(work[k], high, k * step);
  return largest;
}

void Halve(const BezierNet& net, Direction direction, BezierNet* low, BezierNet* high) {
  const bool along_u = direction == Direction::kU;
  const Planes largest = ByDegrees(net.degree_u, net.degree_v, [&]<int P, int Q>() {
    const int pu = Degree<P>(net.degree_u), pv = Degree<Q>(net.degree_v);
    Planes sizes = Same(0);
    if (along_u) {
      for (int l = 0; l <= pv; ++l) {
        const int at = kNetComponents * l;
        sizes = HalveLine<P>(net.value + at, pu, pv + 1, low->value + at, high->value + at, sizes);
      }
    } else {
      for (int k = 0; k <= pu; ++k) {
        const int at = kNetComponents * k * (pv + 1);
        sizes = HalveLine<Q>(net.value + at, pv, 1, low->value + at, high->value + at, sizes);
      }
    }
    return sizes;
  });
  // Each of the `degree` averages of a halving rounds once, relative to at most the size of the net.
  const double rounding = kEpsilon * (along_u ? net.degree_u : net.degree_v);
  const Planes error = LoadPlanes(net.error) + Same(rounding) * largest;
  Store(error, low->error);
  Store(error, high->error);
}

// Centred monomials.

// Converts one line of a net, whose points are `step` apart. The matrix is written out; its even and odd rows
// share sums and differences.
template <int N>
inline void LineToMonomials(const double* in, double* out, int step) {
  if constexpr (N == 1) {
    const Planes a = At(in, 0), b = At(in, step);
    Put(Same(0.5) * (a + b), out, 0);
    Put(Same(0.5) * (b - a), out, step);
  } else if constexpr (N == 2) {
    const Planes first = At(in, 0), last = At(in, 2 * step);
    const Planes ends = first + last, middle = Same(2) * At(in, step);
    Put(Same(0.25) * (ends + middle), out, 0);
    Put(Same(0.5) * (last - first), out, step);
    Put(Same(0.25) * (ends - middle), out, 2 * step);
  } else {
    static_assert(N == 3);
    const Planes a = At(in, 0), b = At(in, step), c = At(in, 2 * step), d = At(in, 3 * step);
    const Planes ends = a + d, middle = b + c, outer = d - a, inner = c - b;
    Put(Same(0.125) * (ends + Same(3) * middle), out, 0);
    Put(Same(0.375) * (outer + inner), out, step);
    Put(Same(0.375) * (ends - middle), out, 2 * step);
    Put(Same(0.125) * (outer - Same(3) * inner), out, 3 * step);
  }
}

// Writes the coefficients of s^i·t^j to out[i·stride + j].
template <int P, int Q>
inline void ToCenteredMonomials(const double* in, int degree_u, int degree_v, double* out) {
  const int pu = Degree<P>(degree_u), pv = Degree<Q>(degree_v), stride = pv + 1;
  if constexpr (P > 0) {
    double half[kNetComponents * (P + 1) * (Q + 1)];
    for (int l = 0; l <= Q; ++l)
      LineToMonomials<P>(in + kNetComponents * l, half + kNetComponents * l, Q + 1);
    for (int k = 0; k <= P; ++k)
      LineToMonomials<Q>(half + kNetComponents * k * (Q + 1), out + kNetComponents * k * (Q + 1), 1);
  } else {
    const MonomialMatrix& tu = CenteredMonomialMatrix(pu);
    const MonomialMatrix& tv = CenteredMonomialMatrix(pv);
    double half[kNumbers];
    for (int k = 0; k <= pu; ++k) {
      for (int j = 0; j <= pv; ++j) {
        Planes sum = Same(0);
        for (int l = 0; l <= pv; ++l) sum = sum + Same(tv[j][l]) * At(in, k * stride + l);
        Put(sum, half, k * stride + j);
      }
    }
    for (int i = 0; i <= pu; ++i) {
      for (int j = 0; j <= pv; ++j) {
        Planes sum = Same(0);
        for (int k = 0; k <= pu; ++k) sum = sum + Same(tu[i][k]) * At(half, k * stride + j);
        Put(sum, out, i * stride + j);
      }
    }
  }
}

// Certificates.

// kEnlarged^n
struct Powers {
  double value[2 * kMaxDegree + 2];
};
constexpr Powers kEnlargedPowers = [] {
  Powers powers{};
  powers.value[0] = 1;
  for (int i = 1; i < 2 * kMaxDegree + 2; ++i) powers.value[i] = powers.value[i - 1] * kEnlarged;
  return powers;
}();

// Sums of |coefficients|, which bound each component (a polynomial in s and t) over the enlarged leaf.
struct Bounds {
  double value[kNetComponents];                   // of the component, without its constant term
  double ds[kNetComponents], dt[kNetComponents];  // of the first derivatives, without their constant terms
  double second[kNetComponents];                  // |∂ss| + 2|∂st| + |∂tt|
  double along_s[kNetComponents], along_t[kNetComponents];  // magnitudes of the linear terms

  // Bounds |∂s| + |∂t|, linear terms included.
  double Slope(NetComponent c) const { return ds[c] + dt[c] + along_s[c] + along_t[c]; }
};

template <int P, int Q>
inline Bounds Bound(const double* monomials, int degree_u, int degree_v) {
  const int pu = Degree<P>(degree_u), pv = Degree<Q>(degree_v);
  const double* r = kEnlargedPowers.value;
  // A term s^i·t^j is at most r^(i+j). For each row, compute the sum and its first and second moments in j.
  // Constant and linear terms are left out, except that `value` includes the linear ones.
  Planes value = Same(0), by_s = Same(0), by_t = Same(0), second = Same(0);
  for (int i = 0; i <= pu; ++i) {
    Planes sum = Same(0), first = Same(0), second_t = Same(0);
    for (int j = i < 2 ? 2 - i : 0; j <= pv; ++j) {
      const Planes term = Abs(At(monomials, i * (pv + 1) + j)) * Same(r[i + j]);
      sum = sum + term;
      first = first + Same(j) * term;
      second_t = second_t + Same(j * (j - 1)) * term;
    }
    value = value + sum;
    by_s = by_s + Same(i) * sum;
    by_t = by_t + first;
    second = second + (Same(i * (i - 1)) * sum + Same(2 * i) * first + second_t);
  }
  const Planes along_s = Abs(At(monomials, pv + 1)), along_t = Abs(At(monomials, 1));
  Bounds b;
  Store(value + Same(kEnlarged) * (along_s + along_t), b.value);
  Store(by_s / Same(kEnlarged), b.ds);
  Store(by_t / Same(kEnlarged), b.dt);
  Store(second / Same(kEnlarged * kEnlarged), b.second);
  Store(along_s, b.along_s);
  Store(along_t, b.along_t);
  return b;
}

// The ‖I − H'‖ to expect after halving in u or in v: the monomial s^i·t^j shrinks by 2^−i or 2^−j, and the
// row of C that belongs to the halved direction doubles.
template <int P, int Q>
inline Verdict AfterHalving(const double* monomials, bool weight_varies, int degree_u, int degree_v) {
  const int pu = Degree<P>(degree_u), pv = Degree<Q>(degree_v);
  Planes u = Same(0), v = Same(0);
  double factor_u = 1;
  for (int i = 0; i <= pu; ++i, factor_u *= 0.5) {
    double factor_v = 1;
    for (int j = 0; j <= pv; ++j, factor_v *= 0.5) {
      Planes size = Abs(At(monomials, i * (pv + 1) + j));
      if (i + j < 2) size = Join(Same(0), size);  // G's linear terms are the identity
      u = u + size * Same((i + j) * factor_u);
      v = v + size * Same((i + j) * factor_v);
    }
  }
  double by_u[kNetComponents], by_v[kNetComponents];
  Store(u, by_u);
  Store(v, by_v);
  return {false, std::fmax(2 * by_u[kX], by_u[kY]) + (weight_varies ? by_u[kW] : 0),
          std::fmax(by_v[kX], 2 * by_v[kY]) + (weight_varies ? by_v[kW] : 0)};
}

template <int P, int Q>
Verdict CertifyDegrees(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic,
                       CertifiedLeaf* leaf, double* monomials) {
  const int pu = Degree<P>(net.degree_u), pv = Degree<Q>(net.degree_v), stride = pv + 1,
            n = (pu + 1) * stride;
  constexpr int kSize = P > 0 ? kNetComponents * (P + 1) * (Q + 1) : kNumbers;

  // Shift the origin to the pixel of the middle control point, and in orthographic views also to its depth,
  // so that the following numbers are of the size of the leaf and not of the image.
  const int middle = (pu / 2) * stride + pv / 2;
  const double w_middle = rule.weight_varies ? net.at(middle, kW) : 1;
  if (!(w_middle > 0)) return {};
  const double shift_x = net.at(middle, kX) / w_middle, shift_y = net.at(middle, kY) / w_middle;
  const double depth_middle = rule.perspective ? 0 : net.at(middle, kQ) / w_middle;
  const double shifts[kNetComponents] = {shift_x, shift_y, 0, depth_middle};
  const Planes shift = LoadPlanes(shifts);
  double shifted[kSize], m[kSize];
  Planes sizes = Same(0);
  for (int i = 0; i < n; ++i) {
    const Planes p = At(net.value, i);
    const Planes moved = p - shift * Spread<kW>(p);
    sizes = Grown(sizes, Abs(moved));
    Put(moved, shifted, i);
  }
  ToCenteredMonomials<P, Q>(shifted, pu, pv, m);
  double size_of[kNetComponents];
  Store(sizes, size_of);
  const double size = size_of[kX] + size_of[kY];

  // Move the origin to the pixel of (0,0).
  const double w0 = rule.weight_varies ? m[kW] : 1;
  if (!(w0 > 0)) return {};
  // Round the centre first and then move the net by the exact difference, so that the two are consistent.
  leaf->center_x = shift_x + m[kX] / w0;
  leaf->center_y = shift_y + m[kY] / w0;
  const double offsets[kNetComponents] = {leaf->center_x - shift_x, leaf->center_y - shift_y, 0, 0};
  const Planes offset = LoadPlanes(offsets);
  for (int i = 0; i < n; ++i) {
    const Planes p = At(m, i);
    Put(p - offset * Spread<kW>(p), m, i);
  }

  // Invert the Jacobian there.
  const int along_s = kNetComponents * stride, along_t = kNetComponents;
  const double a = m[along_s + kX] / w0, b = m[along_t + kX] / w0;
  const double c = m[along_s + kY] / w0, d = m[along_t + kY] / w0;
  const double determinant = a * d - b * c;
  // The sign of a determinant is not reliable if its magnitude is within its rounding error.
  if (!(std::fabs(determinant) > 8 * kEpsilon * (std::fabs(a * d) + std::fabs(b * c)))) return {};
  leaf->c11 = d / determinant;
  leaf->c12 = -b / determinant;
  leaf->c21 = -c / determinant;
  leaf->c22 = a / determinant;

  // Form G, W and Q in the scale of the leaf.
  const double q0 = m[kQ];
  const double by_x[kNetComponents] = {leaf->c11 / w0, leaf->c21 / w0, 0, 0},
               by_y[kNetComponents] = {leaf->c12 / w0, leaf->c22 / w0, 0, 0},
               units_of[kNetComponents] = {1, 1, w0, rule.perspective && rule.depth_varies ? q0 : w0};
  const Planes from_x = LoadPlanes(by_x), from_y = LoadPlanes(by_y), unit = LoadPlanes(units_of);
  for (int i = 0; i < n; ++i) {
    const Planes p = At(m, i);
    Put(Join(from_x * Spread<kX>(p) + from_y * Spread<kY>(p), p / unit), m, i);
  }
  const double scale =
      std::fmax(std::fabs(leaf->c11) + std::fabs(leaf->c12), std::fabs(leaf->c21) + std::fabs(leaf->c22));

  // Bound ‖I − G'‖, the range of b, and then ‖I − H'‖ = ‖I − G' + b⊗W'‖ (Laws 1 and 2).
  Bounds bound = Bound<P, Q>(m, pu, pv);
  // (The linear terms of G are the identity except for rounding.)
  bound.ds[kX] += std::fabs(m[along_s + kX] - 1);
  bound.dt[kX] += std::fabs(m[along_t + kX]);
  bound.ds[kY] += std::fabs(m[along_s + kY]);
  bound.dt[kY] += std::fabs(m[along_t + kY] - 1);
  const auto fail = [&] { return AfterHalving<P, Q>(m, rule.weight_varies, pu, pv); };
  const double kappa_g = std::fmax(bound.ds[kX] + bound.dt[kX], bound.ds[kY] + bound.dt[kY]);
  if (!(kappa_g <= kMaxKappa)) return fail();
  double w_low = 1, slope = 0, w_rest = 0, w_second = 0;
  if (rule.weight_varies) {
    w_rest = bound.value[kW];
    w_second = bound.second[kW];
    w_low = 1 - w_rest;
    if (!(w_low > 0)) return fail();
    slope = bound.Slope(kW);
  }
  const double b_limit = (1 + kappa_g) * kEnlarged / w_low;
  double kappa = kappa_g + b_limit * slope;
  if (!(kappa <= kMaxKappa)) return fail();
  // H as the kernel evaluates it differs from H of the surface: conversion loses a few units per degree,
  // relative to the size of the net; evaluation loses a few units relative to G; and the error of the net
  // counts in full.
  const double growth =
      std::ldexp(1.0, (pu + pv + 1) / 2);  // of |CenteredMonomialMatrix| on smooth data, see tests
  const double magnitude = std::fabs(shift_x) + std::fabs(shift_y);
  const double net_error =
      kEnlargedPowers.value[pu + pv] *
      (std::fmax(net.error[kX], net.error[kY]) + (magnitude + size / w0) * net.error[kW]) / w0;
  leaf->rounding = arithmetic.epsilon * 4 * (pu + pv + 2) * (b_limit + 1) +
                   scale * (kEpsilon * (growth * (pu + pv) * size / w0 + 4 * magnitude) + net_error);
  // The derivative of H differs accordingly, by Markov's inequality.
  const double degree = std::fmax(pu, pv);
  const double kappa_net = 2 * degree * degree * leaf->rounding;
  kappa += kappa_net;
  if (!(kappa_net <= 0.0625)) return {};
  const double lipschitz = std::fmax(bound.second[kX], bound.second[kY]) + b_limit * w_second;
  const double inverse_gap = 1 / (1 - kappa);
  const double newton_factor = 0.5 * lipschitz * inverse_gap;
  // The error of the start x = b is at most kappa·kEnlarged, because H(0) = −b.
  if (!(newton_factor * kappa * kEnlarged < 0.5)) return fail();

  leaf->b_limit = b_limit * (1 + 8 * arithmetic.epsilon) + leaf->rounding;
  leaf->inverse_gap = inverse_gap;
  leaf->newton_factor = newton_factor;

  const double root_error = leaf->RootError(arithmetic);
  if (!(root_error <= kMaxRootError)) return {};

  // Bound the error of the depth (law 6). Conversion and Horner's rule lose a few units per degree.
  const double units = 4 * (pu + pv + 2) * arithmetic.epsilon;
  double depth_slope = 0, evaluation = 0, far = 0, divisor = 0;
  if (rule.perspective) {
    const double q_middle = rule.depth_varies ? q0 : net.at(0, kQ);
    const double q_rest = rule.depth_varies ? bound.value[kQ] : 0,
                 q_slope = rule.depth_varies ? bound.Slope(kQ) : 0;
    const double q_low = 1 - q_rest;
    if (!(q_middle > 0 && q_low > 0)) return fail();
    // depth = scale + scale·(w − q)/(1 + q), with w and q without their constant terms. For a distant
    // rational patch, w and q vary together, and their difference hardly varies at all.
    leaf->depth_scale = w0 / q_middle;
    double difference = w_rest, difference_slope = slope;
    if (rule.depth_varies) {
      double apart[kSize];
      for (int i = 0; i < n; ++i) {
        const Planes p = At(m, i);
        Put((rule.weight_varies ? Spread<kW>(p) : Same(0)) - p, apart, i);
      }
      const Bounds between = Bound<P, Q>(apart, pu, pv);
      difference = between.value[kQ];
      difference_slope = between.Slope(kQ);
    }
    const double range = w_rest + q_rest;
    depth_slope = leaf->depth_scale * (difference_slope / q_low + difference * q_slope / (q_low * q_low));
    evaluation = leaf->depth_scale * (units * range / q_low * (1 + 1 / q_low) + 4 * kEpsilon);
    far = leaf->depth_scale * (1 + range / q_low);
    divisor = q_middle * q_low / kEnlargedPowers.value[pu + pv];
  } else {
    // Compute relative to the depth of the middle, to preserve precision.
    leaf->depth_scale = depth_middle;
    double q_size = 0;
    if (rule.depth_varies) {
      q_size = std::fabs(m[kQ]) + bound.value[kQ];
      depth_slope = bound.Slope(kQ) / w_low + q_size * slope / (w_low * w_low);
    }
    evaluation = units * q_size / w_low * (1 + 1 / w_low) +
                 4 * kEpsilon * (std::fabs(leaf->depth_scale) + q_size / w_low);
    far = std::fabs(leaf->depth_scale) + q_size / w_low;
    divisor = w0 * w_low / kEnlargedPowers.value[pu + pv];
  }
  leaf->depth_error = depth_slope * root_error + evaluation + NetDepthError(net, rule, far, divisor);
  if (!(leaf->depth_error < INFINITY)) return {};

  leaf->flags = FlagsOf(rule);
  leaf->degree_u = static_cast<std::uint8_t>(pu);
  leaf->degree_v = static_cast<std::uint8_t>(pv);
  double* next = monomials;
  for (const NetComponent component : {kX, kY, kW, kQ}) {
    if ((component == kW && !rule.weight_varies) || (component == kQ && !rule.depth_varies)) continue;
    for (int i = 0; i < n; ++i) *next++ = m[kNetComponents * i + component];
  }
  return {true, 0, 0};
}

Verdict Certify(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic, CertifiedLeaf* leaf,
                double* monomials) {
  return ByDegrees(net.degree_u, net.degree_v, [&]<int P, int Q>() {
    return CertifyDegrees<P, Q>(net, rule, arithmetic, leaf, monomials);
  });
}

// Measures.

NetBox Project(const BezierNet& net, DepthRule rule, double half_window) {
  NetBox box;
  Planes low = Same(INFINITY), high = Same(-INFINITY), smallest = Same(INFINITY);
  for (int i = 0; i < net.points(); ++i) {
    const double w = net.at(i, kW);
    if (!(w > net.error[kW])) {
      box.in_front = false;
      return box;
    }
    const Planes p = At(net.value, i);
    const Planes image = rule.weight_varies ? p * Same(1 / w) : p;
    low = Min(low, image);
    high = Max(high, image);
    smallest = Min(smallest, p);
    if (rule.perspective) {
      const double depth = w / net.at(i, kQ);
      box.near_depth = depth < box.near_depth ? depth : box.near_depth;
      box.far_depth = box.far_depth < depth ? depth : box.far_depth;
    }
  }
  double least[kNetComponents], most[kNetComponents], divisor[kNetComponents];
  Store(low, least);
  Store(high, most);
  Store(smallest, divisor);
  box.x_low = least[kX];
  box.x_high = most[kX];
  box.y_low = least[kY];
  box.y_high = most[kY];
  if (!rule.perspective) box.near_depth = least[kQ], box.far_depth = most[kQ];
  // Bound the error of the pixel, using the size of the window, and the error of the depth.
  box.error = (std::fmax(net.error[kX], net.error[kY]) + half_window * net.error[kW]) / divisor[kW];
  const double far = std::fmax(std::fabs(box.near_depth), std::fabs(box.far_depth));
  const double depth_error =
      NetDepthError(net, rule, far, divisor[rule.perspective ? kQ : kW]) + far * 0x1p-50;
  const bool known = depth_error < INFINITY;
  box.near_depth = known ? box.near_depth - depth_error : -INFINITY;
  box.far_depth = known ? box.far_depth + depth_error : INFINITY;
  return box;
}

// The largest first differences of the points `at(i)` along both directions.
template <typename Points>
inline void LargestDifferences(int degree_u, int degree_v, const Points& at, Planes* along_u,
                               Planes* along_v) {
  const int stride = degree_v + 1;
  *along_u = *along_v = Same(0);
  for (int k = 0; k <= degree_u; ++k) {
    for (int l = 0; l <= degree_v; ++l) {
      const int i = k * stride + l;
      const Planes here = at(i);
      if (k < degree_u) *along_u = Max(*along_u, Abs(at(i + stride) - here));
      if (l < degree_v) *along_v = Max(*along_v, Abs(at(i + 1) - here));
    }
  }
}

Extent Measure(const BezierNet& net, DepthRule rule, double half_window, bool in_front) {
  const bool divide = in_front && rule.weight_varies;
  double image[kNumbers];
  for (int i = 0; divide && i < net.points(); ++i) Put(At(net.value, i) * Same(1 / net.at(i, kW)), image, i);
  const double* points = divide ? image : net.value;
  Planes along_u, along_v;
  LargestDifferences(
      net.degree_u, net.degree_v, [&](int i) { return At(points, i); }, &along_u, &along_v);
  double u[kNetComponents], v[kNetComponents];
  Store(along_u, u);
  Store(along_v, v);
  Extent extent{net.degree_u * std::fmax(u[kX], u[kY]), net.degree_v * std::fmax(v[kX], v[kY])};
  if (!in_front) {
    extent.u = std::fmax(extent.u, half_window * net.degree_u * u[kW]);
    extent.v = std::fmax(extent.v, half_window * net.degree_v * v[kW]);
  }
  return extent;
}

// The larger of the magnitudes of both ends, per component.
inline Planes Size(Planes low, Planes high) {
  return Max(Abs(low), Abs(high));
}

// Returns whether a range, widened by its error, excludes zero in X or in Y, or, if `all` is set, in any
// component.
inline bool LeavesOutZero(Planes low, Planes high, Planes error, bool all) {
  double least[kNetComponents], most[kNetComponents], slack[kNetComponents];
  Store(low, least);
  Store(high, most);
  Store(error, slack);
  bool out = least[0] > slack[0] || most[0] < -slack[0] || least[1] > slack[1] || most[1] < -slack[1];
  if (all)
    out = out || least[2] > slack[2] || most[2] < -slack[2] || least[3] > slack[3] || most[3] < -slack[3];
  return out;
}

template <int P, int Q>
Residual ComputeResidual(const BezierNet& net, double x, double y) {
  constexpr double kRounding = 2 * kEpsilon;  // rounding of F: one product and one difference
  const int pu = Degree<P>(net.degree_u), pv = Degree<Q>(net.degree_v), stride = pv + 1,
            n = (pu + 1) * stride;
  Residual residual;

  // Compute F in the components X and Y; W does not change.
  const double pixels[kNetComponents] = {x, y, 0, 0};
  const Planes pixel = LoadPlanes(pixels);
  double f[P > 0 ? kNetComponents * (P + 1) * (Q + 1) : kNumbers];
  Planes low = Same(INFINITY), high = Same(-INFINITY), magnitude = Same(0);
  for (int i = 0; i < n; ++i) {
    const Planes p = At(net.value, i);
    const Planes product = pixel * Spread<kW>(p);
    const Planes value = p - product;
    low = Min(low, value);
    high = Max(high, value);
    magnitude = Max(magnitude, Abs(p) + Abs(product));
    Put(value, f, i);
  }
  const Planes error = LoadPlanes(net.error) + Abs(pixel) * Same(net.error[kW]) + Same(kRounding) * magnitude;
  residual.empty = LeavesOutZero(low, high, error, /*all=*/false);
  if (residual.empty) return residual;

  // Test perpendicular to the sides and the diagonals: g = (d × F) for each direction d.
  const auto corner = [&](int k, int l) { return At(f, k * stride + l); };
  const Planes a = corner(0, 0), b = corner(0, pv), c = corner(pu, 0), d = corner(pu, pv);
  const Planes along_u = (c + d) - (a + b), along_v = (b + d) - (a + c), rising = d - a, falling = c - b;
  double direction[4][kNetComponents];
  Store(along_u, direction[0]);
  Store(along_v, direction[1]);
  Store(rising, direction[2]);
  Store(falling, direction[3]);
  double by_x[kNetComponents], by_y[kNetComponents];
  for (int k = 0; k < 4; ++k) by_x[k] = direction[k][kY], by_y[k] = direction[k][kX];
  const Planes from_x = LoadPlanes(by_x), from_y = LoadPlanes(by_y);
  Planes across_low = Same(INFINITY), across_high = Same(-INFINITY);
  for (int i = 0; i < n; ++i) {
    const Planes value = At(f, i);
    const Planes across = from_y * Spread<kY>(value) - from_x * Spread<kX>(value);
    across_low = Min(across_low, across);
    across_high = Max(across_high, across);
  }
  // The error consists of the error of F and the rounding of two products and their difference.
  const Planes size = Size(low, high), reach = error + Same(4 * kEpsilon) * size;
  const Planes across_error = Abs(from_y) * Spread<kY>(reach) + Abs(from_x) * Spread<kX>(reach);
  residual.empty =
      LeavesOutZero(across_low, across_high, Same(1 + 8 * kEpsilon) * across_error, /*all=*/true);
  if (residual.empty) return residual;

  double least[kNetComponents], most[kNetComponents], errors[kNetComponents], u[kNetComponents],
      v[kNetComponents];
  Planes differences_u, differences_v;
  LargestDifferences(
      pu, pv, [&](int i) { return At(f, i); }, &differences_u, &differences_v);
  Store(low, least);
  Store(high, most);
  Store(error, errors);
  Store(differences_u, u);
  Store(differences_v, v);
  residual.size = std::fmax(most[kX] - least[kX], most[kY] - least[kY]);
  residual.error = std::fmax(errors[kX], errors[kY]);
  residual.weight = most[kW];
  residual.extent = {pu * std::fmax(u[kX], u[kY]), pv * std::fmax(v[kX], v[kY])};
  return residual;
}

Residual MeasureResidual(const BezierNet& net, double x, double y) {
  return ByDegrees(net.degree_u, net.degree_v,
                   [&]<int P, int Q>() { return ComputeResidual<P, Q>(net, x, y); });
}

}  // namespace

const NetOperations kNets = {Halve, Certify, Project, Measure, MeasureResidual};

}  // namespace facetless::FACETLESS_PLANES_NAMESPACE
