// The exact walk through a grid of voxels; J. Amanatides and A. Woo, "A fast voxel traversal algorithm for ray tracing" (1987).
// Each plane's t is computed from its coordinate and not by addition, so that no error grows along the ray.
#pragma once

#include <algorithm>

#include "render/voxel_walks/voxel_walk.h"

namespace facetless {

// Passes the voxels of a box one by one, beginning at *t, at which the ray is in the box. voxel_at(p) returns the voxel at a
// point in the box. Without a hit, *t becomes the t at which the ray leaves the box, or the model.
template <typename VoxelAt>
VoxelHit StepThrough(const VoxelRay& ray, const VoxelBox& box, double* t, const VoxelAt& voxel_at,
                     WalkCounters* counters) {
  VoxelPoint cell = ray.CellAt(*t);
  int* const index[3] = {&cell.x, &cell.y, &cell.z};
  double leave[3];
  for (int axis = 0; axis < 3; ++axis) leave[axis] = ray.Leave(axis, *index[axis], *index[axis] + 1);
  std::uint64_t steps = 0;
  VoxelHit hit;
  while (box.Holds(cell)) {
    ++steps;
    if (const Voxel voxel = voxel_at(cell); voxel.filled()) {
      hit = ray.HitAt(*t, voxel, 0, cell);
      break;
    }
    // The axes whose planes are passed at the same t are stepped together.
    *t = std::min(std::min(leave[0], leave[1]), leave[2]);
    if (!(*t < ray.t_last())) break;
    for (int axis = 0; axis < 3; ++axis)
      if (leave[axis] == *t) {
        // Further planes may be passed at the same t, as t is rounded.
        *index[axis] = ray.IndexAt(axis, *t, *index[axis] + ray.sign(axis));
        leave[axis] = ray.Leave(axis, *index[axis], *index[axis] + 1);
      }
  }
  counters->steps += steps;
  return hit;
}

}  // namespace facetless
