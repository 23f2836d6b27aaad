// The body of the tile kernel, included once by each tile_kernel_<isa>.cpp after its target is set. See
// tile_kernel.h.

#include <cstdint>
#include <limits>

#include "render/kernels/lanes.h"
#include "render/kernels/tile_kernel.h"

namespace facetless::FACETLESS_KERNEL_NAMESPACE {

namespace {

constexpr std::uint32_t kMiss = 0xffffffffu;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A polynomial's value and first derivatives. P, Q: degrees, or −1 to take them from the leaf.
struct Jet {
  Lane f, ds, dt;
};

template <int P, int Q>
inline Jet Evaluate(const double* c, int p, int q, Lane s, Lane t) {
  const int degree_u = P >= 0 ? P : p, degree_v = Q >= 0 ? Q : q;
  Jet jet{Set(0), Set(0), Set(0)};
  for (int i = degree_u; i >= 0; --i) {
    // Horner along v of row i, with its derivative, …
    const double* row = c + i * (degree_v + 1);
    Lane value = Set(row[degree_v]), slope = Set(0);
    for (int j = degree_v - 1; j >= 0; --j) {
      slope = Fma(slope, t, value);
      value = Fma(value, t, Set(row[j]));
    }
    // … then along u.
    jet.ds = Fma(jet.ds, s, jet.f);
    jet.f = Fma(jet.f, s, value);
    jet.dt = Fma(jet.dt, s, slope);
  }
  return jet;
}

template <int P, int Q>
inline Lane Value(const double* c, int p, int q, Lane s, Lane t) {
  const int degree_u = P >= 0 ? P : p, degree_v = Q >= 0 ? Q : q;
  Lane f = Set(0);
  for (int i = degree_u; i >= 0; --i) {
    const double* row = c + i * (degree_v + 1);
    Lane value = Set(row[degree_v]);
    for (int j = degree_v - 1; j >= 0; --j) value = Fma(value, t, Set(row[j]));
    f = Fma(f, s, value);
  }
  return f;
}

inline Lane Clamp(Lane x, double limit) {
  x = Select(x < Set(-limit), Set(-limit), x);
  return Select(Set(limit) < x, Set(limit), x);
}

// Lanes whose (s, t) lies farther than `error` from everything that the leaf accepts.
inline Mask Outside(const Leaf& leaf, Lane s, Lane t, Lane error) {
  return (s + error < Set(leaf.s_low)) | (Set(leaf.s_high) < s - error) | (t + error < Set(leaf.t_low)) |
         (Set(leaf.t_high) < t - error);
}

struct Solution {
  Lane s, t, depth;
  unsigned hit = 0, unconverged = 0;
  unsigned started = 0, iterations = 0;
};

template <int P, int Q, bool kWeightVaries>
inline Solution Solve(const Leaf& leaf, Lane x, Lane y, Mask lanes) {
  const int p = leaf.degree_u, q = leaf.degree_v;
  const int n = (p + 1) * (q + 1);
  const double* g1 = leaf.coefficients;
  const double* g2 = g1 + n;
  const double* w = g2 + n;

  // Turn the pixel into the leaf's own measure: b = C·(r − center). Far outside: proven miss (leaf.h, Law 2).
  const Lane dx = x - Set(leaf.center_x), dy = y - Set(leaf.center_y);
  const Lane b1 = Fma(Set(leaf.c12), dy, Set(leaf.c11) * dx);
  const Lane b2 = Fma(Set(leaf.c22), dy, Set(leaf.c21) * dx);
  const Lane limit = Set(leaf.b_limit);
  Mask active = lanes & (Abs(b1) <= limit) & (Abs(b2) <= limit);

  Solution solution{Set(0), Set(0), Set(kInfinity)};
  solution.started = static_cast<unsigned>(__builtin_popcount(ToBits(active)));
  const Lane inverse_gap = Set(leaf.inverse_gap), newton_factor = Set(leaf.newton_factor),
             rounding = Set(leaf.rounding);
  const Lane chord_factor = inverse_gap - Set(1);  // kappa/(1 − kappa)
  const Lane floor = rounding * inverse_gap;
  const Lane tolerance = Set(kSolverTolerance) + floor + floor;
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

    // Bound the distance of the root from here, and from the next iterate (Law 3).
    const Lane a1 = Abs(h1.f), a2 = Abs(h2.f);
    const Lane residual = Select(a1 < a2, a2, a1) + rounding;
    const Lane from_here = residual * inverse_gap;
    const Lane from_next = Fma(newton_factor * from_here, from_here, floor);
    // A chord step x − H contracts by kappa: it decides where an iterate is held at the border and Newton's
    // bound stays large.
    const Lane from_chord = Fma(residual, chord_factor, rounding);

    const Mask miss =
        Outside(leaf, next_s, next_t, from_next) | Outside(leaf, s - h1.f, t - h2.f, from_chord);
    const Mask done = from_next <= tolerance;
    const Mask inside = (Set(leaf.s_low) <= next_s) & (next_s <= Set(leaf.s_high)) &
                        (Set(leaf.t_low) <= next_t) & (next_t <= Set(leaf.t_high));
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

  // Depth: one division, whatever the projection.
  const double* next = w + (kWeightVaries ? n : 0);
  const Lane weight = kWeightVaries ? Value<P, Q>(w, p, q, solution.s, solution.t) : Set(1);
  const Lane depth = (leaf.flags & kLeafDepthVaries) ? Value<P, Q>(next, p, q, solution.s, solution.t)
                                                     : Set(leaf.depth_constant);
  if (leaf.flags & kLeafPerspective) {
    solution.depth = Set(leaf.depth_scale) * weight / depth;
  } else {
    solution.depth = Set(leaf.depth_scale) + depth / weight;
  }
  return solution;
}

template <bool kWeightVaries>
inline Solution SolveByDegree(const Leaf& leaf, Lane x, Lane y, Mask lanes) {
  switch (leaf.degree_u * 8 + leaf.degree_v) {
    case 1 * 8 + 1:
      return Solve<1, 1, kWeightVaries>(leaf, x, y, lanes);
    case 1 * 8 + 2:
      return Solve<1, 2, kWeightVaries>(leaf, x, y, lanes);
    case 2 * 8 + 1:
      return Solve<2, 1, kWeightVaries>(leaf, x, y, lanes);
    case 2 * 8 + 2:
      return Solve<2, 2, kWeightVaries>(leaf, x, y, lanes);
    case 1 * 8 + 3:
      return Solve<1, 3, kWeightVaries>(leaf, x, y, lanes);
    case 3 * 8 + 1:
      return Solve<3, 1, kWeightVaries>(leaf, x, y, lanes);
    case 2 * 8 + 3:
      return Solve<2, 3, kWeightVaries>(leaf, x, y, lanes);
    case 3 * 8 + 2:
      return Solve<3, 2, kWeightVaries>(leaf, x, y, lanes);
    case 3 * 8 + 3:
      return Solve<3, 3, kWeightVaries>(leaf, x, y, lanes);
    default:
      return Solve<-1, -1, kWeightVaries>(leaf, x, y, lanes);
  }
}

// One packet: the samples (i, j), i < kPacketHeight, j < kPacketWidth, from sample (row, column) of the tile.
class Packet {
 public:
  Packet(const TileJob& job, int row, int column) : job_(job), row_(row), column_(column) {
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const int i = row + lane / kPacketWidth, j = column + lane % kPacketWidth;
      x_[lane] = job.column + j + 0.5 - job.half_width;
      y_[lane] = job.row + i + 0.5 - job.half_height;
      depth_[lane] = kInfinity;
      s_[lane] = t_[lane] = 0;
      leaf_[lane] = kMiss;
      doubt_[lane] = 0;
      if (i < job.rows && j < job.columns) valid_ |= 1u << lane;
    }
    farthest_ = valid_ ? kInfinity : -kInfinity;
  }

  void Trace() {
    const int words = job_.words;
    const std::uint64_t* r0 = job_.row_bits + std::size_t(row_) * words;
    const std::uint64_t* s0 = job_.column_bits + std::size_t(column_) * words;
    for (int k = 0; k < words; ++k) {
      std::uint64_t candidates =
          (r0[k] | r0[words + k]) & (s0[k] | s0[words + k] | s0[2 * words + k] | s0[3 * words + k]);
      while (candidates) {
        const std::uint32_t index = job_.list[k * 64 + __builtin_ctzll(candidates)];
        candidates &= candidates - 1;
        const Leaf& leaf = job_.leaves[index];
        if (!job_.every_hit && leaf.near_depth > farthest_) return;
        Meet(leaf, index);
      }
    }
  }

  void Write() const {
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if (!(valid_ >> lane & 1)) continue;
      const int i = SampleOf(lane);
      job_.depth[i] = depth_[lane];
      job_.s[i] = s_[lane];
      job_.t[i] = t_[lane];
      job_.leaf[i] = leaf_[lane];
      job_.doubt[i] = doubt_[lane];
    }
  }

 private:
  int SampleOf(int lane) const {
    return (row_ + lane / kPacketWidth) * job_.tile_size + column_ + lane % kPacketWidth;
  }

  // The lanes whose sample lies in the leaf's box and that it could still serve.
  unsigned LanesIn(const Leaf& leaf) const {
    unsigned mask = 0;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const int row = job_.row + row_ + lane / kPacketWidth,
                column = job_.column + column_ + lane % kPacketWidth;
      const bool in = row >= leaf.row_begin && row < leaf.row_end && column >= leaf.col_begin &&
                      column < leaf.col_end && (job_.every_hit || leaf.near_depth <= depth_[lane]);
      mask |= unsigned(in) << lane;
    }
    return mask & valid_;
  }

  void Meet(const Leaf& leaf, std::uint32_t index) {
    const unsigned lanes = LanesIn(leaf);
    if (lanes == 0) return;
    ++job_.counters->candidates;
    if (leaf.flags & kLeafHard) {
      MeetHard(leaf, index, lanes);
      return;
    }
    for (int first = 0; first < kPacketLanes; first += kLanes) {
      const unsigned group = lanes >> first & ((1u << kLanes) - 1);
      if (group == 0) continue;
      const Lane x = Load(x_ + first), y = Load(y_ + first);
      const Solution solution = (leaf.flags & kLeafWeightVaries)
                                    ? SolveByDegree<true>(leaf, x, y, FromBits(group))
                                    : SolveByDegree<false>(leaf, x, y, FromBits(group));
      job_.counters->solves += solution.started;
      job_.counters->iterations += solution.iterations;
      for (unsigned rest = solution.unconverged; rest; rest &= rest - 1)
        doubt_[first + __builtin_ctz(rest)] |= kDoubtUnresolved;
      if (solution.hit == 0) continue;
      double s[kLanes], t[kLanes], depth[kLanes];
      Store(solution.s, s);
      Store(solution.t, t);
      Store(solution.depth, depth);
      for (unsigned rest = solution.hit; rest; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        Take(leaf, index, first + k, {depth[k], s[k], t[k]});
      }
    }
    UpdateFarthest();
  }

  // A root in a certified leaf: trimming, then the depth test.
  void Take(const Leaf& leaf, std::uint32_t index, int lane, const TileHit& hit) {
    if (!(hit.depth > job_.near_depth) || (!job_.every_hit && !(hit.depth < depth_[lane]))) return;
    std::uint8_t doubt = 0;
    if (leaf.flags & kLeafTrimmed) {
      ++job_.counters->trim_tests;
      const bool keep = job_.keep(job_.context, leaf, hit.s, hit.t, x_[lane], y_[lane], &doubt);
      doubt_[lane] |= doubt;
      if (!keep) return;
    }
    Keep(index, lane, hit, doubt);
  }

  void Keep(std::uint32_t index, int lane, const TileHit& hit, std::uint8_t doubt) {
    if (job_.every_hit) job_.every_hit(job_.context, SampleOf(lane), index, hit, doubt);
    if (!(hit.depth < depth_[lane])) return;
    depth_[lane] = hit.depth;
    s_[lane] = hit.s;
    t_[lane] = hit.t;
    leaf_[lane] = index;
  }

  void MeetHard(const Leaf& leaf, std::uint32_t index, unsigned lanes) {
    struct Sink {
      Packet* packet;
      std::uint32_t index;
      int lane;
    };
    for (unsigned rest = lanes; rest; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      ++job_.counters->fallbacks;
      Sink sink{this, index, lane};
      doubt_[lane] |=
          job_.solve_hard(job_.context, leaf, x_[lane], y_[lane], job_.every_hit ? kInfinity : depth_[lane],
                          &sink, [](void* to, const TileHit& hit, std::uint8_t doubt) {
                            Sink* sink = static_cast<Sink*>(to);
                            sink->packet->Keep(sink->index, sink->lane, hit, doubt);
                          });
    }
    UpdateFarthest();
  }

  void UpdateFarthest() {
    double farthest = -kInfinity;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if ((valid_ >> lane & 1) && depth_[lane] > farthest) farthest = depth_[lane];
    }
    farthest_ = farthest;
  }

  const TileJob& job_;
  int row_, column_;
  unsigned valid_ = 0;
  double farthest_ = kInfinity;
  double x_[kPacketLanes], y_[kPacketLanes], depth_[kPacketLanes], s_[kPacketLanes], t_[kPacketLanes];
  std::uint32_t leaf_[kPacketLanes];
  std::uint8_t doubt_[kPacketLanes];
};

}  // namespace

void TraceTile(const TileJob& job) {
  for (int row = 0; row < job.rows; row += kPacketHeight) {
    for (int column = 0; column < job.columns; column += kPacketWidth) {
      Packet packet(job, row, column);
      packet.Trace();
      packet.Write();
    }
  }
}

#if defined(FACETLESS_SCALAR_KERNEL)
SampleRoot SolveSample(const Leaf& leaf, double x, double y, TileHit* hit) {
  const Mask lane = FromBits(1);
  const Solution solution = (leaf.flags & kLeafWeightVaries)
                                ? SolveByDegree<true>(leaf, Set(x), Set(y), lane)
                                : SolveByDegree<false>(leaf, Set(x), Set(y), lane);
  if (solution.unconverged) return SampleRoot::kUnconverged;
  if (!solution.hit) return SampleRoot::kMiss;
  Store(solution.depth, &hit->depth);
  Store(solution.s, &hit->s);
  Store(solution.t, &hit->t);
  return SampleRoot::kHit;
}
#endif

}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE
