// Normals of voxels, which are cubes and have none of their own.
//
//     const Vec3 normal = GridNormal(*model, hit, direction);
//
//  1. The normal of the grid is the mean direction to the empty cubes of the hit's level within kNormalReach cubes along each
//     axis, each weighted by the inverse of its distance. Weights are whole numbers, so that the sum is exact, and does not
//     depend on the encoding. A cube is empty if no voxel in it is filled.
//  2. Where the sum is less than a fifth of that at a plane, as in a sheet that is a voxel thick, or does not point against the
//     ray and out of the side through which the ray entered, the normal is that of this side. Where the ray began in the
//     voxel, the normal points against the ray.
#pragma once

#include "render/voxel_walks/voxel_ray.h"

namespace facetless {

inline constexpr int kNormalReach = 2;

// The last sum: neighbouring rays often meet the same cube.
struct NormalMemory {
  VoxelPoint at{-1, -1, -1};
  int level = -1;
  Vec3 sum{0, 0, 0};
};

// Unit vectors. Require a hit, and a direction that is not zero. `memory` may be null; it belongs to one model.
Vec3 GridNormal(const VoxelModel& model, const VoxelHit& hit, Vec3 direction, NormalMemory* memory = nullptr);
Vec3 SideNormal(const VoxelHit& hit, Vec3 direction);

}  // namespace facetless
