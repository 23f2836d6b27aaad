// `facetless store check`: checks whether the database of a data directory agrees with its files.
//
//  1. The check changes nothing. It needs exclusive use of the directory, and refuses to run while the
//     service runs.
//  2. These facts are checked: the database is intact; every file to which a row refers exists with the right
//     size and SHA-256; every use of a file has its file and its item; a model or an answer has the files of
//     its kind; every file on the disk has a row; tmp/ is empty; the state of a job agrees with its times,
//     its result and its problem; a job that has ended holds no files.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// Returns {"directory", "files", "bytes", "items", "jobs": {state: n}, "faults": [{"kind", "what",
// "detail"}]}. Errors: the errors of DataDirectory::Open; kBadUsage (there is no data directory).
Result<nlohmann::json> CheckStore(const std::string& directory);

// Prints the result of CheckStore and returns an exit code.
int StoreCheckCommand(const std::string& directory);

}  // namespace facetless
