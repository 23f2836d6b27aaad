// `facetless convert`: writes a file of voxels in another format.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/run/run.h"

namespace facetless {

struct ConvertResult {
  nlohmann::json json;                // what was read and written, the grid, times
  std::vector<std::string> warnings;  // sentences: what is lost, and what the source does not say
};

// Errors: those of ReadVoxels and of WriteVoxels; kCancelled; kLimitExceeded (the time limit; the columns of the model need
// more than max_view_memory).
Result<ConvertResult> RunConvert(const std::string& source, const std::string& target,
                                 const RunOptions& options, const RunContext& context);

}  // namespace facetless
