#include "render/image/codec.h"

#include <filesystem>
#include <fstream>
#include <new>

namespace facetless {

Result<void> CheckImageSize(const std::string& path, int width, int height, std::size_t found,
                            std::size_t channels) {
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
    return Error{ErrorCode::kLimitExceeded, path + ": " + std::to_string(width) + "×" +
                                                std::to_string(height) +
                                                " pixels; 1 to 65536 on a side can be written"};
  if (found != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels)
    return Error{ErrorCode::kSizeMismatch,
                 path + ": the picture's size and its number of pixels do not match"};
  return {};
}

Result<std::vector<unsigned char>> ReadImageBytes(const std::string& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed))
    return Error{ErrorCode::kFileUnreadable,
                 path + ": " + (failed ? failed.message() : std::string("not a file"))};
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  std::ifstream stream(path, std::ios::binary);
  if (failed || !stream) return Error{ErrorCode::kFileUnreadable, path + ": cannot be opened for reading"};
  try {
    std::vector<unsigned char> bytes(size);
    if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
      return Error{ErrorCode::kFileUnreadable, path + ": cannot be read to its end"};
    return bytes;
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  }
}

Error ImageTooLarge(const std::string& path) {
  return {ErrorCode::kLimitExceeded, path + ": the image does not fit into memory"};
}

}  // namespace facetless
