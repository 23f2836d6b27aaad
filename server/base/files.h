// Reading and writing small files. A file is written completely or not at all.
//
//     Result<std::string> text = ReadFile(path, /*max_bytes=*/1 << 20);
//     if (!text) return text.error();
//     Result<void> written = WriteFileAtomically("report.json", JsonText(report));
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// Writes a temporary file in the same directory and then renames it to `path`. Error: kWriteFailed.
Result<void> WriteFileAtomically(const std::string& path, std::string_view bytes);

// Moves `from` to `to`, which may be on another file system. `to` appears completely or not at all. Error:
// kWriteFailed.
Result<void> MoveFile(const std::string& from, const std::string& to);

// Reads a whole file. Errors: kFileUnreadable, kLimitExceeded (the file has more than max_bytes).
Result<std::string> ReadFile(const std::string& path, std::size_t max_bytes);

// Makes the directory and its parents. Error: kWriteFailed.
Result<void> MakeDirectories(const std::string& path);

// JSON as text. Bytes that are not valid UTF-8 (names from CAD files) become U+FFFD.
std::string JsonText(const nlohmann::json& json, int indent = 2);

}  // namespace facetless
