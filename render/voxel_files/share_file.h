// Files of voxels with the share of each that is inside, and its bound (render/voxels/voxel_shares.h).
//
//  1. .vti has two more cell arrays of 32-bit floating-point numbers, `fraction` and `fraction_bound`. ReadVoxels reads the
//     file as any other.
//  2. .nrrd has the two numbers for each voxel (kind "2-vector") instead of the material. ReadVoxels reads nothing of it.
#pragma once

#include <atomic>
#include <string>

#include "render/base/result.h"
#include "render/voxels/voxel_model.h"
#include "render/voxels/voxel_shares.h"

namespace facetless {

// Error: kBadUsage (the format of the path holds no shares). Callers ask before they measure the shares.
Result<void> CheckShareFormat(const std::string& path);

// Errors: that of CheckShareFormat, kWriteFailed, kCancelled (`cancel` became true; it may be null). Requires shares of the
// model's grid.
Result<void> WriteShares(const std::string& path, const VoxelModel& model, const VoxelShares& shares,
                         const std::atomic<bool>* cancel);

}  // namespace facetless
