// Files that are written completely or not at all.
#pragma once

#include <span>
#include <string>

#include "render/base/result.h"

namespace facetless {

// Writes `bytes` to a temporary file next to `path`, flushes it, and renames it. If that fails, the temporary
// file is removed and an existing file at `path` is unchanged. Error: kWriteFailed with the path and the
// reason given by the system.
Result<void> WriteAtomically(const std::string& path, std::span<const unsigned char> bytes);

}  // namespace facetless
