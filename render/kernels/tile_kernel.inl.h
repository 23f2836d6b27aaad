// The body of the tile kernel, included once by each tile_kernel_<isa>.cpp after its target is set. See
// tile_kernel.h.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "render/kernels/lanes.h"
#include "render/kernels/tile_kernel.h"

namespace facetless::FACETLESS_KERNEL_NAMESPACE {

namespace {

constexpr std::uint32_t kNoLeaf = 0xffffffff;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A polynomial's value and first derivatives. P, Q: degrees, or −1 to take them from the leaf.
struct Jet {
  Lane f, ds, dt;
};

template <int P, int Q>
inline Jet Evaluate(const Real* c, int p, int q, Lane s, Lane t) {
  const int degree_u = P >= 0 ? P : p, degree_v = Q >= 0 ? Q : q;
  // Horner along v of row i, with its derivative; the highest power costs nothing.
  const auto row_at = [&](int i) {
    const Real* row = c + i * (degree_v + 1);
    struct {
      Lane value, slope;
    } at{Fma(Set(row[degree_v]), t, Set(row[degree_v - 1])), Set(row[degree_v])};
    for (int j = degree_v - 2; j >= 0; --j) {
      at.slope = Fma(at.slope, t, at.value);
      at.value = Fma(at.value, t, Set(row[j]));
    }
    return at;
  };
  // Then along u.
  const auto last = row_at(degree_u), before = row_at(degree_u - 1);
  Jet jet{Fma(last.value, s, before.value), last.value, Fma(last.slope, s, before.slope)};
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

// The depths of kLanes relative ones.
inline void Depths(const Leaf& leaf, Lane relative, double* depth) {
  const Wide scale = SetWide(leaf.depth_scale),
             factor = SetWide((leaf.flags & kLeafPerspective) ? leaf.depth_scale : 1);
  StoreWide(relative, depth);
  for (int i = 0; i < kLanes; i += kWideLanes) Store(scale + factor * Load(depth + i), depth + i);
}

// Below this sine of the angle between the tangents, or ratio of their lengths, most digits of a normal are rounding.
#if defined(FACETLESS_FLOAT_KERNEL)
constexpr double kSingular = 0x1p-6;
#else
constexpr double kSingular = 0x1p-26;
#endif

struct Normal {
  Lane x, y, z;    // unit, along ds × dt, model axes
  unsigned known;  // lanes in which it is
};

// The cross product of the derivatives by s and t of the leaf's points at roots (s, t). Once per hit: degrees as
// constants would gain a hundredth of a trace, and double the time to build.
inline Normal NormalAt(const Leaf& leaf, const double* x, const double* y, Lane s, Lane t,
                       const ViewAxes& axes) {
  const int p = leaf.degree_u, q = leaf.degree_v;
  const int n = (p + 1) * (q + 1);
  const Real* g = Coefficients(leaf);
  const Jet h1 = Evaluate<-1, -1>(g, p, q, s, t), h2 = Evaluate<-1, -1>(g + n, p, q, s, t);
  const Real* next = g + 2 * n;
  Jet w{Set(1), Set(0), Set(0)};
  Lane h1s = h1.ds, h1t = h1.dt, h2s = h2.ds, h2t = h2.dt;
  if (leaf.flags & kLeafWeightVaries) {
    w = Evaluate<-1, -1>(next, p, q, s, t);
    next += n;
    const Lane b1 = Local(x, leaf.center_x, leaf.c11, y, leaf.center_y, leaf.c12);
    const Lane b2 = Local(x, leaf.center_x, leaf.c21, y, leaf.center_y, leaf.c22);
    h1s = Fnma(b1, w.ds, h1s), h1t = Fnma(b1, w.dt, h1t);
    h2s = Fnma(b2, w.ds, h2s), h2t = Fnma(b2, w.dt, h2t);
  }
  // Undo C, to pixels and then to mm; and the depth with them. One factor for all keeps squares of squares in the
  // range of a float, however small the leaf.
  const double determinant = leaf.c11 * leaf.c22 - leaf.c12 * leaf.c21;
  const double to_x = axes.pixel_x / determinant, to_y = axes.pixel_y / determinant;
  const double along_x = std::max(std::fabs(to_x * leaf.c22), std::fabs(to_x * leaf.c12)),
               along_y = std::max(std::fabs(to_y * leaf.c21), std::fabs(to_y * leaf.c11));
  const double factor = 1 / std::max(along_x, along_y);
  const Lane a11 = Set(factor * to_x * leaf.c22), a12 = Set(-factor * to_x * leaf.c12),
             a21 = Set(-factor * to_y * leaf.c21), a22 = Set(factor * to_y * leaf.c11);
  Lane xs = Fma(a11, h1s, a12 * h2s), xt = Fma(a11, h1t, a12 * h2t);
  Lane ys = Fma(a21, h1s, a22 * h2s), yt = Fma(a21, h1t, a22 * h2t);
  Lane zs = Set(0), zt = Set(0);
  const bool perspective = (leaf.flags & kLeafPerspective) != 0;
  if (leaf.flags & kLeafDepthVaries) {
    const Jet d = Evaluate<-1, -1>(next, p, q, s, t);
    if (perspective) {
      const Lane depth = w.f / d.f;
      zs = Fnma(depth, d.ds, w.ds), zt = Fnma(depth, d.dt, w.dt);
    } else {
      const Lane depth = d.f / w.f;
      zs = Fnma(depth, w.ds, d.ds), zt = Fnma(depth, w.dt, d.dt);
    }
  } else if (perspective) {
    zs = w.ds, zt = w.dt;
  }
  zs = Set(factor) * zs, zt = Set(factor) * zt;
  if (perspective) {
    const Lane tan_x = Local(x, 0, axes.pixel_x, y, 0, 0), tan_y = Local(x, 0, 0, y, 0, axes.pixel_y);
    xs = Fma(tan_x, zs, xs), xt = Fma(tan_x, zt, xt);
    ys = Fma(tan_y, zs, ys), yt = Fma(tan_y, zt, yt);
  }
  const Lane nx = Fma(ys, zt, Set(0) - zs * yt), ny = Fma(zs, xt, Set(0) - xs * zt),
             nz = Fma(xs, yt, Set(0) - ys * xt);
  const Lane square = Fma(nx, nx, Fma(ny, ny, nz * nz)), square_s = Fma(xs, xs, Fma(ys, ys, zs * zs)),
             square_t = Fma(xt, xt, Fma(yt, yt, zt * zt));
  const Lane longest = Select(square_s < square_t, square_t, square_s);
  const Lane inverse = Set(1) / Sqrt(square);
  const auto along = [&](double right, double down, double forward) {
    return inverse * Fma(Set(right), nx, Fma(Set(down), ny, Set(forward) * nz));
  };
  return {along(axes.right.x, axes.down.x, axes.forward.x), along(axes.right.y, axes.down.y, axes.forward.y),
          along(axes.right.z, axes.down.z, axes.forward.z),
          ToBits(Set(kSingular * kSingular) * (longest * longest) < square)};
}

inline Solution SolveLeaf(const Leaf& leaf, const double* x, const double* y, unsigned lanes) {
  return ByDegrees(leaf.degree_u, leaf.degree_v, [&]<int P, int Q>() {
    return (leaf.flags & kLeafWeightVaries) ? Solve<P, Q, true>(leaf, x, y, FromBits(lanes))
                                            : Solve<P, Q, false>(leaf, x, y, FromBits(lanes));
  });
}

// One packet at a time: the samples (i, j), i < kPacketHeight, j < kPacketWidth, from sample (row, column) of the
// tile on.
class Packet {
 public:
  explicit Packet(const TileJob& job)
      : job_(job), nearest_only_(!job.every_hit), plain_(!job.every_hit && !job.coincidences) {}

  // Traces the packet and writes its results; those of a packet that no leaf meets stay as they are.
  void Run(int row, int column) {
    row_ = row;
    column_ = column;
    begun_ = false;
    Trace();
    if (begun_) Write();
  }

 private:
  static constexpr double kMiss = -1;

  void Begin() {
    begun_ = true;
    doubtful_ = several_ = false;
    hit_ = 0;
    farthest_ = kInfinity;
    const double x = job_.column + column_ + 0.5 - job_.half_width,
                 y = job_.row + row_ + 0.5 - job_.half_height;
    for (int i = 0; i < kPacketHeight; ++i) {
      for (int j = 0; j < kPacketWidth; ++j) {
        x_[i * kPacketWidth + j] = x + j;
        y_[i * kPacketWidth + j] = y + i;
      }
    }
    for (int i = 0; i < kPacketLanes; i += kWideLanes) {
      Store(SetWide(kInfinity), depth_ + i);
      Store(SetWide(kInfinity), reach_ + i);
      Store(SetWide(kInfinity), doubt_depth_ + i);
      Store(SetWide(0), s_ + i);
      Store(SetWide(0), t_ + i);
      Store(SetWide(0), error_ + i);
      Store(SetWide(kMiss), leaf_ + i);
    }
    std::fill_n(doubt_, kPacketLanes, std::uint8_t{0});
    valid_ = (1u << kPacketLanes) - 1;
    if (row_ + kPacketHeight <= job_.rows && column_ + kPacketWidth <= job_.columns) return;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if (row_ + lane / kPacketWidth < job_.rows && column_ + lane % kPacketWidth < job_.columns) continue;
      valid_ &= ~(1u << lane);
      reach_[lane] = -kInfinity;
    }
  }

  void Trace() {
    const int words = job_.words;
    const std::uint64_t* rows = job_.row_bits + std::size_t(row_) * words;
    const std::uint64_t* columns = job_.column_bits + std::size_t(column_) * words;
    for (int k = 0; k < words; ++k) {
      std::uint64_t in_rows = 0, in_columns = 0;
      for (int i = 0; i < kPacketHeight; ++i) in_rows |= rows[i * words + k];
      for (int j = 0; j < kPacketWidth; ++j) in_columns |= columns[j * words + k];
      for (std::uint64_t candidates = in_rows & in_columns; candidates; candidates &= candidates - 1) {
        const std::uint32_t index = job_.list[k * 64 + __builtin_ctzll(candidates)];
        const Leaf& leaf = job_.leaves[index];
        if (!begun_) Begin();
        if (nearest_only_ && leaf.near_depth > farthest_) return;
        Meet(leaf, index);
      }
    }
  }

  void Write() const {
    for (int i = 0; i < kPacketHeight; ++i) {
      const int from = i * kPacketWidth, to = SampleOf(from);
      for (int j = 0; j < kPacketWidth; ++j) {
        job_.depth[to + j] = depth_[from + j];
        job_.error[to + j] = error_[from + j];
        job_.s[to + j] = s_[from + j];
        job_.t[to + j] = t_[from + j];
        job_.leaf[to + j] = leaf_[from + j] == kMiss ? kNoLeaf : static_cast<std::uint32_t>(leaf_[from + j]);
      }
      for (int j = 0; several_ && j < kPacketWidth; ++j)
        job_.error[to + j] = std::fmax(error_[from + j], depth_[from + j] - least_[from + j]);
      for (int j = 0; doubtful_ && j < kPacketWidth; ++j)
        if (!nearest_only_ || doubt_depth_[from + j] <= Reach(from + j))
          job_.doubt[to + j] = doubt_[from + j];
    }
    if (job_.normal) WriteNormals();
  }

  int SampleOf(int lane) const {
    return (row_ + lane / kPacketWidth) * job_.tile_size + column_ + lane % kPacketWidth;
  }

  // Nothing beyond this depth matters to a lane.
  double Reach(int lane) const { return depth_[lane] + error_[lane]; }

  void AddDoubt(int lane, std::uint8_t doubt, double depth) {
    if (doubt == 0) return;
    doubtful_ = true;
    doubt_[lane] |= doubt;
    if (depth < doubt_depth_[lane]) doubt_depth_[lane] = depth;
  }

  // Bits [begin, end) of those from `first` on, `count` of them.
  static unsigned Covered(int begin, int end, int first, int count) {
    const int from = begin > first ? begin - first : 0;
    const int to = end - first < count ? end - first : count;
    return from < to ? (1u << to) - (1u << from) : 0;
  }

  // The lanes whose sample lies in the leaf's box and that it could still serve.
  unsigned LanesIn(const Leaf& leaf) const {
    const unsigned rows = Covered(leaf.row_begin, leaf.row_end, job_.row + row_, kPacketHeight);
    const unsigned columns = Covered(leaf.col_begin, leaf.col_end, job_.column + column_, kPacketWidth);
    unsigned mask = 0;
    for (int i = 0; i < kPacketHeight; ++i) mask |= (rows >> i & 1 ? columns : 0) << i * kPacketWidth;
    mask &= valid_;
    if (!nearest_only_ || mask == 0) return mask;
    unsigned reached = 0;
    for (int i = 0; i < kPacketLanes; i += kWideLanes)
      reached |= LessOrEqual(SetWide(leaf.near_depth), Load(reach_ + i)) << i;
    return mask & reached;
  }

  void Meet(const Leaf& leaf, std::uint32_t index) {
    const unsigned lanes = LanesIn(leaf);
    if (lanes == 0) return;
    ++job_.counters->candidates;
    if (leaf.flags & kLeafHard) {
      MeetHard(leaf, index, lanes);
      return;
    }
    bool nearer = false;
    for (int first = 0; first < kPacketLanes; first += kLanes) {
      const unsigned group = lanes >> first & ((1u << kLanes) - 1);
      if (group == 0) continue;
      const Solution solution = SolveLeaf(leaf, x_ + first, y_ + first, group);
      job_.counters->solves += solution.started;
      job_.counters->iterations += solution.iterations;
      for (unsigned rest = solution.unconverged; rest; rest &= rest - 1)
        AddDoubt(first + __builtin_ctz(rest), kDoubtUnresolved, leaf.near_depth);
      if (solution.hit == 0) continue;
      double s[kLanes], t[kLanes], depth[kLanes];
      StoreWide(solution.s, s);
      StoreWide(solution.t, t);
      Depths(leaf, solution.depth, depth);
      unsigned one_by_one = solution.hit;
      if (plain_ && !(leaf.flags & kLeafTrimmed)) {
        one_by_one = (leaf.flags & kLeafAtBorder) ? solution.hit & NearBorder(leaf, solution) : 0;
        nearer |= KeepNearer(leaf, index, first, solution.hit & ~one_by_one, s, t, depth);
      }
      for (unsigned rest = one_by_one; rest; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        nearer |= Take(leaf, index, first + k, {depth[k], s[k], t[k], leaf.depth_error});
      }
    }
    if (nearer) UpdateFarthest();
  }

  // Lanes that OnPatchBorder might hold of.
  static unsigned NearBorder(const Leaf& leaf, const Solution& solution) {
    const Lane inside = Set(1 - 2 * leaf.root_error);
    return ToBits((inside < Abs(solution.s)) | (inside < Abs(solution.t)));
  }

  // Hits that nothing else is to be asked of, kLanes from lane `first` on. Whether one is the nearest so far.
  bool KeepNearer(const Leaf& leaf, std::uint32_t index, int first, unsigned hits, const double* s,
                  const double* t, const double* depth) {
    unsigned kept = 0;
    for (int i = 0; i < kLanes; i += kWideLanes) {
      const int lane = first + i;
      const Wide found = Load(depth + i);
      const unsigned beyond = hits >> i & Less(SetWide(job_.near_depth), found),
                     nearer = beyond & Less(found, Load(depth_ + lane));
      kept |= nearer;
      if (unsigned again = beyond & hit_ >> lane) {
        again &= Less(found + SetWide(-leaf.depth_error), Load(reach_ + lane));
        for (; again; again &= again - 1) {
          const int k = __builtin_ctz(again);
          NoteLeast(lane + k, depth[i + k], leaf.depth_error);
        }
      }
      hit_ |= nearer << lane;
      Store(Select(nearer, found, Load(depth_ + lane)), depth_ + lane);
      Store(Select(nearer, found + SetWide(leaf.depth_error), Load(reach_ + lane)), reach_ + lane);
      Store(Select(nearer, SetWide(leaf.depth_error), Load(error_ + lane)), error_ + lane);
      Store(Select(nearer, Load(s + i), Load(s_ + lane)), s_ + lane);
      Store(Select(nearer, Load(t + i), Load(t_ + lane)), t_ + lane);
      Store(Select(nearer, SetWide(index), Load(leaf_ + lane)), leaf_ + lane);
    }
    return kept != 0;
  }

  // Whether a hit may be the nearest, or coincide with it.
  bool Matters(int lane, const TileHit& hit) const {
    return job_.coincidences ? hit.depth - hit.error <= Reach(lane) : hit.depth < depth_[lane];
  }

  // A root in a certified leaf: trimming, then the depth test. Whether it is the nearest so far.
  bool Take(const Leaf& leaf, std::uint32_t index, int lane, TileHit hit) {
    if (!(hit.depth > job_.near_depth)) return false;
    if (nearest_only_ && !Matters(lane, hit)) {
      NoteLeast(lane, hit.depth, hit.error);  // whatever the trimming would say
      return false;
    }
    std::uint8_t doubt = 0;
    if (OnPatchBorder(leaf, hit.s, hit.t) &&
        !job_.keep_on_border(job_.context, leaf, x_[lane], y_[lane], &hit, &doubt))
      return false;
    bool keep = true;
    if (leaf.flags & kLeafTrimmed) {
      ++job_.counters->trim_tests;
      keep = job_.keep(job_.context, leaf, hit.s, hit.t, x_[lane], y_[lane], &doubt);
    }
    AddDoubt(lane, doubt, hit.depth - hit.error);
    return keep && Keep(index, lane, hit, doubt);
  }

  bool Keep(std::uint32_t index, int lane, const TileHit& hit, std::uint8_t doubt) {
    if (job_.every_hit) job_.every_hit(job_.context, SampleOf(lane), index, hit, doubt);
    if (job_.coincidences && leaf_[lane] != kMiss && hit.depth - hit.error <= Reach(lane) &&
        depth_[lane] - error_[lane] <= hit.depth + hit.error &&
        job_.leaves[static_cast<std::uint32_t>(leaf_[lane])].placed_face != job_.leaves[index].placed_face)
      AddDoubt(lane, kDoubtCoincident, std::fmin(hit.depth - hit.error, depth_[lane] - error_[lane]));
    if (hit_ >> lane & 1) NoteLeast(lane, hit.depth, hit.error);
    if (!(hit.depth < depth_[lane])) return false;
    hit_ |= 1u << lane;
    depth_[lane] = hit.depth;
    error_[lane] = hit.error;
    reach_[lane] = Reach(lane);
    s_[lane] = hit.s;
    t_[lane] = hit.t;
    leaf_[lane] = index;
    return true;
  }

  // Of a lane's second hit, and those after it: which of them is the nearest may be another than the depths say, by as
  // much as their errors. (Those without a bound have a doubt.)
  void NoteLeast(int lane, double depth, double error) {
    if (!(depth - error < Reach(lane))) return;
    if (!several_) std::fill_n(least_, kPacketLanes, kInfinity);
    several_ = true;
    if (error_[lane] < kInfinity) least_[lane] = std::fmin(least_[lane], depth_[lane] - error_[lane]);
    if (error < kInfinity) least_[lane] = std::fmin(least_[lane], depth - error);
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
          job_.solve_hard(job_.context, leaf, x_[lane], y_[lane], nearest_only_ ? Reach(lane) : kInfinity,
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
    Wide farthest = Load(reach_);
    for (int i = kWideLanes; i < kPacketLanes; i += kWideLanes)
      farthest = Greater(farthest, Load(reach_ + i));
    farthest_ = Greatest(farthest);
  }

  void WriteNormals() const {
    unsigned rest = 0;
    for (int i = 0; i < kPacketLanes; i += kWideLanes) rest |= Less(SetWide(kMiss), Load(leaf_ + i)) << i;
    while (rest) {
      // All lanes of one leaf at a time.
      const Wide one = SetWide(leaf_[__builtin_ctz(rest)]);
      unsigned lanes = 0;
      for (int i = 0; i < kPacketLanes; i += kWideLanes)
        lanes |= (LessOrEqual(one, Load(leaf_ + i)) & LessOrEqual(Load(leaf_ + i), one)) << i;
      const Leaf& leaf = job_.leaves[static_cast<std::uint32_t>(leaf_[__builtin_ctz(rest)])];
      rest &= ~lanes;
      for (int first = 0; first < kPacketLanes; first += kLanes) {
        const unsigned group = lanes >> first & ((1u << kLanes) - 1);
        if (group != 0) WriteNormals(leaf, first, group);
      }
    }
  }

  // Of the lanes `group` from `first` on; zero where there is none.
  void WriteNormals(const Leaf& leaf, int first, unsigned group) const {
    Real x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {};
    unsigned known = 0;
    if (!(leaf.flags & kLeafHard)) {
      const Lane s = LoadNarrow(s_ + first), t = LoadNarrow(t_ + first);
      const Normal normal = NormalAt(leaf, x_ + first, y_ + first, s, t, job_.axes);
      Store(normal.x, x);
      Store(normal.y, y);
      Store(normal.z, z);
      known = normal.known;
    }
    for (; group; group &= group - 1) {
      const int k = __builtin_ctz(group);
      std::array<float, 3>& out = job_.normal[SampleOf(first + k)];
      if (known >> k & 1) {
        out = {static_cast<float>(x[k]), static_cast<float>(y[k]), static_cast<float>(z[k])};
      } else {
        out = {0, 0, 0};
      }
    }
  }

  const TileJob& job_;
  const bool nearest_only_, plain_;
  int row_ = 0, column_ = 0;
  unsigned valid_ = 0, hit_ = 0;  // lanes inside the image, and those with a hit
  bool begun_ = false, doubtful_ = false, several_ = false;
  double farthest_ = kInfinity;
  alignas(64) double x_[kPacketLanes], y_[kPacketLanes], depth_[kPacketLanes], s_[kPacketLanes],
      t_[kPacketLanes];
  double error_[kPacketLanes];        // of the depth, as a root of its leaf
  double least_[kPacketLanes];        // with several_: of a lane's hits none can be nearer
  double reach_[kPacketLanes];        // Reach(); −inf outside the image
  double leaf_[kPacketLanes];         // its index, or kMiss
  double doubt_depth_[kPacketLanes];  // no doubt arose nearer
  std::uint8_t doubt_[kPacketLanes];
};

}  // namespace

void TraceTile(const TileJob& job) {
  const std::size_t count = std::size_t(job.tile_size) * job.tile_size;
  std::fill_n(job.depth, count, kInfinity);
  std::fill_n(job.leaf, count, kNoLeaf);
  std::fill_n(job.doubt, count, std::uint8_t{0});
  if (job.words == 0) return;
  Packet packet(job);
  for (int row = 0; row < job.rows; row += kPacketHeight)
    for (int column = 0; column < job.columns; column += kPacketWidth) packet.Run(row, column);
}

#if defined(FACETLESS_SCALAR_KERNEL)
SampleRoot SolveSample(const Leaf& leaf, double x, double y, TileHit* hit) {
  const Solution solution = SolveLeaf(leaf, &x, &y, 1);
  if (solution.unconverged) return SampleRoot::kUnconverged;
  if (!solution.hit) return SampleRoot::kMiss;
  double depth;
  Depths(leaf, solution.depth, &depth);
  *hit = {depth, solution.s.raw, solution.t.raw, leaf.depth_error};
  return SampleRoot::kHit;
}
#endif

}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE
