// From exact solids to voxels. Every column of voxels is a ray through the exact surfaces, and the runs of the column follow
// from its crossings.
//
//     const Result<VoxelGrid> grid = GridOfResolution(model.bounds, 256);
//     Result<Voxels> voxels = Voxelize(scene, grid.value(), {.fill = VoxelFill::kConservative}, execution);
//     if (!voxels) return voxels.error();
//     Print(voxels.value().model.Count(), voxels.value().stats.certified);
//
//  1. kSolid fills the voxels whose centres lie inside a closed solid. A centre is proven if its column is proven
//     (view_crossings.h), if the column crosses each solid an even number of times, and if the centre does not lie within
//     the error of a crossing. Where solids overlap, the one that begins lowest in the column gives colour and material.
//  2. kSurface fills the voxels that a surface touches: no face meets a voxel that is not filled. It may fill voxels that a
//     surface misses, by no more than about a voxel along each axis (touched_voxels.h, law 1). No path through sides, edges
//     or corners of empty voxels crosses the surface, so the voxels are 26-separating.
//  3. kThinSurface fills the voxels in which a surface crosses one of the three lines through the centre, parallel to an axis,
//     inside the voxel. No path through the sides of empty voxels crosses the surface, so the voxels are 6-separating.
//  4. kConservative fills what kSolid or kSurface fills: whatever a solid or an open face touches. A plate thinner than a
//     voxel never vanishes.
//  5. Faces that belong to no closed solid have no inside. They fill nothing in kSolid, and VoxelStats names the first
//     kMostOpenNames of them.
//  6. A voxel inside a solid has the colour of most faces of the solid. The voxels at both ends of a run, and those that a
//     surface touches, have the colour of the face there. The material is the number of the placed solid, 1 … 254, or 255
//     for all further solids and for open faces.
//  7. The voxels depend on the model and the grid alone, not on the number of threads or the instruction set.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/trace/direct.h"
#include "render/view/doubt.h"
#include "render/voxels/run_model.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

inline constexpr int kMostMaterials = 255;

enum class VoxelFill : std::uint8_t { kSolid, kConservative, kSurface, kThinSurface };
inline constexpr std::array<const char*, 4> kVoxelFillNames = {"solid", "conservative", "surface",
                                                               "thin-surface"};

struct VoxelizeOptions {
  VoxelFill fill = VoxelFill::kSolid;
  ExactTraceOptions accuracy;
};

struct VoxelStats {
  // Of the solid fills: all columns; those with a doubt, or that cross a solid an odd number of times; the latter alone.
  // Of kThinSurface: the rays along all three axes, and those with a doubt.
  std::uint64_t columns = 0, columns_in_doubt = 0, columns_odd = 0;
  std::uint64_t crossings = 0;
  // Of all voxels of the grid: those of which the centre is proven to be inside or outside, and those of which it is not.
  // Without a solid fill, both are 0.
  std::uint64_t certified = 0, not_certified = 0;
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};  // columns with each bit of Doubt
  std::uint64_t touched = 0;                               // voxels of laws 2 to 4; not for kSolid
  std::uint32_t open_faces = 0;                            // placed faces of no closed solid
  std::vector<std::string> open_face_names;                // the first kMostOpenNames of them
  std::uint32_t solids = 0;                                // placed closed solids
  double trace_ms = 0, touch_ms = 0;
  std::uint64_t peak_bytes = 0;  // leaves and bitmaps
};
inline constexpr std::size_t kMostOpenNames = 20;

struct Voxels {
  RunModel model;
  VoxelGrid grid;
  VoxelStats stats;
};

// Errors: those of TraceDirect.
Result<Voxels> Voxelize(const Scene& scene, const VoxelGrid& grid, const VoxelizeOptions& options,
                        const Execution& execution);

}  // namespace facetless
