#include "render/voxel_files/file_bytes.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace facetless {

static_assert(std::endian::native == std::endian::little,
              "voxel files are read and written as they lie in memory");

VoxelFileWriter::VoxelFileWriter(std::string path)
    : path_(std::move(path)),
      partial_(path_ + ".partial"),
      stream_(partial_, std::ios::binary | std::ios::trunc) {}

VoxelFileWriter::~VoxelFileWriter() {
  if (!finished_) std::remove(partial_.c_str());
}

Error VoxelFileWriter::Failed() const {
  return {ErrorCode::kWriteFailed,
          path_ + ": cannot be written; the directory is absent, permission is missing, or the disk is full"};
}

Result<void> VoxelFileWriter::Checked() const {
  if (!stream_) return Failed();
  return {};
}

Result<void> VoxelFileWriter::Finish() {
  stream_.close();
  if (!stream_ || std::rename(partial_.c_str(), path_.c_str()) != 0) return Failed();
  finished_ = true;
  return {};
}

Result<std::uint64_t> VoxelFileSize(const std::string& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed))
    return Error{ErrorCode::kFileUnreadable,
                 path + ": " + (failed ? failed.message() : std::string("not a file"))};
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  if (failed || !std::ifstream(path, std::ios::binary))
    return Error{ErrorCode::kFileUnreadable, path + ": cannot be opened for reading"};
  return std::uint64_t{size};
}

Result<std::string> ReadVoxelStart(const std::string& path, std::size_t most) {
  const Result<std::uint64_t> size = VoxelFileSize(path);
  if (!size.ok()) return size.error();
  std::string start(std::min<std::uint64_t>(size.value(), most), '\0');
  if (!std::ifstream(path, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size())))
    return Error{ErrorCode::kFileUnreadable, path + ": cannot be read"};
  return start;
}

Result<std::vector<unsigned char>> ReadVoxelBytes(const std::string& path, std::uint64_t max_bytes) {
  const Result<std::uint64_t> size = VoxelFileSize(path);
  if (!size.ok()) return size.error();
  if (size.value() > max_bytes)
    return Error{ErrorCode::kLimitExceeded, path + ": has " + std::to_string(size.value() >> 20) +
                                                " MB, but " + std::to_string(max_bytes >> 20) +
                                                " MB are allowed; raise --max-view-memory"};
  std::ifstream stream(path, std::ios::binary);
  std::vector<unsigned char> bytes(size.value());
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())))
    return Error{ErrorCode::kFileUnreadable, path + ": cannot be read to its end"};
  return bytes;
}

std::string PreciseText(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

std::uint64_t Checksum(std::span<const unsigned char> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325u;
  for (const unsigned char byte : bytes) sum = (sum ^ byte) * 0x100000001b3u;
  return sum;
}

}  // namespace facetless
