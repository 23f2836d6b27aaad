// Files that are on the disk when a function returns, not only in the system's memory.
#pragma once

#include <string>

#include "render/base/result.h"

namespace facetless {

// Syncs the file's content. Error: kWriteFailed.
Result<void> SyncFile(const std::string& path);

// Renames a synced file, makes it read-only, and syncs the directory that it comes to. Error: kWriteFailed.
Result<void> RenameDurably(const std::string& from, const std::string& to);

}  // namespace facetless
