// The Space Subdivision Method with inverted lists (V. Skala, "Memory saving technique for space subdivision
// technique", section 5): the supervoxels of BmssmSlices, each with a list of the objects that reach into it.
// It is there for the comparison of memory.
//
//     const SsmLists lists(boxes, /*slices=*/16);
//     QueryState state(lists.state_size());
//     lists.Visit({origin, direction}, state, visit);
//
//  1. Supervoxel (i, j, k) lists exactly the objects whose bits are set in R_i & S_j & T_k of BmssmSlices
//     with the same planes.
//  2. With N slices on each axis and p objects, of which a supervoxel lists q on average, the source counts
//     M_SSM = 2·N³·(q + 2) bytes for the lists, with numbers of 2 bytes, against M_BMSSM = 3·N·p / 8 bytes
//     for the bitmaps. Their ratio is ν_mem = 16/3 · (q + 2)/p · N² (MemoryEfficiency), which becomes 16/3 ·
//     N² for large objects (q → p), 16·N²/p where each supervoxel lists one object, and 32/3 · N²/p where
//     nearly all are empty.
//  3. This implementation has numbers of 4 bytes, and no counters: bytes() says what is really used.
//  4. The walk is that of Grid, with the laws 3 to 5 of grid.h.
#pragma once

#include <span>

#include "render/accel/structure.h"
#include "render/accel/voxels.h"

namespace facetless {

// ν_mem for N slices on each axis, p objects, and q objects per supervoxel on average.
double MemoryEfficiency(double slices, double objects, double per_supervoxel);

class SsmLists {
 public:
  static constexpr bool kOnce = true;

  // With `slices` equal slices on each axis; 0 chooses as BmssmSlices does.
  explicit SsmLists(std::span<const Box3> boxes, std::uint32_t slices = 0);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    VisitVoxels<true>(boxes_, planes_, lists_, segment, state, visit);
  }
  std::uint32_t slices() const { return planes_.count(0); }
  // The objects of a supervoxel.
  std::span<const std::uint32_t> Supervoxel(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return lists_.Voxel(i + std::size_t{planes_.count(0)} * (j + std::size_t{planes_.count(1)} * k));
  }
  StateSize state_size() const { return {.stamps = boxes_.size()}; }
  std::size_t bytes() const { return boxes_.bytes() + planes_.bytes() + lists_.bytes(); }
  std::size_t list_bytes() const { return lists_.bytes(); }
  StructureFigures figures() const {
    return {static_cast<double>(planes_.voxels()), static_cast<double>(lists_.references()), 1};
  }

 private:
  BoxSet boxes_;
  VoxelPlanes planes_;
  VoxelLists lists_;
};

}  // namespace facetless
