// The Newton–Cramer iteration of the lanes on one certified leaf, and the depths of the roots. leaf.h has the
// laws. Each tile_kernel_<isa>.cpp includes this file once, through tile_kernel.inl.h.
#pragma once

#include "render/kernels/lanes.h"
#include "render/kernels/tile_kernel.h"

namespace facetless::FACETLESS_KERNEL_NAMESPACE {
namespace {

// The value and the first derivatives of a polynomial. P and Q are the degrees, or −1 to take them from the
// leaf.
struct Jet {
  Lane f, ds, dt;
};

// It is always part of its caller, and loops of constant length are unrolled: a call would keep the sums in memory.
template <int P, int Q>
[[gnu::always_inline]] inline Jet Evaluate(const Real* c, int p, int q, Lane s, Lane t) {
  const int degree_u = P >= 0 ? P : p, degree_v = Q >= 0 ? Q : q;
  // Evaluate row i along v by Horner's rule, with its derivative. The highest power needs no operation.
  const auto row_at = [&](int i) __attribute__((always_inline)) {
    const Real* row = c + i * (degree_v + 1);
    struct {
      Lane value, slope;
    } at{Fma(Set(row[degree_v]), t, Set(row[degree_v - 1])), Set(row[degree_v])};
#pragma GCC unroll 8
    for (int j = degree_v - 2; j >= 0; --j) {
      at.slope = Fma(at.slope, t, at.value);
      at.value = Fma(at.value, t, Set(row[j]));
    }
    return at;
  };
  // Then evaluate along u.
  const auto last = row_at(degree_u), before = row_at(degree_u - 1);
  Jet jet{Fma(last.value, s, before.value), last.value, Fma(last.slope, s, before.slope)};
#pragma GCC unroll 3
  for (int i = degree_u - 2; i >= 0; --i) {
    const auto row = row_at(i);
    jet.ds = Fma(jet.ds, s, jet.f);
    jet.f = Fma(jet.f, s, row.value);
    jet.dt = Fma(jet.dt, s, row.slope);
  }
  return jet;
}

// A polynomial's value without its constant term.
template <int P, int Q>
inline Lane Rest(const Real* c, int p, int q, Lane s, Lane t) {
  const int degree_u = P >= 0 ? P : p, degree_v = Q >= 0 ? Q : q;
  Lane f = Set(0);
  for (int i = degree_u; i >= 0; --i) {
    const Real* row = c + i * (degree_v + 1);
    Lane value = Set(row[degree_v]);
    for (int j = degree_v - 1; j > 0; --j) value = Fma(value, t, Set(row[j]));
    if (degree_v > 0) value = i == 0 ? value * t : Fma(value, t, Set(row[0]));
    f = Fma(f, s, value);
  }
  return f;
}

inline Lane Clamp(Lane x, double limit) {
  x = Select(x < Set(-limit), Set(-limit), x);
  return Select(Set(limit) < x, Set(limit), x);
}

// Lanes whose (s, t) lies farther than `error` from everything that the leaf accepts: |s|, |t| ≤ reach.
inline Mask Outside(Lane s, Lane t, Lane error, Lane reach) {
  return (reach < Abs(s) - error) | (reach < Abs(t) - error);
}

struct Solution {
  Lane s, t, depth;  // depth: relative to the leaf's depth_scale, see DepthOf
  unsigned hit = 0, unconverged = 0;
  unsigned started = 0, iterations = 0;
};

template <int P, int Q, bool kWeightVaries>
inline Solution Solve(const CertifiedLeaf& leaf, double root_error, const double* x, const double* y,
                      Mask lanes) {
  const int p = leaf.degree_u, q = leaf.degree_v;
  const int n = (p + 1) * (q + 1);
  const Real* g1 = CoefficientsOf<Real>(leaf);
  const Real* g2 = g1 + n;
  const Real* w = g2 + n;

  // Transform the pixel into the coordinates of the leaf: b = C·(r − center). A ray far outside is a proven
  // miss (leaf.h, law 2).
  const Lane b1 = Local(x, leaf.center_x, leaf.c11, y, leaf.center_y, leaf.c12);
  const Lane b2 = Local(x, leaf.center_x, leaf.c21, y, leaf.center_y, leaf.c22);
  const Lane limit = Set(leaf.b_limit);
  Mask active = lanes & (Abs(b1) <= limit) & (Abs(b2) <= limit);

  Solution solution{Set(0), Set(0), Set(0)};
  solution.started = static_cast<unsigned>(__builtin_popcount(ToBits(active)));
  const Lane inverse_gap = Set(leaf.inverse_gap), newton_factor = Set(leaf.newton_factor),
             rounding = Set(leaf.rounding);
  const Lane chord_factor = inverse_gap - Set(1);  // kappa/(1 − kappa)
  const Lane floor = rounding * inverse_gap;
  const Lane tolerance = Set(root_error);
  const Lane reach = Set(1 + Overlap(root_error));
  const Lane enlarged = Set(kEnlarged);
  Lane s = Clamp(b1, kEnlarged), t = Clamp(b2, kEnlarged);
  Mask hit = FromBits(0);
  for (int iteration = 0; iteration < kMaxIterations && !None(active); ++iteration) {
    solution.iterations += static_cast<unsigned>(__builtin_popcount(ToBits(active)));

    // F and its derivatives first, then 2×2 determinants of those.
    Jet h1 = Evaluate<P, Q>(g1, p, q, s, t);
    Jet h2 = Evaluate<P, Q>(g2, p, q, s, t);
    if constexpr (kWeightVaries) {
      const Jet jw = Evaluate<P, Q>(w, p, q, s, t);
      h1 = {Fnma(b1, jw.f, h1.f), Fnma(b1, jw.ds, h1.ds), Fnma(b1, jw.dt, h1.dt)};
      h2 = {Fnma(b2, jw.f, h2.f), Fnma(b2, jw.ds, h2.ds), Fnma(b2, jw.dt, h2.dt)};
    } else {
      h1.f = h1.f - b1;
      h2.f = h2.f - b2;
    }
    const Lane inverse = Set(1) / Fnma(h1.dt, h2.ds, h1.ds * h2.dt);
    const Lane next_s = Fnma(Fnma(h1.dt, h2.f, h1.f * h2.dt), inverse, s);
    const Lane next_t = Fnma(Fnma(h1.f, h2.ds, h1.ds * h2.f), inverse, t);

    // Bound the distance of the root from this iterate and from the next one (law 3).
    const Lane a1 = Abs(h1.f), a2 = Abs(h2.f);
    const Lane residual = Select(a1 < a2, a2, a1) + rounding;
    const Lane from_here = residual * inverse_gap;
    const Lane from_next = Fma(newton_factor * from_here, from_here, floor);
    // A chord step x − H contracts by kappa. It proves a miss if the iterate is clamped to the border and
    // Newton's bound stays large.
    const Lane from_chord = Fma(residual, chord_factor, rounding);

    const Mask miss =
        Outside(next_s, next_t, from_next, reach) | Outside(s - h1.f, t - h2.f, from_chord, reach);
    // The root exists if its ball lies in the enlarged leaf.
    const Mask exists = (Abs(s) + from_here <= enlarged) & (Abs(t) + from_here <= enlarged);
    const Mask done = (from_next <= tolerance) & exists;
    const Mask inside = (Abs(next_s) <= reach) & (Abs(next_t) <= reach);
    const Mask found = active & done & inside;
    solution.s = Select(found, next_s, solution.s);
    solution.t = Select(found, next_t, solution.t);
    hit = hit | found;
    active = AndNot(miss | done, active);
    s = Clamp(next_s, kEnlarged);
    t = Clamp(next_t, kEnlarged);
  }
  solution.unconverged = ToBits(active);
  solution.hit = ToBits(hit);
  if (solution.hit == 0) return solution;

  // The depth is Q/W, or W/Q with W/Q − 1 = (w − q)/(1 + q) for the varying parts w and q.
  const Real* next = w + (kWeightVaries ? n : 0);
  const Lane weight = kWeightVaries ? Rest<P, Q>(w, p, q, solution.s, solution.t) : Set(0);
  const bool depth_varies = (leaf.flags & kLeafDepthVaries) != 0;
  const Lane depth = depth_varies ? Rest<P, Q>(next, p, q, solution.s, solution.t) : Set(0);
  if (leaf.flags & kLeafPerspective) {
    solution.depth = (weight - depth) / (Set(1) + depth);
  } else if (depth_varies) {
    solution.depth = (depth + Set(next[0])) / (Set(1) + weight);
  }
  return solution;
}

// Converts kLanes relative depths to depths.
inline void Depths(const CertifiedLeaf& leaf, Lane relative, double* depth) {
  const Wide scale = SetWide(leaf.depth_scale),
             factor = SetWide((leaf.flags & kLeafPerspective) ? leaf.depth_scale : 1);
  StoreWide(relative, depth);
  for (int i = 0; i < kLanes; i += kWideLanes) Store(scale + factor * Load(depth + i), depth + i);
}

// `root_error`: the leaf's, of this kernel.
inline Solution SolveLeaf(const CertifiedLeaf& leaf, double root_error, const double* x, const double* y,
                          unsigned lanes) {
  return ByDegrees(leaf.degree_u, leaf.degree_v, [&]<int P, int Q>() {
    return (leaf.flags & kLeafWeightVaries) ? Solve<P, Q, true>(leaf, root_error, x, y, FromBits(lanes))
                                            : Solve<P, Q, false>(leaf, root_error, x, y, FromBits(lanes));
  });
}

}  // namespace
}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE
