// What the codecs share: a file's bytes, and what is said of a size or a file that none of them can use.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/base/result.h"

namespace facetless {

constexpr int kMaxImageSide = 65536;  // pixels

// 1 … kMaxImageSide on a side (kLimitExceeded), and `found` values for `channels` per pixel (kSizeMismatch).
Result<void> CheckImageSize(const std::string& path, int width, int height, std::size_t found,
                            std::size_t channels);

// A regular file's bytes. Errors: kFileUnreadable, kLimitExceeded (memory).
Result<std::vector<unsigned char>> ReadImageBytes(const std::string& path);

// The one answer to a failed allocation.
Error ImageTooLarge(const std::string& path);

}  // namespace facetless
