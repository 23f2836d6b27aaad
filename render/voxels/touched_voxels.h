// The voxels that the faces of a model touch (voxelize.h, law 2).
//
//     Result<std::vector<TouchedSlab>> slabs = FindTouchedVoxels(scene, grid, {.max_bytes = max_bytes}, execution);
//     for (const TouchedVoxel& voxel : slabs.value()[x]) Mark(x, voxel.y, voxel.z);
//
//  1. Patches are halved until their boxes are no larger than a voxel, or until no trim curve meets them and they differ
//     from parallelograms by no more than half a voxel. Pieces that are proven to be trimmed away are dropped. A piece
//     counts as touching the voxels that meet its box and its slabs: a slab is the space between two planes that hold all
//     its control points between them. A piece has one slab across the normal of its four corners, and a parallelogram also
//     has slabs across its sides. So no face meets a voxel that is not listed. A face may miss a listed voxel, by no more
//     than about a voxel along each axis.
//  2. The voxels of a slab are sorted by y and z, and each is listed once, with the lowest placed face that touches it. With
//     TouchOptions::details, it is listed once for each face that touches it, in ascending order, with the mean normal of
//     the face there. Normals point outwards.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/execution.h"
#include "render/trace/direct.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

struct TouchedVoxel {
  std::uint16_t y, z;
  std::uint32_t placed_face;
  std::uint32_t normal = 0;  // NormalCode; 0: unknown
};

// A unit vector in 32 bits, by the octahedral mapping (Q. Meyer et al., "On floating-point normal vectors", 2010), and back.
// The code of the zero vector is 0, and no other vector has this code.
std::uint32_t NormalCode(Vec3 normal);
Vec3 NormalOfCode(std::uint32_t code);

// All touched voxels of one x.
using TouchedSlab = std::vector<TouchedVoxel>;

// Sorts a slab, and lists each voxel once (law 2), or once for each face.
void SortTouched(TouchedSlab* slab, bool details);

struct TouchOptions {
  std::uint64_t max_bytes = 0;
  // Law 2. The normals differ by no more than about 0.02 radians from those of the surface in the voxel. Without it, they
  // are those of pieces that may be 32 voxels wide, which takes less time.
  bool details = false;
};

// Returns a slab for each x of the grid. Errors: kCancelled, kLimitExceeded (they need more than `max_bytes`).
Result<std::vector<TouchedSlab>> FindTouchedVoxels(const Scene& scene, const VoxelGrid& grid,
                                                   const TouchOptions& options, const Execution& execution);

}  // namespace facetless
