// The share of each voxel's volume that lies inside closed solids, with bounds that are proven.
//
//     Result<VoxelShares> shares = MeasureShares(scene, grid, {.divisions = 4}, execution);
//     for (const ShareRun& run : shares.value().Column(x, y))  // the other voxels are proven to be empty
//       Use(run.z_begin, run.z_end, run.share, run.bound);
//
//  1. The share is computed from divisions² rays through each voxel along z: the mean of the lengths inside solids. Where
//     solids overlap, the space counts once.
//  2. The bound is proven. Each voxel consists of divisions³ small voxels. A small voxel that no face touches
//     (touched_voxels.h) is wholly inside or wholly outside, and the ray through its centre decides which. So the true share
//     lies between that of the small voxels that are inside, and this share and that of the small voxels that are touched,
//     or of which the ray is in doubt. It differs from `share` by no more than `bound`.
//  3. Shares do not depend on the number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/execution.h"
#include "render/trace/direct.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

// Voxels of a column with the same share, z_begin ≤ z < z_end.
struct ShareRun {
  int z_begin = 0, z_end = 0;
  float share = 0, bound = 0;  // 0 … 1; the bound is rounded up
};

struct ShareOptions {
  int divisions = 4;  // 2, 4, 8, 16 or 32
  ExactTraceOptions accuracy = {};
};

struct VoxelShares {
  VoxelGrid grid;
  int divisions = 0;
  double volume_mm3 = 0;        // the sum of the shares
  double volume_bound_mm3 = 0;  // proven: the sum of the bounds
  float greatest_bound = 0;
  std::uint64_t partial = 0;  // voxels whose share is not proven to be 0 or 1
  std::uint64_t rays = 0, rays_in_doubt = 0;
  std::uint64_t peak_bytes = 0;
  double trace_ms = 0, touch_ms = 0;

  // The runs of a column inside the grid, ascending, of all voxels that are not proven to be empty.
  std::span<const ShareRun> Column(int x, int y) const {
    const Slab& slab = slabs[static_cast<std::size_t>(x)];
    return {slab.runs.data() + slab.first[static_cast<std::size_t>(y)],
            slab.runs.data() + slab.first[static_cast<std::size_t>(y) + 1]};
  }
  ShareRun Get(int x, int y, int z) const;  // of a voxel inside the grid; its run has the length 1
  std::uint64_t bytes() const;

  struct Slab {
    std::vector<std::uint32_t> first;  // of each column, and the end
    std::vector<ShareRun> runs;
  };
  std::vector<Slab> slabs;  // of each x
};

// Whether shares can be measured. Error: kBadUsage (the divisions; more than kMostVoxelsPerAxis small voxels along a side).
Result<void> CheckDivisions(const VoxelGrid& grid, int divisions);

// Errors: that of CheckDivisions; those of TraceDirect and of FindTouchedVoxels.
Result<VoxelShares> MeasureShares(const Scene& scene, const VoxelGrid& grid, const ShareOptions& options,
                                  const Execution& execution);

}  // namespace facetless
