// Small files in and out, in full or not at all.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// Writes under a temporary name beside `path`, then renames. Error: kWriteFailed.
Result<void> WriteFileAtomically(const std::string& path, std::string_view bytes);

// Moves `from` to `to`, also from one file system to another; `to` appears in full or not at all. Error:
// kWriteFailed.
Result<void> MoveFile(const std::string& from, const std::string& to);

// Errors: kFileUnreadable, kLimitExceeded (more than max_bytes).
Result<std::string> ReadFile(const std::string& path, std::size_t max_bytes);

// Makes the directory and its parents. Error: kWriteFailed.
Result<void> MakeDirectories(const std::string& path);

// JSON as text; bytes that are no UTF-8 (names from CAD files) become U+FFFD.
std::string JsonText(const nlohmann::json& json, int indent = 2);

}  // namespace facetless
