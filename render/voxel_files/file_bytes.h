// Reading and writing the bytes of voxel files, little-endian.
#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/result.h"

namespace facetless {

// Writes a file beside its target and renames it at the end, so that readers see either the whole file or none of it.
class VoxelFileWriter {
 public:
  explicit VoxelFileWriter(std::string path);
  ~VoxelFileWriter();
  VoxelFileWriter(const VoxelFileWriter&) = delete;
  VoxelFileWriter& operator=(const VoxelFileWriter&) = delete;

  void Text(std::string_view text) { stream_.write(text.data(), static_cast<std::streamsize>(text.size())); }
  // An integer or a floating-point number.
  template <typename T>
  void Number(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    stream_.write(bytes, sizeof(T));
  }
  // Whether everything was written so far, so that a writer of many slices can stop early. Error: kWriteFailed.
  Result<void> Checked() const;
  // Error: kWriteFailed.
  Result<void> Finish();

 private:
  Error Failed() const;

  const std::string path_, partial_;
  std::ofstream stream_;
  bool finished_ = false;
};

// Reads numbers from bytes, and never beyond their end: a function that would do so returns false.
class VoxelFileReader {
 public:
  explicit VoxelFileReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  template <typename T>
  bool Number(T* value) {
    if (bytes_.size() - at_ < sizeof(T)) return false;
    std::memcpy(value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return true;
  }
  bool Skip(std::size_t count) {
    if (bytes_.size() - at_ < count) return false;
    at_ += count;
    return true;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  std::size_t at() const { return at_; }
  std::span<const unsigned char> rest() const { return bytes_.subspan(at_); }

 private:
  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
};

// Errors: kFileUnreadable, kLimitExceeded (larger than `max_bytes`).
Result<std::vector<unsigned char>> ReadVoxelBytes(const std::string& path, std::uint64_t max_bytes);

// The size of a regular file. Error: kFileUnreadable.
Result<std::uint64_t> VoxelFileSize(const std::string& path);
// The first bytes of a file, at most `most`. Error: kFileUnreadable.
Result<std::string> ReadVoxelStart(const std::string& path, std::size_t most);

// The shortest decimal text that reads back as the same number.
std::string PreciseText(double value);

// The checksum of stored trees: FNV-1a, 64 bits (G. Fowler, L. Noll, K.-P. Vo).
std::uint64_t Checksum(std::span<const unsigned char> bytes);

}  // namespace facetless
