// The faces near voxels, and their normals: what a ray that hits a voxel shows of the exact surfaces.
//
//     const NearFaces faces(std::move(touched_slabs));
//     if (const auto face = faces.Near(hit.at, 1, direction)) Shade(face->placed_face, face->normal);
//
//  1. The faces near a voxel are those that touch a voxel at most `reach` voxels away along each axis. Faces whose normal
//     there points against the direction come first; of these, the faces of the nearest voxel centre; of these, the one
//     whose normal points most against the direction; of these, the lowest placed face.
//  2. The normal is the mean of those of the same face within the reach, weighted by 1/(1 + d²), where d is the distance in
//     voxels.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/base/vec.h"
#include "render/voxels/touched_voxels.h"

namespace facetless {

struct NearFace {
  std::uint32_t placed_face;
  Vec3 normal;  // unit, outwards; zero if no normal is known
};

class NearFaces {
 public:
  // A slab for each x, with details, of a grid with `size_y` voxels along y.
  NearFaces(std::vector<TouchedSlab> slabs, int size_y);

  std::optional<NearFace> Near(VoxelPoint at, int reach, Vec3 direction) const;
  // The faces that touch a voxel.
  std::span<const TouchedVoxel> At(VoxelPoint at) const { return Between(at.x, at.y, at.z, at.z); }
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
