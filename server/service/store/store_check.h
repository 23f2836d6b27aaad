// `facetless store check`: does the database of a data directory agree with its files?
//
//  1. It changes nothing, and needs the directory for itself: a running service is told from a stopped one.
//  2. Checked: the database itself; every file that a row names is there with its bytes and its SHA-256;
//     every use of a file has its file, and its holder; a model or answer has the files of its kind; every
//     file on the disk has a row; nothing lies in tmp/; a job's state agrees with its times, its result and
//     its problem, and a job that ended holds nothing.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// {"directory", "files", "bytes", "items", "jobs": {state: n}, "faults": [{"kind", "what", "detail"}]}.
// Errors: those of DataDirectory::Open; kBadUsage (there is no data directory).
Result<nlohmann::json> CheckStore(const std::string& directory);

// Prints that and returns an exit code.
int StoreCheckCommand(const std::string& directory);

}  // namespace facetless
