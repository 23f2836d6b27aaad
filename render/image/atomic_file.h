// Files that appear in full or not at all.
#pragma once

#include <span>
#include <string>

#include "render/base/result.h"

namespace facetless {

// Writes `bytes` under a temporary name beside `path`, flushes, and renames. On failure the temporary file
// is removed and what stood at `path` before is untouched. Error: kWriteFailed with the path and the
// system's reason.
Result<void> WriteAtomically(const std::string& path, std::span<const unsigned char> bytes);

}  // namespace facetless
