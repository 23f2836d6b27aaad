// `facetless render FILE.oct --out picture.png`: a picture of a voxel file.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/run/run.h"

namespace facetless {

// Whether the options that were given belong to files of the kind: voxels, or CAD. Error: kBadUsage, which names the first
// option that does not.
Result<void> CheckRenderOptions(const std::vector<std::string>& given, bool voxels);

// Renders the file to `path`, which ends in .png, and returns what docs/voxels.md describes. Errors: kBadUsage (the path, the
// walk, more than one view); those of ReadVoxels, Converted, RenderVoxelPicture and WritePng; kLimitExceeded (the time
// limit).
Result<nlohmann::json> RunVoxelRender(const std::string& file, const RunOptions& options,
                                      const std::string& path, const RunContext& context);

}  // namespace facetless
