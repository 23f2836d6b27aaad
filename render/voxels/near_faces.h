// The faces near voxels, and their normals: what a ray that hits a voxel shows of the exact surfaces.
//
//     const NearFaces faces(std::move(touched_slabs));
//     if (const auto face = faces.Near(hit.at, 1, direction)) Shade(face->placed_face, face->normal);
//
//  1. The face near a voxel is that of the touched voxel whose centre is nearest, at most `reach` voxels away along each
//     axis; of several, that of the lowest placed face.
//  2. The normal is the mean of those of the same face's touched voxels within the reach, weighted by 1/(1 + d²), where d is
//     the distance in voxels. Each of them counts with the sign with which it points against the direction.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/base/vec.h"
#include "render/voxels/touched_voxels.h"

namespace facetless {

struct NearFace {
  std::uint32_t placed_face;
  Vec3 normal;  // unit, against the direction; zero if no normal is known
};

class NearFaces {
 public:
  // A slab for each x, of a grid with `size_y` voxels along y.
  NearFaces(std::vector<TouchedSlab> slabs, int size_y);

  std::optional<NearFace> Near(VoxelPoint at, int reach, Vec3 direction) const;
  // The touched voxel at a point; null if no face touches the voxel.
  const TouchedVoxel* At(VoxelPoint at) const;
  std::uint64_t bytes() const;

 private:
  // The touched voxels of a column with low ≤ z ≤ high; empty outside the grid.
  std::span<const TouchedVoxel> Between(int x, int y, int low, int high) const;

  std::vector<TouchedSlab> slabs_;
  std::vector<std::uint32_t>
      first_;  // x·(size_y + 1) + y: the index of each column's first voxel in its slab
  int size_y_;
};

}  // namespace facetless
