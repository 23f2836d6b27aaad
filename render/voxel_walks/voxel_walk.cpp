#include "render/voxel_walks/voxel_walk.h"

#include <algorithm>

namespace facetless {

VoxelHit WalkGrid(const RawModel& model, const VoxelRay& ray, WalkCounters* counters) {
  ++counters->rays;
  double t = ray.t_first();
  VoxelPoint cell = ray.CellAt(t);
  int* const index[3] = {&cell.x, &cell.y, &cell.z};
  double leave[3];
  for (int axis = 0; axis < 3; ++axis) leave[axis] = ray.Leave(axis, *index[axis], *index[axis] + 1);
  while (model.box().Holds(cell)) {
    ++counters->steps;
    if (const Voxel voxel = model.At(cell); voxel.filled()) return ray.HitAt(t, voxel, 0);
    // The axes whose planes are passed at the same t are stepped together.
    t = std::min(std::min(leave[0], leave[1]), leave[2]);
    if (!(t < ray.t_last())) break;
    for (int axis = 0; axis < 3; ++axis)
      if (leave[axis] == t) {
        *index[axis] += ray.sign(axis);
        // Planes may be passed at the same t as they are rounded.
        *index[axis] = ray.IndexAt(axis, t, *index[axis]);
        leave[axis] = ray.Leave(axis, *index[axis], *index[axis] + 1);
      }
  }
  return {};
}

VoxelHit WalkDescent(const OctreeModel& model, const VoxelRay& ray, const WalkOptions& options,
                     WalkCounters* counters) {
  ++counters->rays;
  struct Waiting {
    const OctreeNode* children;
    VoxelPoint low;  // of the parent's cube
    double t_out;    // of the parent
  };
  Waiting stack[kMostOctreeLevels + 1];
  double t = ray.t_first();
  const OctreeNode* node = &model.root();
  VoxelPoint low{0, 0, 0};
  int level = model.level();
  int depth = 0;
  double t_out = std::min(ray.t_last(), ray.Leave(low, 1 << level));
  for (;;) {
    ++counters->steps;
    if (node->leaf()) {
      if (node->voxel.filled()) return ray.HitAt(t, node->voxel, 0);
      // Leave the node, and all ancestors that end at the same t.
      t = t_out;
      while (depth > 0 && !(t < stack[depth - 1].t_out)) {
        --depth;
        ++level;
      }
      if (depth == 0) return {};
    } else {
      if (level > 0 && node->voxel.filled() && (1 << level) <= options.footprint_0 + options.footprint * t)
        return ray.HitAt(t, node->voxel, level);
      stack[depth++] = {model.Children(*node), low, t_out};
      --level;
    }
    // Go to the child of the node on top of the stack that holds t.
    const Waiting& parent = stack[depth - 1];
    const int half = 1 << level;
    const int x = ray.IsAbove(0, parent.low.x + half, t), y = ray.IsAbove(1, parent.low.y + half, t),
              z = ray.IsAbove(2, parent.low.z + half, t);
    node = parent.children + (x | y << 1 | z << 2);
    low = {parent.low.x + x * half, parent.low.y + y * half, parent.low.z + z * half};
    t_out = std::min(parent.t_out, ray.Leave(low, half));
  }
}

}  // namespace facetless
