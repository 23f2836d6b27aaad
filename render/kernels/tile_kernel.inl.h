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
inline Jet Evaluate(const Real* c, int p, int q, Lane s, Lane t) {
  const int degree_u = P >= 0 ? P : p, degree_v = Q >= 0 ? Q : q;
  Jet jet{Set(0), Set(0), Set(0)};
  for (int i = degree_u; i >= 0; --i) {
    // Horner along v of row i, with its derivative, …
    const Real* row = c + i * (degree_v + 1);
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

inline const Real* Coefficients(const Leaf& leaf) {
#if defined(FACETLESS_FLOAT_KERNEL)
  return leaf.coefficients32;
#else
  return leaf.coefficients;
#endif
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
  Lane s, t, depth;  // depth: relative to the leaf's depth_scale, see DepthOf
  unsigned hit = 0, unconverged = 0;
  unsigned started = 0, iterations = 0;
};

template <int P, int Q, bool kWeightVaries>
inline Solution Solve(const Leaf& leaf, const double* x, const double* y, Mask lanes) {
  const int p = leaf.degree_u, q = leaf.degree_v;
  const int n = (p + 1) * (q + 1);
  const Real* g1 = Coefficients(leaf);
  const Real* g2 = g1 + n;
  const Real* w = g2 + n;

  // Turn the pixel into the leaf's own measure: b = C·(r − center). Far outside: proven miss (leaf.h, Law 2).
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
  const Lane tolerance = Set(leaf.root_error);
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
    // The root exists where its ball lies in the enlarged leaf.
    const Mask exists = (Abs(s) + from_here <= enlarged) & (Abs(t) + from_here <= enlarged);
    const Mask done = (from_next <= tolerance) & exists;
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

  // Depth: Q/W, or W/Q − 1 = (w − q)/(1 + q) of the parts that vary.
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

inline double DepthOf(const Leaf& leaf, Real relative) {
  const double depth = relative;
  return leaf.depth_scale + ((leaf.flags & kLeafPerspective) ? leaf.depth_scale * depth : depth);
}

template <bool kWeightVaries>
inline Solution SolveByDegree(const Leaf& leaf, const double* x, const double* y, Mask lanes) {
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
      depth_[lane] = doubt_depth_[lane] = kInfinity;
      s_[lane] = t_[lane] = error_[lane] = 0;
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
      job_.error[i] = error_[lane];
      job_.s[i] = s_[lane];
      job_.t[i] = t_[lane];
      job_.leaf[i] = leaf_[lane];
      job_.doubt[i] = doubt_depth_[lane] <= Reach(lane) ? doubt_[lane] : 0;
    }
  }

 private:
  int SampleOf(int lane) const {
    return (row_ + lane / kPacketWidth) * job_.tile_size + column_ + lane % kPacketWidth;
  }

  // Nothing beyond this depth matters to a lane.
  double Reach(int lane) const { return depth_[lane] + error_[lane]; }

  void AddDoubt(int lane, std::uint8_t doubt, double depth) {
    if (doubt == 0) return;
    doubt_[lane] |= doubt;
    if (depth < doubt_depth_[lane]) doubt_depth_[lane] = depth;
  }

  // The lanes whose sample lies in the leaf's box and that it could still serve.
  unsigned LanesIn(const Leaf& leaf) const {
    unsigned mask = 0;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const int row = job_.row + row_ + lane / kPacketWidth,
                column = job_.column + column_ + lane % kPacketWidth;
      const bool in = row >= leaf.row_begin && row < leaf.row_end && column >= leaf.col_begin &&
                      column < leaf.col_end && (job_.every_hit || leaf.near_depth <= Reach(lane));
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
      const double* x = x_ + first;
      const double* y = y_ + first;
      const Solution solution = (leaf.flags & kLeafWeightVaries)
                                    ? SolveByDegree<true>(leaf, x, y, FromBits(group))
                                    : SolveByDegree<false>(leaf, x, y, FromBits(group));
      job_.counters->solves += solution.started;
      job_.counters->iterations += solution.iterations;
      for (unsigned rest = solution.unconverged; rest; rest &= rest - 1)
        AddDoubt(first + __builtin_ctz(rest), kDoubtUnresolved, leaf.near_depth);
      if (solution.hit == 0) continue;
      Real s[kLanes], t[kLanes], depth[kLanes];
      Store(solution.s, s);
      Store(solution.t, t);
      Store(solution.depth, depth);
      for (unsigned rest = solution.hit; rest; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        Take(leaf, index, first + k, {DepthOf(leaf, depth[k]), s[k], t[k], leaf.depth_error});
      }
    }
    UpdateFarthest();
  }

  // Whether a hit may be the nearest, or coincide with it.
  bool Matters(int lane, const TileHit& hit) const {
    return job_.coincidences ? hit.depth - hit.error <= Reach(lane) : hit.depth < depth_[lane];
  }

  // A root in a certified leaf: trimming, then the depth test.
  void Take(const Leaf& leaf, std::uint32_t index, int lane, TileHit hit) {
    if (!(hit.depth > job_.near_depth) || (!job_.every_hit && !Matters(lane, hit))) return;
    std::uint8_t doubt = 0;
    if (OnPatchBorder(leaf, hit.s, hit.t) &&
        !job_.keep_on_border(job_.context, leaf, x_[lane], y_[lane], &hit, &doubt))
      return;
    bool keep = true;
    if (leaf.flags & kLeafTrimmed) {
      ++job_.counters->trim_tests;
      keep = job_.keep(job_.context, leaf, hit.s, hit.t, x_[lane], y_[lane], &doubt);
    }
    AddDoubt(lane, doubt, hit.depth - hit.error);
    if (!keep) return;
    Keep(index, lane, hit, doubt);
  }

  void Keep(std::uint32_t index, int lane, const TileHit& hit, std::uint8_t doubt) {
    if (job_.every_hit) job_.every_hit(job_.context, SampleOf(lane), index, hit, doubt);
    if (job_.coincidences && leaf_[lane] != kMiss && hit.depth - hit.error <= Reach(lane) &&
        depth_[lane] - error_[lane] <= hit.depth + hit.error &&
        job_.leaves[leaf_[lane]].placed_face != job_.leaves[index].placed_face)
      AddDoubt(lane, kDoubtCoincident, std::fmin(hit.depth - hit.error, depth_[lane] - error_[lane]));
    if (!(hit.depth < depth_[lane])) return;
    depth_[lane] = hit.depth;
    error_[lane] = hit.error;
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
      const std::uint8_t doubt =
          job_.solve_hard(job_.context, leaf, x_[lane], y_[lane], job_.every_hit ? kInfinity : Reach(lane),
                          &sink, [](void* to, const TileHit& hit, std::uint8_t root_doubt, bool kept) {
                            Sink* found = static_cast<Sink*>(to);
                            found->packet->AddDoubt(found->lane, root_doubt, hit.depth - hit.error);
                            if (kept) found->packet->Keep(found->index, found->lane, hit, root_doubt);
                          });
      AddDoubt(lane, doubt, leaf.near_depth);
    }
    UpdateFarthest();
  }

  void UpdateFarthest() {
    double farthest = -kInfinity;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if ((valid_ >> lane & 1) && Reach(lane) > farthest) farthest = Reach(lane);
    }
    farthest_ = farthest;
  }

  const TileJob& job_;
  int row_, column_;
  unsigned valid_ = 0;
  double farthest_ = kInfinity;
  double x_[kPacketLanes], y_[kPacketLanes], depth_[kPacketLanes], s_[kPacketLanes], t_[kPacketLanes];
  double error_[kPacketLanes];        // of the depth
  double doubt_depth_[kPacketLanes];  // no doubt arose nearer
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
  const Solution solution = (leaf.flags & kLeafWeightVaries) ? SolveByDegree<true>(leaf, &x, &y, lane)
                                                             : SolveByDegree<false>(leaf, &x, &y, lane);
  if (solution.unconverged) return SampleRoot::kUnconverged;
  if (!solution.hit) return SampleRoot::kMiss;
  *hit = {DepthOf(leaf, solution.depth.raw), solution.s.raw, solution.t.raw, leaf.depth_error};
  return SampleRoot::kHit;
}
#endif

}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE
