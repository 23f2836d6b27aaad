// Functions that the image codecs share: reading a file, and checking sizes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/base/result.h"

namespace facetless {

constexpr int kMaxImageSide = 65536;  // pixels

// Checks the size of an image that is to be written. Errors: kLimitExceeded (a side is not 1 …
// kMaxImageSide), kSizeMismatch (`found` is not the number of values for `channels` per pixel).
Result<void> CheckImageSize(const std::string& path, int width, int height, std::size_t found,
                            std::size_t channels);

// Reads the bytes of a regular file. Errors: kFileUnreadable, kLimitExceeded (memory).
Result<std::vector<unsigned char>> ReadImageBytes(const std::string& path);

// The error for a failed allocation.
Error ImageTooLarge(const std::string& path);

}  // namespace facetless
