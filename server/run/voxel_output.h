// `facetless voxelize`: makes voxels of the exact solids of a model, and writes them to a file.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/voxel_files/voxel_file.h"
#include "server/run/run.h"

namespace facetless {

struct VoxelizeResult {
  nlohmann::json json;                // the grid, the counts, what is proven, times and memory
  std::vector<std::string> warnings;  // sentences: what the format loses, open faces, columns in doubt
};

// Errors: those of Voxelize and of WriteVoxels; kBadUsage (the grid, the fraction, or nothing is
// shown); kLimitExceeded (the time limit).
Result<VoxelizeResult> RunVoxelize(const ImportedModel& imported, const RunOptions& options,
                                   const std::string& path, const RunContext& context);

}  // namespace facetless
