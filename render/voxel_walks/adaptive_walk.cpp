// The walk "adaptive": from leaf to leaf of an adaptive octree as kd-backtrack does, and voxel by voxel through its bricks. At
// a level of detail, it stops at inner nodes and at whole bricks: the voxels of bricks have no means.
#include <algorithm>

#include "render/voxel_walks/grid_steps.h"
#include "render/voxel_walks/octree_path.h"
#include "render/voxel_walks/walks.h"
#include "render/voxels/adaptive_octree_model.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

VoxelHit WalkAdaptive(const AdaptiveOctreeModel& model, const VoxelRay& ray, const WalkOptions& options,
                      WalkCounters* counters) {
  ++counters->rays;
  struct Place {
    AdaptiveNode node;
    VoxelPoint low;
    int level;
  };
  Place path[kMostOctreeLevels + 1];
  int depth = 0;
  path[0] = {model.root(), {0, 0, 0}, model.level()};
  double t = ray.t_first();
  for (;;) {
    // Go down to the leaf, or the brick, that holds t.
    const AdaptiveNode node = path[depth].node;
    const VoxelPoint low = path[depth].low;
    const int edge = 1 << path[depth].level;
    if (!node.leaf() && node.voxel.filled() && StopsAt(ray, options, low, path[depth].level, t))
      return ray.HitAt(ray.EnterAt(low, edge), node.voxel, path[depth].level);
    if (!node.leaf() && !node.brick()) {
      const int half = edge / 2, x = ray.IsAbove(0, low.x + half, t), y = ray.IsAbove(1, low.y + half, t),
                z = ray.IsAbove(2, low.z + half, t);
      path[depth + 1] = {model.Children(node)[x | y << 1 | z << 2],
                         {low.x + x * half, low.y + y * half, low.z + z * half},
                         path[depth].level - 1};
      ++depth;
      ++counters->nodes;
      continue;
    }
    if (node.brick()) {
      const VoxelBox box = Intersection({low, {low.x + edge, low.y + edge, low.z + edge}}, model.box());
      const VoxelHit hit = StepThrough(
          ray, box, &t, [&](VoxelPoint p) { return model.InBrick(node, low, p); }, counters);
      if (hit.hit()) return hit;
    } else {
      ++counters->steps;
      if (node.voxel.filled()) return LeafHit(ray, t, node.voxel, low, path[depth].level);
      t = ray.Leave(low, edge);
    }
    if (!(t < ray.t_last())) return {};
    while (depth > 0 && !(t < ray.Leave(path[depth].low, 1 << path[depth].level))) --depth;
  }
}

}  // namespace

std::unique_ptr<const BoundWalk> BindAdaptive(const VoxelModel& model, int setting) {
  return BindFunction<AdaptiveOctreeModel, WalkAdaptive>(model, setting);
}

}  // namespace facetless
