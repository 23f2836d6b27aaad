// Walks of rays through voxel models, with one function for each encoding. voxel_ray.h says which voxels a ray visits.
//
//     VoxelRay ray;
//     if (!ray.Enter(origin, direction, 0, octree.size())) return;
//     WalkCounters counters;
//     const VoxelHit hit = WalkDescent(octree, ray, {.footprint = 0.7}, &counters);
//
//  1. WalkGrid passes the voxels of a raw model one by one, and WalkDescent the nodes of an octree from the root down.
//     Without a footprint, both give the same hit, bit for bit.
//  2. WalkDescent may stop at a level of detail: at an inner node that is not empty, if its cube is no wider than the
//     footprint of the pixel, whose width in voxels is footprint_0 + footprint·t. The hit then has the mean of the node.
//     Without a footprint, the walk goes down to the leaves.
#pragma once

#include "render/voxel_walks/voxel_ray.h"
#include "render/voxels/octree_model.h"
#include "render/voxels/raw_model.h"

namespace facetless {

struct WalkOptions {
  double footprint_0 = 0, footprint = 0;  // law 2
};

struct WalkCounters {
  std::uint64_t rays = 0, steps = 0;  // steps: voxels or nodes that were looked at
};

VoxelHit WalkGrid(const RawModel& model, const VoxelRay& ray, WalkCounters* counters);
VoxelHit WalkDescent(const OctreeModel& model, const VoxelRay& ray, const WalkOptions& options,
                     WalkCounters* counters);

}  // namespace facetless
