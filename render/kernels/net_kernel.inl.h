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
inline NetVerdict AfterHalving(const double* monomials, bool weight_varies, int degree_u, int degree_v) {
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

// Certifies one net of degrees P and Q (0: the degrees are known only at run time), step by step.
template <int P, int Q>
class Certifier {
 public:
  // The numbers that describe a net of centred monomials. Arrays are outside of the object, so that the
  // compiler can keep the object in registers.
  static constexpr int kSize = P > 0 ? (P + 1) * (Q + 1) * kNetComponents : kNumbers;

  // `room` has kSize numbers.
  Certifier(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic, CertifiedLeaf* leaf,
            double* room)
      : net_(net),
        rule_(rule),
        arithmetic_(arithmetic),
        leaf_(leaf),
        pu_(Degree<P>(net.degree_u)),
        pv_(Degree<Q>(net.degree_v)),
        m_(room) {}

  NetVerdict Run(double* monomials) {
    if (!CenterOnPixel() || !InvertJacobian()) return {};
    Normalize();
    Bounds bound = Bound<P, Q>(m_, pu_, pv_);
    Step step = BoundRoot(&bound);
    if (step == Step::kHolds) step = BoundDepth(bound);
    if (step == Step::kTooWide) return AfterHalving<P, Q>(m_, rule_.weight_varies, pu_, pv_);
    if (step == Step::kFails) return {};
    FillLeaf(monomials);
    return {true, 0, 0};
  }

 private:
  enum class Step {
    kHolds,
    kTooWide,  // a bound does not hold, and AfterHalving estimates it after a halving
    kFails     // an error is too large for a certificate
  };

  int stride() const { return pv_ + 1; }
  int points() const { return (pu_ + 1) * stride(); }

  bool CenterOnPixel();
  bool InvertJacobian();
  void Normalize();
  Step BoundRoot(Bounds* bound);
  Step BoundDepth(const Bounds& bound);
  void FillLeaf(double* monomials) const;

  // The parts of the error of the depth.
  struct DepthParts {
    double slope = 0, evaluation = 0, far = 0, divisor = 0;
  };
  bool PerspectiveDepth(const Bounds& bound, DepthParts* parts);
  void OrthographicDepth(const Bounds& bound, DepthParts* parts);
  // Conversion and Horner's rule lose a few units per degree.
  double units() const { return 4 * (pu_ + pv_ + 2) * arithmetic_.epsilon; }

  const BezierNet& net_;
  const DepthRule rule_;
  const KernelArithmetic& arithmetic_;
  CertifiedLeaf* const leaf_;
  const int pu_, pv_;
  double* const m_;  // centred monomials
  // CenterOnPixel: the pixel and depth that the net is shifted by, the size of the shifted net, and its
  // constant terms.
  double shift_x_, shift_y_, depth_middle_, size_, w0_, q0_;
  // BoundRoot: W is at least w_low_ and differs by at most w_rest_ from 1; |W'| is at most slope_.
  double w_low_, w_rest_, slope_, root_error_;
};

// Shifts the origin to the pixel of the middle control point, and in orthographic views also to its depth, so
// that the following numbers are of the size of the leaf and not of the image; converts the net; and moves
// the origin on to the pixel of (0,0).
template <int P, int Q>
inline bool Certifier<P, Q>::CenterOnPixel() {
  const int middle = (pu_ / 2) * stride() + pv_ / 2, n = points();
  const double w_middle = rule_.weight_varies ? net_.at(middle, kW) : 1;
  if (!(w_middle > 0)) return false;
  shift_x_ = net_.at(middle, kX) / w_middle;
  shift_y_ = net_.at(middle, kY) / w_middle;
  depth_middle_ = rule_.perspective ? 0 : net_.at(middle, kQ) / w_middle;
  const double shifts[kNetComponents] = {shift_x_, shift_y_, 0, depth_middle_};
  const Planes shift = LoadPlanes(shifts);
  double shifted[kSize];
  Planes sizes = Same(0);
  for (int i = 0; i < n; ++i) {
    const Planes p = At(net_.value, i);
    const Planes moved = p - shift * Spread<kW>(p);
    sizes = Grown(sizes, Abs(moved));
    Put(moved, shifted, i);
  }
  ToCenteredMonomials<P, Q>(shifted, pu_, pv_, m_);
  double size_of[kNetComponents];
  Store(sizes, size_of);
  size_ = size_of[kX] + size_of[kY];

  w0_ = rule_.weight_varies ? m_[kW] : 1;
  if (!(w0_ > 0)) return false;
  // Round the centre first and then move the net by the exact difference, so that the two are consistent.
  leaf_->center_x = shift_x_ + m_[kX] / w0_;
  leaf_->center_y = shift_y_ + m_[kY] / w0_;
  const double offsets[kNetComponents] = {leaf_->center_x - shift_x_, leaf_->center_y - shift_y_, 0, 0};
  const Planes offset = LoadPlanes(offsets);
  for (int i = 0; i < n; ++i) {
    const Planes p = At(m_, i);
    Put(p - offset * Spread<kW>(p), m_, i);
  }
  return true;
}

template <int P, int Q>
inline bool Certifier<P, Q>::InvertJacobian() {
  const int along_s = kNetComponents * stride(), along_t = kNetComponents;
  const double a = m_[along_s + kX] / w0_, b = m_[along_t + kX] / w0_;
  const double c = m_[along_s + kY] / w0_, d = m_[along_t + kY] / w0_;
  const double determinant = a * d - b * c;
  // The sign of a determinant is not reliable if its magnitude is within its rounding error.
  if (!(std::fabs(determinant) > 8 * kEpsilon * (std::fabs(a * d) + std::fabs(b * c)))) return false;
  leaf_->c11 = d / determinant;
  leaf_->c12 = -b / determinant;
  leaf_->c21 = -c / determinant;
  leaf_->c22 = a / determinant;
  return true;
}

// Forms G, W and Q in the scale of the leaf.
template <int P, int Q>
inline void Certifier<P, Q>::Normalize() {
  q0_ = m_[kQ];
  const double by_x[kNetComponents] = {leaf_->c11 / w0_, leaf_->c21 / w0_, 0, 0},
               by_y[kNetComponents] = {leaf_->c12 / w0_, leaf_->c22 / w0_, 0, 0},
               units_of[kNetComponents] = {1, 1, w0_, rule_.perspective && rule_.depth_varies ? q0_ : w0_};
  const Planes from_x = LoadPlanes(by_x), from_y = LoadPlanes(by_y), unit = LoadPlanes(units_of);
  const int n = points();
  for (int i = 0; i < n; ++i) {
    const Planes p = At(m_, i);
    Put(Join(from_x * Spread<kX>(p) + from_y * Spread<kY>(p), p / unit), m_, i);
  }
}

// Bounds ‖I − G'‖, the range of b, and then ‖I − H'‖ = ‖I − G' + b⊗W'‖ (Laws 1 and 2); and the error of the
// root.
template <int P, int Q>
inline typename Certifier<P, Q>::Step Certifier<P, Q>::BoundRoot(Bounds* bound) {
  const int along_s = kNetComponents * stride(), along_t = kNetComponents;
  // (The linear terms of G are the identity except for rounding.)
  bound->ds[kX] += std::fabs(m_[along_s + kX] - 1);
  bound->dt[kX] += std::fabs(m_[along_t + kX]);
  bound->ds[kY] += std::fabs(m_[along_s + kY]);
  bound->dt[kY] += std::fabs(m_[along_t + kY] - 1);
  const double kappa_g = std::fmax(bound->ds[kX] + bound->dt[kX], bound->ds[kY] + bound->dt[kY]);
  if (!(kappa_g <= kMaxKappa)) return Step::kTooWide;
  w_low_ = 1;
  w_rest_ = slope_ = 0;
  double w_second = 0;
  if (rule_.weight_varies) {
    w_rest_ = bound->value[kW];
    w_second = bound->second[kW];
    w_low_ = 1 - w_rest_;
    if (!(w_low_ > 0)) return Step::kTooWide;
    slope_ = bound->Slope(kW);
  }
  const double b_limit = (1 + kappa_g) * kEnlarged / w_low_;
  double kappa = kappa_g + b_limit * slope_;
  if (!(kappa <= kMaxKappa)) return Step::kTooWide;
  // H as the kernel evaluates it differs from H of the surface: conversion loses a few units per degree,
  // relative to the size of the net; evaluation loses a few units relative to G; and the error of the net
  // counts in full.
  const double growth =
      std::ldexp(1.0, (pu_ + pv_ + 1) / 2);  // of |CenteredMonomialMatrix| on smooth data, see tests
  const double magnitude = std::fabs(shift_x_) + std::fabs(shift_y_);
  const double net_error =
      kEnlargedPowers.value[pu_ + pv_] *
      (std::fmax(net_.error[kX], net_.error[kY]) + (magnitude + size_ / w0_) * net_.error[kW]) / w0_;
  const double scale =
      std::fmax(std::fabs(leaf_->c11) + std::fabs(leaf_->c12), std::fabs(leaf_->c21) + std::fabs(leaf_->c22));
  leaf_->rounding = arithmetic_.epsilon * 4 * (pu_ + pv_ + 2) * (b_limit + 1) +
                    scale * (kEpsilon * (growth * (pu_ + pv_) * size_ / w0_ + 4 * magnitude) + net_error);
  // The derivative of H differs accordingly, by Markov's inequality.
  const double degree = std::fmax(pu_, pv_);
  const double kappa_net = 2 * degree * degree * leaf_->rounding;
  kappa += kappa_net;
  if (!(kappa_net <= 0.0625)) return Step::kFails;
  const double lipschitz = std::fmax(bound->second[kX], bound->second[kY]) + b_limit * w_second;
  const double inverse_gap = 1 / (1 - kappa);
  const double newton_factor = 0.5 * lipschitz * inverse_gap;
  // The error of the start x = b is at most kappa·kEnlarged, because H(0) = −b.
  if (!(newton_factor * kappa * kEnlarged < 0.5)) return Step::kTooWide;

  leaf_->b_limit = b_limit * (1 + 8 * arithmetic_.epsilon) + leaf_->rounding;
  leaf_->inverse_gap = inverse_gap;
  leaf_->newton_factor = newton_factor;
  root_error_ = leaf_->RootError(arithmetic_);
  return root_error_ <= kMaxRootError ? Step::kHolds : Step::kFails;
}

// Bounds the error of the depth (law 6).
template <int P, int Q>
inline typename Certifier<P, Q>::Step Certifier<P, Q>::BoundDepth(const Bounds& bound) {
  DepthParts parts;
  if (rule_.perspective) {
    if (!PerspectiveDepth(bound, &parts)) return Step::kTooWide;
  } else {
    OrthographicDepth(bound, &parts);
  }
  leaf_->depth_error =
      parts.slope * root_error_ + parts.evaluation + NetDepthError(net_, rule_, parts.far, parts.divisor);
  return leaf_->depth_error < INFINITY ? Step::kHolds : Step::kFails;
}

// Returns false if the bounds do not keep Q away from 0.
template <int P, int Q>
inline bool Certifier<P, Q>::PerspectiveDepth(const Bounds& bound, DepthParts* parts) {
  const double q_middle = rule_.depth_varies ? q0_ : net_.at(0, kQ);
  const double q_rest = rule_.depth_varies ? bound.value[kQ] : 0,
               q_slope = rule_.depth_varies ? bound.Slope(kQ) : 0;
  const double q_low = 1 - q_rest;
  if (!(q_middle > 0 && q_low > 0)) return false;
  // depth = scale + scale·(w − q)/(1 + q), with w and q without their constant terms. For a distant
  // rational patch, w and q vary together, and their difference hardly varies at all.
  leaf_->depth_scale = w0_ / q_middle;
  double difference = w_rest_, difference_slope = slope_;
  if (rule_.depth_varies) {
    double apart[kSize];
    const int n = points();
    for (int i = 0; i < n; ++i) {
      const Planes p = At(m_, i);
      Put((rule_.weight_varies ? Spread<kW>(p) : Same(0)) - p, apart, i);
    }
    const Bounds between = Bound<P, Q>(apart, pu_, pv_);
    difference = between.value[kQ];
    difference_slope = between.Slope(kQ);
  }
  const double range = w_rest_ + q_rest;
  parts->slope = leaf_->depth_scale * (difference_slope / q_low + difference * q_slope / (q_low * q_low));
  parts->evaluation = leaf_->depth_scale * (units() * range / q_low * (1 + 1 / q_low) + 4 * kEpsilon);
  parts->far = leaf_->depth_scale * (1 + range / q_low);
  parts->divisor = q_middle * q_low / kEnlargedPowers.value[pu_ + pv_];
  return true;
}

// Computes relative to the depth of the middle, to preserve precision.
template <int P, int Q>
inline void Certifier<P, Q>::OrthographicDepth(const Bounds& bound, DepthParts* parts) {
  leaf_->depth_scale = depth_middle_;
  double q_size = 0;
  if (rule_.depth_varies) {
    q_size = std::fabs(m_[kQ]) + bound.value[kQ];
    parts->slope = bound.Slope(kQ) / w_low_ + q_size * slope_ / (w_low_ * w_low_);
  }
  parts->evaluation = units() * q_size / w_low_ * (1 + 1 / w_low_) +
                      4 * kEpsilon * (std::fabs(leaf_->depth_scale) + q_size / w_low_);
  parts->far = std::fabs(leaf_->depth_scale) + q_size / w_low_;
  parts->divisor = w0_ * w_low_ / kEnlargedPowers.value[pu_ + pv_];
}

template <int P, int Q>
inline void Certifier<P, Q>::FillLeaf(double* monomials) const {
  leaf_->flags = FlagsOf(rule_);
  leaf_->degree_u = static_cast<std::uint8_t>(pu_);
  leaf_->degree_v = static_cast<std::uint8_t>(pv_);
  double* next = monomials;
  const int n = points();
  for (const NetComponent component : {kX, kY, kW, kQ}) {
    if ((component == kW && !rule_.weight_varies) || (component == kQ && !rule_.depth_varies)) continue;
    for (int i = 0; i < n; ++i) *next++ = m_[kNetComponents * i + component];
  }
}

NetVerdict Certify(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic,
                   CertifiedLeaf* leaf, double* monomials) {
  return ByDegrees(net.degree_u, net.degree_v, [&]<int P, int Q>() {
    double room[Certifier<P, Q>::kSize];
    return Certifier<P, Q>(net, rule, arithmetic, leaf, room).Run(monomials);
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
