// The JSON header beside files that have voxels and nothing else: raw voxels and slices.
#pragma once

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

// The members `size`, `pitch_mm` and `origin_mm`, with `format` and `version` 1.
nlohmann::json GridHeader(const std::string& format, VoxelPoint size, const VoxelGrid& grid);
// Reads a header and checks its format and version. Errors: those of ReadVoxelBytes; kFormatBroken.
Result<nlohmann::json> ReadGridHeader(const std::string& path, const std::string& format);
// The size that a header states. Error: kFormatBroken.
Result<VoxelPoint> SizeOfHeader(const std::string& path, const nlohmann::json& header);
// The grid that a header states; nothing if it states none.
std::optional<VoxelGrid> GridOfHeader(const nlohmann::json& header, VoxelPoint size);

}  // namespace facetless
