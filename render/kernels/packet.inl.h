// Traces one packet of samples through the leaves of a tile, from front to back. Each tile_kernel_<isa>.cpp
// includes this file once, through tile_kernel.inl.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "render/kernels/leaf_normal.inl.h"
#include "render/kernels/leaf_solver.inl.h"

namespace facetless::FACETLESS_KERNEL_NAMESPACE {
namespace {

constexpr std::uint32_t kNoLeaf = 0xffffffff;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Traces one packet at a time: the kPacketHeight × kPacketWidth samples that start at sample (row, column) of
// the tile.
class Packet {
 public:
  explicit Packet(const TileJob& job)
      : job_(job), nearest_only_(!job.every_hit), plain_(!job.every_hit && !job.coincidences) {}

  // Traces the packet and writes its results. If no leaf meets the packet, the results are left unchanged.
  void Run(int row, int column) {
    row_ = row;
    column_ = column;
    begun_ = false;
    active_ = job_.active != nullptr ? ActiveLanes() : kAllLanes;
    if (active_ == 0) return;
    Trace();
    if (begun_) Write();
  }

 private:
  static constexpr double kMiss = -1;
  static constexpr unsigned kAllLanes = (1u << kPacketLanes) - 1;

  // The lanes whose samples are traced, of those that TileJob::active names.
  unsigned ActiveLanes() const {
    unsigned lanes = 0;
    for (int i = 0; i < kPacketHeight; ++i) {
      const unsigned row = job_.active[row_ + i] >> column_;
      lanes |= (row & ((1u << kPacketWidth) - 1)) << (i * kPacketWidth);
    }
    return lanes;
  }

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
    valid_ = kAllLanes;
    if (row_ + kPacketHeight <= job_.rows && column_ + kPacketWidth <= job_.columns && active_ == kAllLanes)
      return;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if (row_ + lane / kPacketWidth < job_.rows && column_ + lane % kPacketWidth < job_.columns &&
          (active_ >> lane & 1))
        continue;
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
        const TileLeaf& leaf = job_.list[k * 64 + __builtin_ctzll(candidates)];
        if (!begun_) Begin();
        if (nearest_only_ && leaf.near_depth > farthest_) return;
        const unsigned lanes = LanesIn(leaf);
        if (lanes != 0) TestLeaf(leaf.leaf, lanes);
      }
    }
  }

  void Write() const {
    std::uint32_t names[kPacketLanes];
    static_assert(static_cast<std::uint32_t>(static_cast<std::int64_t>(kMiss)) == kNoLeaf);
    for (int i = 0; i < kPacketLanes; i += kWideLanes) StoreInteger(Load(leaf_ + i), names + i);
    for (int from = 0; from < kPacketLanes; from += kPacketWidth) {
      const int to = LaneSample(from);
      CopyRow(depth_ + from, job_.depth + to);
      CopyRow(error_ + from, job_.error + to);
      CopyRow(s_ + from, job_.s + to);
      CopyRow(t_ + from, job_.t + to);
      CopyRow(names + from, job_.leaf + to);
      for (int j = 0; several_ && j < kPacketWidth; ++j)
        job_.error[to + j] = std::fmax(error_[from + j], depth_[from + j] - least_[from + j]);
      for (int j = 0; doubtful_ && j < kPacketWidth; ++j)
        if (!nearest_only_ || doubt_depth_[from + j] <= Reach(from + j))
          job_.doubt[to + j] = doubt_[from + j];
    }
    if (job_.normal) WriteNormals();
  }

  // Copies what the lanes of a row of the packet have.
  template <typename T>
  static void CopyRow(const T* from, T* to) {
    std::memcpy(to, from, kPacketWidth * sizeof(T));
  }

  int LaneSample(int lane) const {
    return (row_ + lane / kPacketWidth) * kTileSize + column_ + lane % kPacketWidth;
  }

  // The depth beyond which hits do not affect the lane.
  double Reach(int lane) const { return depth_[lane] + error_[lane]; }

  void AddDoubt(int lane, std::uint8_t doubt, double depth) {
    if (doubt == 0) return;
    doubtful_ = true;
    doubt_[lane] |= doubt;
    if (depth < doubt_depth_[lane]) doubt_depth_[lane] = depth;
  }

  // Returns the bits of the positions [begin, end), among the `count` positions from `first` on.
  static unsigned Covered(int begin, int end, int first, int count) {
    const int from = begin > first ? begin - first : 0;
    const int to = end - first < count ? end - first : count;
    return from < to ? (1u << to) - (1u << from) : 0;
  }

  // The lanes whose sample lies in the box of the leaf and for which the leaf may still contain a relevant
  // hit.
  unsigned LanesIn(const TileLeaf& leaf) const {
    const unsigned rows = Covered(leaf.first_row, leaf.last_row + 1, row_, kPacketHeight);
    const unsigned columns = Covered(leaf.first_column, leaf.last_column + 1, column_, kPacketWidth);
    unsigned mask = 0;
    for (int i = 0; i < kPacketHeight; ++i) mask |= (rows >> i & 1 ? columns : 0) << i * kPacketWidth;
    mask &= valid_;
    if (!nearest_only_ || mask == 0) return mask;
    unsigned reached = 0;
    for (int i = 0; i < kPacketLanes; i += kWideLanes)
      reached |= LessOrEqual(SetWide(leaf.near_depth), Load(reach_ + i)) << i;
    return mask & reached;
  }

  // Tests a leaf in the lanes that LanesIn names.
  void TestLeaf(std::uint32_t index, unsigned lanes) {
    ++job_.counters->candidates;
    if (KindOf(index) != LeafKind::kCertified) {
      TestUncertified(job_.leaves.Header(index), index, lanes);
      return;
    }
    const CertifiedLeaf& leaf = job_.leaves.certified[index];
    const double root_error = leaf.RootError(job_.arithmetic);
    bool nearer = false;
    for (int first = 0; first < kPacketLanes; first += kLanes) {
      const unsigned group = lanes >> first & ((1u << kLanes) - 1);
      if (group == 0) continue;
      const Solution solution = SolveLeaf(leaf, root_error, x_ + first, y_ + first, group);
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
        one_by_one = leaf.borders != 0 ? solution.hit & NearBorder(root_error, solution) : 0;
        nearer |= AcceptPlainHits(leaf, index, first, solution.hit & ~one_by_one, s, t, depth);
      }
      for (unsigned rest = one_by_one; rest; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        nearer |= AcceptRoot(leaf, root_error, index, first + k, {depth[k], s[k], t[k], leaf.depth_error});
      }
    }
    if (nearer) UpdateFarthest();
  }

  // The lanes for which OnPatchBorder may return true.
  static unsigned NearBorder(double root_error, const Solution& solution) {
    const Lane inside = Set(1 - 2 * root_error);
    return ToBits((inside < Abs(solution.s)) | (inside < Abs(solution.t)));
  }

  // Accepts hits that need no further test, for kLanes lanes from lane `first` on. Returns whether one of
  // them is the nearest so far.
  bool AcceptPlainHits(const CertifiedLeaf& leaf, std::uint32_t index, int first, unsigned hits,
                       const double* s, const double* t, const double* depth) {
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
          RecordLeastDepth(lane + k, depth[i + k], leaf.depth_error);
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

  // Returns whether a hit may be the nearest one, or may coincide with the nearest one.
  bool Matters(int lane, const TileHit& hit) const {
    return job_.coincidences ? hit.depth - hit.error <= Reach(lane) : hit.depth < depth_[lane];
  }

  // Tests a root in a certified leaf against the trimming and then against the depth. Returns whether it is
  // the nearest hit so far.
  bool AcceptRoot(const CertifiedLeaf& leaf, double root_error, std::uint32_t index, int lane, TileHit hit) {
    if (!(hit.depth > job_.near_depth)) return false;
    if (nearest_only_ && !Matters(lane, hit)) {
      RecordLeastDepth(lane, hit.depth, hit.error);  // without testing the trimming
      return false;
    }
    std::uint8_t doubt = 0;
    if (OnPatchBorder(leaf, root_error, hit.s, hit.t) &&
        !job_.resolver->OwnsBorderRoot(index, x_[lane], y_[lane], &hit, &doubt))
      return false;
    bool keep = true;
    if (leaf.flags & kLeafTrimmed) {
      ++job_.counters->trim_tests;
      keep = job_.resolver->IsInsideFace(index, hit.s, hit.t, x_[lane], y_[lane], &doubt);
    }
    AddDoubt(lane, doubt, hit.depth - hit.error);
    return keep && AcceptHit(index, lane, hit, doubt);
  }

  // Accepts a hit. Returns whether it is the nearest so far.
  bool AcceptHit(std::uint32_t index, int lane, const TileHit& hit, std::uint8_t doubt) {
    if (job_.every_hit) job_.resolver->RecordHit(LaneSample(lane), index, hit, doubt);
    if (job_.coincidences && leaf_[lane] != kMiss && hit.depth - hit.error <= Reach(lane) &&
        depth_[lane] - error_[lane] <= hit.depth + hit.error &&
        job_.leaves.Header(static_cast<std::uint32_t>(leaf_[lane])).placed_face !=
            job_.leaves.Header(index).placed_face)
      AddDoubt(lane, kDoubtCoincident, std::fmin(hit.depth - hit.error, depth_[lane] - error_[lane]));
    if (hit_ >> lane & 1) RecordLeastDepth(lane, hit.depth, hit.error);
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

  // Records the second and all later hits of a lane. When the error intervals of two hits overlap, either may
  // be the nearest, so the smallest possible depth is recorded. A hit without an error bound has a doubt and
  // is not recorded.
  void RecordLeastDepth(int lane, double depth, double error) {
    if (!(depth - error < Reach(lane))) return;
    if (!several_) std::fill_n(least_, kPacketLanes, kInfinity);
    several_ = true;
    if (error_[lane] < kInfinity) least_[lane] = std::fmin(least_[lane], depth_[lane] - error_[lane]);
    if (error < kInfinity) least_[lane] = std::fmin(least_[lane], depth - error);
  }

  // Adds the roots of a leaf without a certificate to one lane of a packet.
  class LaneSink final : public RootSink {
   public:
    LaneSink(Packet* packet, std::uint32_t index, int lane) : packet_(packet), index_(index), lane_(lane) {}
    void Add(const TileHit& hit, std::uint8_t doubt, bool kept) override {
      packet_->AddDoubt(lane_, doubt, hit.depth - hit.error);
      if (kept) packet_->AcceptHit(index_, lane_, hit, doubt);
    }

   private:
    Packet* packet_;
    std::uint32_t index_;
    int lane_;
  };

  void TestUncertified(const LeafHeader& leaf, std::uint32_t index, unsigned lanes) {
    for (unsigned rest = lanes; rest; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      ++job_.counters->fallbacks;
      LaneSink sink(this, index, lane);
      const double limit = nearest_only_ ? Reach(lane) : kInfinity;
      const std::uint8_t doubt = job_.resolver->SolveUncertified(index, x_[lane], y_[lane], limit, &sink);
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
      // Process all lanes of one leaf at a time.
      const Wide one = SetWide(leaf_[__builtin_ctz(rest)]);
      unsigned lanes = 0;
      for (int i = 0; i < kPacketLanes; i += kWideLanes)
        lanes |= (LessOrEqual(one, Load(leaf_ + i)) & LessOrEqual(Load(leaf_ + i), one)) << i;
      const auto index = static_cast<std::uint32_t>(leaf_[__builtin_ctz(rest)]);
      rest &= ~lanes;
      for (int first = 0; first < kPacketLanes; first += kLanes) {
        const unsigned group = lanes >> first & ((1u << kLanes) - 1);
        if (group != 0) WriteNormals(index, first, group);
      }
    }
  }

  // Writes the normals of the lanes `group`, counted from `first`; zero for lanes without a normal.
  void WriteNormals(std::uint32_t leaf, int first, unsigned group) const {
    Real x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {};
    unsigned known = 0;
    if (KindOf(leaf) == LeafKind::kCertified) {
      const Lane s = LoadNarrow(s_ + first), t = LoadNarrow(t_ + first);
      const Normal normal = NormalAt(job_.leaves.certified[leaf], x_ + first, y_ + first, s, t, job_.axes);
      Store(normal.x, x);
      Store(normal.y, y);
      Store(normal.z, z);
      known = normal.known;
    }
    for (; group; group &= group - 1) {
      const int k = __builtin_ctz(group);
      std::array<float, 3>& out = job_.normal[LaneSample(first + k)];
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
  unsigned active_ = 0;           // lanes that are to be traced
  unsigned valid_ = 0, hit_ = 0;  // those of them inside the image, and those with a hit
  bool begun_ = false, doubtful_ = false, several_ = false;
  double farthest_ = kInfinity;
  alignas(64) double x_[kPacketLanes], y_[kPacketLanes], depth_[kPacketLanes], s_[kPacketLanes],
      t_[kPacketLanes];
  double error_[kPacketLanes];        // error of the depth, as a root of its leaf
  double least_[kPacketLanes];        // with several_: lower bound of the depths of the lane's hits
  double reach_[kPacketLanes];        // Reach(); −inf outside the image
  double leaf_[kPacketLanes];         // index of the leaf, or kMiss
  double doubt_depth_[kPacketLanes];  // lower bound of the depths at which doubts arose
  std::uint8_t doubt_[kPacketLanes];
};

}  // namespace
}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE
