// What walks through octrees share: the cube in which a ray is, and the test of its level of detail.
#pragma once

#include "render/voxel_walks/voxel_walk.h"

namespace facetless {

// Whether a walk stops at an inner node, which is not empty, because its cube is no wider than the pixel (voxel_walk.h,
// law 2). The ray is in the cube at t; the first test is cheap, and holds whenever the second one does.
inline bool StopsAt(const VoxelRay& ray, const WalkOptions& options, VoxelPoint low, int level, double t) {
  const double edge = 1 << level;
  return level > 0 && edge <= options.footprint_0 + options.footprint * t &&
         edge <= options.footprint_0 + options.footprint * ray.EnterAt(low, 1 << level);
}

// The hit of a leaf whose cube the ray enters at t.
inline VoxelHit LeafHit(const VoxelRay& ray, double t, Voxel voxel, VoxelPoint low, int level) {
  return level == 0 ? ray.HitAt(t, voxel, 0, low) : ray.HitAt(t, voxel, 0);
}

}  // namespace facetless
