// What the encodings of voxel models share (voxel_model.h).
#pragma once

#include <cstdint>

#include "render/voxels/voxel_model.h"

namespace facetless {

// Sums up voxels for the mean of a cube.
class MeanOfVoxels {
 public:
  // Adds a voxel, or the mean of a cube, that stands for `filled` filled voxels.
  void Add(Voxel voxel, std::uint64_t filled);
  // Each channel is rounded to the nearest value.
  Voxel Get() const;
  std::uint64_t filled() const { return filled_; }

 private:
  std::uint64_t red_ = 0, green_ = 0, blue_ = 0, filled_ = 0;
  std::uint32_t material_ = 0;
};

// A cube of 2^level voxels on a side, with its lowest corner at `low`.
struct VoxelCube {
  VoxelPoint low;
  int level = 0;

  int edge() const { return 1 << level; }
  VoxelBox box() const { return {low, {low.x + edge(), low.y + edge(), low.z + edge()}}; }
  std::uint64_t volume() const { return std::uint64_t{1} << (3 * level); }
  // Child number x + 2y + 4z, where each is 0 for the lower half and 1 for the upper.
  VoxelCube Child(int child) const {
    const int half = edge() / 2;
    return {{low.x + (child & 1 ? half : 0), low.y + (child & 2 ? half : 0), low.z + (child & 4 ? half : 0)},
            level - 1};
  }
};

// The number of the child that holds a voxel, of a cube of 2^level voxels on a side.
inline int ChildOf(VoxelPoint p, int level) {
  const int shift = level - 1;
  return (p.x >> shift & 1) | (p.y >> shift & 1) << 1 | (p.z >> shift & 1) << 2;
}

// The level of the smallest cube at the origin that holds a model.
int LevelOf(VoxelPoint size);

}  // namespace facetless
