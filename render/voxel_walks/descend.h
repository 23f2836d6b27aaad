// Goes down an octree, from a node that a ray visits to the leaf that holds the ray, and up again only as far as the ray leaves
// nodes. The planes that halve a node are passed at times that are computed once, when the ray enters the node, and serve all
// its children: a child ends at the middle of its parent, or where its parent ends.
#pragma once

#include <algorithm>

#include "render/voxel_walks/octree_path.h"
#include "render/voxels/octree_model.h"

namespace facetless {

// A node and its cube, with the lowest corner in the coordinates of AscendingRay.
struct OctreeCube {
  OctreeNode node;
  double low[3];
  int level;
};

// The root of a model, in the coordinates of AscendingRay.
inline OctreeCube RootCube(const OctreeModel& model, const AscendingRay& up) {
  OctreeCube cube{model.root(), {0, 0, 0}, model.level()};
  for (int axis = 0; axis < 3; ++axis)
    if (up.descends >> axis & 1) cube.low[axis] = -(1 << cube.level);
  return cube;
}

// The hit in a cube, in which the ray is at t and which it leaves at t_out; none, if the cube is empty along the ray.
inline VoxelHit Descend(const OctreeModel& model, const OctreeCube& cube, const VoxelRay& ray,
                        const AscendingRay& up, double t, double t_out, const WalkOptions& options,
                        WalkCounters* counters) {
  // An inner node on the path to the ray. Coordinates and times are those of AscendingRay.
  struct Entry {
    const OctreeNode* children;
    double low[3];
    double pass[2][3];  // when the ray passes the middle of the node, and its end, along each axis
    double t_out;
  };
  const bool levels = options.footprint_0 + options.footprint * std::min(t_out, 1e300) >= 2;
  Entry path[kMostOctreeLevels + 1];
  Entry* entry = path;
  int level = cube.level;
  double edge = 1 << level;  // of the entry's cube
  OctreeNode node = cube.node;
  VoxelHit hit;
  if (node.leaf()) {
    ++counters->steps, ++counters->nodes;
    return node.voxel.filled() ? ray.HitAt(t, node.voxel, 0) : hit;
  }
  for (int axis = 0; axis < 3; ++axis) {
    entry->low[axis] = cube.low[axis];
    entry->pass[1][axis] = up.Pass(axis, cube.low[axis] + edge);
  }
  entry->t_out = t_out;
  std::uint64_t steps = 0, nodes = 1;
  for (bool entered = true;;) {
    if (entered) {
      // The node becomes the last entry of the path.
      if (levels) {
        const auto real = [&](int axis) {
          return static_cast<int>(up.descends >> axis & 1 ? -entry->low[axis] - edge : entry->low[axis]);
        };
        const VoxelPoint low{real(0), real(1), real(2)};
        if (StopsAt(ray, options, low, level, t)) {
          hit = ray.HitAt(ray.EnterAt(low, 1 << level), node.voxel, level);
          break;
        }
      }
      entry->children = model.Children(node);
      for (int axis = 0; axis < 3; ++axis)
        entry->pass[0][axis] = up.Pass(axis, entry->low[axis] + 0.5 * edge);
    }
    // The child that holds t.
    const unsigned x = entry->pass[0][0] <= t, y = entry->pass[0][1] <= t, z = entry->pass[0][2] <= t;
    node = entry->children[(x | y << 1 | z << 2) ^ up.descends];
    ++nodes;
    // Choices by index take no branches, whose outcomes a processor could not predict.
    const double end[3] = {entry->pass[x][0], entry->pass[y][1], entry->pass[z][2]};
    const double child_out = std::min(std::min(entry->t_out, end[0]), std::min(end[1], end[2]));
    if (!node.leaf()) {
      const double half[2] = {0, 0.5 * edge};
      Entry* const child = entry + 1;
      child->low[0] = entry->low[0] + half[x];
      child->low[1] = entry->low[1] + half[y];
      child->low[2] = entry->low[2] + half[z];
      std::copy(end, end + 3, child->pass[1]);
      child->t_out = child_out;
      entry = child;
      --level;
      edge *= 0.5;
      entered = true;
      continue;
    }
    entered = false;
    ++steps;
    if (node.voxel.filled()) {
      if (level > 1) {
        hit = ray.HitAt(t, node.voxel, 0);
      } else {
        // The leaf is a voxel.
        const auto real = [&](int axis, unsigned upper) {
          const int at = static_cast<int>(entry->low[axis]) + static_cast<int>(upper);
          return up.descends >> axis & 1 ? -at - 1 : at;
        };
        hit = ray.HitAt(t, node.voxel, 0, {real(0, x), real(1, y), real(2, z)});
      }
      break;
    }
    t = child_out;
    while (entry != path && !(t < entry->t_out)) {
      --entry;
      ++level;
      edge *= 2;
    }
    if (!(t < entry->t_out)) break;
  }
  counters->steps += steps;
  counters->nodes += nodes;
  return hit;
}

}  // namespace facetless
