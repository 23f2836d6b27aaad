// VoxelGrid: where the voxels of a model are, in millimetres.
//
//     const Result<VoxelGrid> grid = GridOfResolution(model.bounds, 256);
//     const Vec3 center = grid.value().Center({3, 4, 5});
//
//  1. Voxels are cubes of `pitch` mm, with edges along the model's axes. The voxel (0, 0, 0) has its lowest corner at
//     `origin`.
//  2. The grid holds the box for which it was made, with a border of at least kBorder voxels on every side, so that every
//     voxel that the model touches lies in the grid.
#pragma once

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

struct VoxelGrid {
  static constexpr double kBorder = 0.5;

  Vec3 origin;
  double pitch = 1;
  VoxelPoint size;

  Vec3 Corner(VoxelPoint p) const { return origin + pitch * Vec3{double(p.x), double(p.y), double(p.z)}; }
  Vec3 Center(VoxelPoint p) const { return origin + pitch * Vec3{p.x + 0.5, p.y + 0.5, p.z + 0.5}; }
  Box3 bounds() const { return {origin, Corner(size)}; }
  double voxel_mm3() const { return pitch * pitch * pitch; }
};

// The grid with `resolution` voxels along the longest side of the box, borders included. Errors: kBadUsage (an empty box; a
// resolution that is not 2 … kMostVoxelsPerAxis).
Result<VoxelGrid> GridOfResolution(const Box3& box, int resolution);
// The grid whose voxels have the side `pitch_mm`. Errors: kBadUsage (an empty box; a pitch that is not above 0, or that
// makes more than kMostVoxelsPerAxis voxels along a side).
Result<VoxelGrid> GridOfPitch(const Box3& box, double pitch_mm);

}  // namespace facetless
