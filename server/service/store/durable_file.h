// Durable file operations: when a function that syncs returns, its effect is on the disk, not only in the memory
// of the system.
#pragma once

#include <string>

#include "render/base/result.h"

namespace facetless {

// Syncs the content of the file. Error: kWriteFailed.
Result<void> SyncFile(const std::string& path);

// Renames a synced file and makes it read-only. The new name is on the disk after SyncDirectory. Error: kWriteFailed.
Result<void> RenameReadOnly(const std::string& from, const std::string& to);

// Syncs the names in a directory. Error: kWriteFailed.
Result<void> SyncDirectory(const std::string& path);

}  // namespace facetless
