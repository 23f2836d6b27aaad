// Files of OpenVDB, as other programs write them and expect them.
//
//  1. A file that is written has three grids with one transform in millimetres, whose voxels have their centres at whole
//     indices: `density`, a fog volume that is 1 inside and 0 outside; `Cd`, the colour in linear light (Rec. 709); and
//     `material`, whole numbers. The metadata have the size and the origin of the model, which grids of OpenVDB do not have
//     otherwise.
//  2. A file that is read gives the voxels of one grid: of `density`, or else of the first grid of a type that is read
//     (float, double, int32, int64, bool, mask). In a level set, voxels below 0 are inside. In other grids, active voxels
//     above the threshold are. Colours are those of the grid `Cd`, or grey (178) if there is none. Materials are
//     those of the grid `material` if it lies beside `density`, and 1 otherwise.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/voxel_files/voxel_file.h"

namespace facetless {

// Errors: kFormatUnknown, kFormatBroken, kNothingUsable (no grid that is read; no voxel), kLimitExceeded. Exceptions of the
// library leave both functions: a file that is missing, damaged, or cannot be written.
Result<VoxelFile> ReadGrids(const std::string& path, double threshold, std::uint64_t max_bytes);

// Error: kBadUsage (a pitch below 2e-5 mm).
Result<void> WriteGrids(const std::string& path, const VoxelModel& model, const VoxelGrid& grid);

}  // namespace facetless
