// Walks of rays through voxel models, by name. voxel_ray.h says which voxels a ray visits.
//
//     Result<std::unique_ptr<const BoundWalk>> walk = BindVoxelWalk(*model, "kd-shortstack:4");
//     VoxelRay ray;
//     if (!ray.Enter(origin, direction, 0, model->size())) return;
//     WalkCounters counters;
//     const VoxelHit hit = walk.value()->Walk(ray, {.footprint = 0.7}, &counters);
//
//  1. A walk takes models of one encoding. All exact walks find the same hit, bit for bit, in models of the same voxels.
//  2. A walk with levels may stop at a level of detail: at an inner node that is not empty, if its cube is no wider than the
//     footprint of the pixel when the ray enters it. The footprint is footprint_0 + footprint·t voxels wide, with both at
//     least 0. The hit then has the mean of the node. All walks through octrees stop at the same node, bit for bit. Walks
//     without levels go down to the voxels. Without a footprint, all walks do.
//  3. A bound walk keeps a reference to its model, which must outlive it and must not be edited meanwhile. Any number of
//     threads may use it.
//  4. Each ray takes one virtual call. Walks allocate nothing for a ray.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "render/base/result.h"
#include "render/voxel_walks/voxel_ray.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

struct WalkOptions {
  double footprint_0 = 0, footprint = 0;  // law 2
};

struct WalkCounters {
  std::uint64_t rays = 0;
  std::uint64_t steps = 0;  // voxels, leaves and columns through which rays passed
  std::uint64_t nodes = 0;  // nodes of trees that were read on the way there
};

class BoundWalk {
 public:
  virtual ~BoundWalk() = default;
  virtual VoxelHit Walk(const VoxelRay& ray, const WalkOptions& options, WalkCounters* counters) const = 0;
  // Memory besides the model.
  virtual std::uint64_t bytes() const { return 0; }
};

struct NamedVoxelWalk {
  std::string_view name;
  std::string_view description;   // one sentence
  std::string_view encoding;      // of the models that it takes
  bool exact = true;              // law 1
  bool levels = false;            // law 2
  std::string_view setting = {};  // what the number after the name says; empty: there is none
  int usual = 0, most = 0;        // the setting: 1 … most
  // Requires a model of the encoding, and a setting in its range.
  std::unique_ptr<const BoundWalk> (*bind)(const VoxelModel& model, int setting) = nullptr;
};

// All walks. The first one of each encoding is the usual one.
std::span<const NamedVoxelWalk> VoxelWalks();
// Error: kBadUsage (no walk has that name; the message lists the names).
Result<const NamedVoxelWalk*> FindVoxelWalk(std::string_view name);
// Requires a name of VoxelEncodings().
const NamedVoxelWalk& UsualVoxelWalk(std::string_view encoding);

// Binds a walk, "NAME" or "NAME:SETTING"; an empty text is the usual walk of the model's encoding. Errors: kBadUsage (the
// name; the setting; the walk takes another encoding).
Result<std::unique_ptr<const BoundWalk>> BindVoxelWalk(const VoxelModel& model, std::string_view walk);

}  // namespace facetless
