// The walk "descent": from the root of an octree down to the leaf that holds the ray, and up again only as far as the ray
// leaves nodes. The planes that halve a node are passed at times that are computed once, when the ray enters the node, and
// serve all its children: a child ends at the middle of its parent, or where its parent ends.
#include <algorithm>

#include "render/voxel_walks/octree_path.h"
#include "render/voxel_walks/walks.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

// An inner node on the path to the ray. Coordinates and times are those of AscendingRay.
struct Entry {
  const OctreeNode* children;
  double low[3];
  double middle[3], end[3];  // when the ray passes the middle of the node, and its end, along each axis
  double t_out;
};

VoxelHit WalkDescent(const OctreeModel& model, const VoxelRay& ray, const WalkOptions& options,
                     WalkCounters* counters) {
  ++counters->rays;
  const AscendingRay up = ray.Ascending();
  double t = ray.t_start();
  const bool levels = options.footprint_0 + options.footprint * std::min(ray.t_last(), 1e300) >= 2;
  const auto voxel_of = [&](const Entry& entry, double edge) {
    const auto real = [&](int axis) {
      return static_cast<int>(up.descends >> axis & 1 ? -entry.low[axis] - edge : entry.low[axis]);
    };
    return VoxelPoint{real(0), real(1), real(2)};
  };
  Entry path[kMostOctreeLevels + 1];
  Entry* entry = path;
  int level = model.level();
  double edge = 1 << level;  // of the entry's cube
  OctreeNode node = model.root();
  for (int axis = 0; axis < 3; ++axis) {
    entry->low[axis] = up.descends >> axis & 1 ? -edge : 0;
    entry->end[axis] = up.Pass(axis, entry->low[axis] + edge);
  }
  entry->t_out = ray.t_last();
  std::uint64_t steps = 0, nodes = 1;
  VoxelHit hit;
  if (node.leaf()) {
    ++counters->steps, ++counters->nodes;
    return node.voxel.filled() ? ray.HitAt(t, node.voxel, 0) : hit;
  }
  for (bool entered = true;;) {
    if (entered) {
      // The node becomes the last entry of the path.
      if (levels)
        if (const VoxelPoint low = voxel_of(*entry, edge); StopsAt(ray, options, low, level, t)) {
          hit = ray.HitAt(ray.EnterAt(low, 1 << level), node.voxel, level);
          break;
        }
      entry->children = model.Children(node);
      for (int axis = 0; axis < 3; ++axis) entry->middle[axis] = up.Pass(axis, entry->low[axis] + 0.5 * edge);
    }
    // The child that holds t.
    const unsigned x = entry->middle[0] <= t, y = entry->middle[1] <= t, z = entry->middle[2] <= t;
    node = entry->children[(x | y << 1 | z << 2) ^ up.descends];
    ++nodes;
    const double end[3] = {x ? entry->end[0] : entry->middle[0], y ? entry->end[1] : entry->middle[1],
                           z ? entry->end[2] : entry->middle[2]};
    const double t_out = std::min(std::min(entry->t_out, end[0]), std::min(end[1], end[2]));
    if (!node.leaf()) {
      const double half[2] = {0, 0.5 * edge};
      Entry* const child = entry + 1;
      child->low[0] = entry->low[0] + half[x];
      child->low[1] = entry->low[1] + half[y];
      child->low[2] = entry->low[2] + half[z];
      std::copy(end, end + 3, child->end);
      child->t_out = t_out;
      entry = child;
      --level;
      edge *= 0.5;
      entered = true;
      continue;
    }
    entered = false;
    ++steps;
    if (node.voxel.filled()) {
      hit = ray.HitAt(t, node.voxel, 0);
      break;
    }
    t = t_out;
    while (entry != path && !(t < entry->t_out)) {
      --entry;
      ++level;
      edge *= 2;
    }
    if (!(t < entry->t_out)) break;
  }
  counters->steps += steps, counters->nodes += nodes;
  return hit;
}

}  // namespace

std::unique_ptr<const BoundWalk> BindDescent(const VoxelModel& model, int setting) {
  return BindFunction<OctreeModel, WalkDescent>(model, setting);
}

}  // namespace facetless
