// Streams of bytes and of numbers, so that readers of large files need memory for a slice at a time.
//
//     NumberSource numbers(Inflated(FileRange(path, 512)), NumberType::kUint16, std::endian::big);
//     std::vector<double> slice(width * height);
//     if (!numbers.Read(slice)) return BrokenVoxelFile(path, "the voxels end too early");
//
//  1. A source that is damaged ends where the damage is: Read then returns fewer bytes than it was asked for.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace facetless {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Reads as many bytes as there are, up to to.size(), and returns how many these are.
  virtual std::size_t Read(std::span<unsigned char> to) = 0;
};

// The bytes of a file from `begin` on.
std::unique_ptr<ByteSource> FileRange(const std::string& path, std::uint64_t begin);
// What was compressed with zlib or gzip; several streams may follow one another.
std::unique_ptr<ByteSource> Inflated(std::unique_ptr<ByteSource> compressed);
// What is written as base64. White space is ignored, padding may occur anywhere, and any other character ends the text.
std::unique_ptr<ByteSource> FromBase64(std::unique_ptr<ByteSource> text);

enum class NumberType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kUint64, kInt64, kFloat, kDouble };
std::size_t BytesOf(NumberType type);
inline bool IsWhole(NumberType type) {
  return type != NumberType::kFloat && type != NumberType::kDouble;
}

class NumberSource {
 public:
  NumberSource(std::unique_ptr<ByteSource> bytes, NumberType type, std::endian order);
  // Decimal numbers, with white space between them.
  static NumberSource FromText(std::unique_ptr<ByteSource> text);

  // Fills the whole span. Returns false if there are fewer numbers.
  bool Read(std::span<double> to);
  // Reads a length: an unsigned number of 4 or 8 bytes.
  std::optional<std::uint64_t> ReadLength();
  // What follows the numbers that were read.
  std::unique_ptr<ByteSource> Rest() && { return std::move(bytes_); }

 private:
  bool ReadText(std::span<double> to);

  std::unique_ptr<ByteSource> bytes_;
  NumberType type_;
  bool swap_, text_ = false;
  std::vector<unsigned char> buffer_;
  std::size_t at_ = 0, end_ = 0;  // in the buffer, of text
};

}  // namespace facetless
