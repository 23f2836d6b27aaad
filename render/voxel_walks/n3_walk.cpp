// The walk "bricks": from leaf to leaf of an N³-tree, and voxel by voxel through its bricks. At a level of detail, it stops at
// inner nodes, and within bricks at the cubes of their mip maps.
#include <algorithm>

#include "render/voxel_walks/grid_steps.h"
#include "render/voxel_walks/octree_path.h"
#include "render/voxel_walks/walks.h"
#include "render/voxels/n3_tree_model.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

// Passes the cubes of a brick's mip maps: the largest empty ones, and no smaller ones than the pixel needs. Without a hit, *t
// becomes the t at which the ray leaves the brick.
VoxelHit StepThroughMips(const N3TreeModel& model, const N3Node& brick, VoxelPoint low, const VoxelRay& ray,
                         const WalkOptions& options, double* t, WalkCounters* counters) {
  const int top = model.brick_level();
  const double t_out = std::min(ray.Leave(low, 1 << top), ray.t_last());
  while (*t < t_out) {
    ++counters->steps;
    const VoxelPoint cell = ray.CellAt(*t);
    for (int level = top; level >= 0; --level) {
      const Voxel voxel = model.InBrick(brick, cell, level);
      const VoxelPoint cube{cell.x >> level << level, cell.y >> level << level, cell.z >> level << level};
      if (!voxel.filled()) {
        *t = ray.Leave(cube, 1 << level);
        break;
      }
      if (level == 0) return ray.HitAt(*t, voxel, 0, cell);
      if (StopsAt(ray, options, cube, level, *t))
        return ray.HitAt(ray.EnterAt(cube, 1 << level), voxel, level);
    }
  }
  return {};
}

VoxelHit WalkBricks(const N3TreeModel& model, const VoxelRay& ray, const WalkOptions& options,
                    WalkCounters* counters) {
  ++counters->rays;
  struct Place {
    N3Node node;
    VoxelPoint low;
    int level;
  };
  Place path[kMostOctreeLevels + 1];
  int depth = 0;
  path[0] = {model.root(), {0, 0, 0}, model.level()};
  double t = ray.t_first();
  for (;;) {
    const N3Node node = path[depth].node;
    const VoxelPoint low = path[depth].low;
    const int level = path[depth].level;
    if (node.leaf()) {
      ++counters->steps;
      if (node.voxel.filled()) return ray.HitAt(t, node.voxel, 0);
      t = ray.Leave(low, 1 << level);
    } else if (level > model.brick_level()) {
      if (StopsAt(ray, options, low, level, t))
        return ray.HitAt(ray.EnterAt(low, 1 << level), node.voxel, level);
      // Each digit of the child's place is decided as in an octree.
      const int child_level = level - model.digit_level(), n = model.n();
      VoxelPoint child = low;
      for (int half = level - 1; half >= child_level; --half) {
        const int edge = 1 << half;
        child.x += ray.IsAbove(0, child.x + edge, t) ? edge : 0;
        child.y += ray.IsAbove(1, child.y + edge, t) ? edge : 0;
        child.z += ray.IsAbove(2, child.z + edge, t) ? edge : 0;
      }
      const auto digit = [&](int at, int from) { return (at - from) >> child_level; };
      path[depth + 1] = {
          model.Children(
              node)[(digit(child.z, low.z) * n + digit(child.y, low.y)) * n + digit(child.x, low.x)],
          child, child_level};
      ++depth;
      ++counters->nodes;
      continue;
    } else {
      const double last = std::min(ray.Leave(low, 1 << level), ray.t_last());
      VoxelHit hit;
      if (options.footprint_0 + options.footprint * std::min(last, 1e300) >= 2) {
        hit = StepThroughMips(model, node, low, ray, options, &t, counters);
      } else {
        const VoxelBox cube{low, {low.x + (1 << level), low.y + (1 << level), low.z + (1 << level)}};
        hit = StepThrough(
            ray, cube, &t, [&](VoxelPoint p) { return model.InBrick(node, p, 0); }, counters);
      }
      if (hit.hit()) return hit;
    }
    if (!(t < ray.t_last())) return {};
    while (depth > 0 && !(t < ray.Leave(path[depth].low, 1 << path[depth].level))) --depth;
  }
}

}  // namespace

std::unique_ptr<const BoundWalk> BindN3(const VoxelModel& model, int setting) {
  return BindFunction<N3TreeModel, WalkBricks>(model, setting);
}

}  // namespace facetless
