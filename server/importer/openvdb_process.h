// Runs `facetless-openvdb`, the only program that uses OpenVDB, on one file.
//
//  1. It is a process of its own, under limits of memory and time, and it reaches no other files than its input and its
//     directory, as the importer (import_process.h). A file that makes the library crash, hang or fill the memory is one
//     error.
//  2. The program lies beside the running binary. A build without OpenVDB has none.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "server/base/temp_dir.h"

namespace facetless {

struct OpenVdbRequest {
  std::string input;                   // the file that the program reads
  std::vector<std::string> arguments;  // what follows; other files must lie in the directory
  std::uint64_t max_bytes = 0;         // of memory
  double timeout_s = 600;
  Execution execution;  // without threads: the library uses all cores
};

// Whether this build has the program.
bool HasOpenVdb();

// Runs the program, and returns what it answers. Errors: kBadUsage (there is no program; the message names the remedy),
// kFileUnreadable, kImporterCrashed, kLimitExceeded, kCancelled, and all that the program reports.
Result<nlohmann::json> RunOpenVdb(const OpenVdbRequest& request, const TempDir& directory);

}  // namespace facetless
