// Durable file operations: when a function returns, its effect is on the disk, not only in the memory of the
// system.
#pragma once

#include <string>

#include "render/base/result.h"

namespace facetless {

// Syncs the content of the file. Error: kWriteFailed.
Result<void> SyncFile(const std::string& path);

// Renames a synced file, makes it read-only, and syncs its new directory. Error: kWriteFailed.
Result<void> RenameDurably(const std::string& from, const std::string& to);

}  // namespace facetless
