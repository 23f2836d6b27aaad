// Reads and writes depth as float64 TIFF with libtiff.
#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include "render/image/atomic_file.h"
#include "render/image/codec.h"
#include "render/image/io.h"
#include "render/image/tiff_handle.h"

namespace facetless {
namespace {

constexpr std::uint32_t kRowsPerStrip = 64;
// Level 1 with the floating-point predictor takes a third of the time of level 6, for files that are 10 %
// larger.
constexpr int kCompressionLevel = 1;

// A file in memory that libtiff reads or writes.
struct Memory {
  std::vector<unsigned char> bytes;
  std::uint64_t position = 0;
  std::string failure;  // the first error message of libtiff
};

tmsize_t ReadSome(thandle_t handle, void* data, tmsize_t size) {
  auto* memory = static_cast<Memory*>(handle);
  const std::uint64_t left =
      memory->bytes.size() - std::min<std::uint64_t>(memory->position, memory->bytes.size());
  const std::uint64_t count = std::min<std::uint64_t>(left, static_cast<std::uint64_t>(size));
  std::memcpy(data, memory->bytes.data() + memory->position, count);
  memory->position += count;
  return static_cast<tmsize_t>(count);
}

tmsize_t WriteSome(thandle_t handle, void* data, tmsize_t size) {
  auto* memory = static_cast<Memory*>(handle);
  const std::uint64_t end = memory->position + static_cast<std::uint64_t>(size);
  try {
    if (end > memory->bytes.size()) memory->bytes.resize(end);
  } catch (const std::bad_alloc&) {
    return -1;
  }
  std::memcpy(memory->bytes.data() + memory->position, data, static_cast<std::size_t>(size));
  memory->position = end;
  return size;
}

toff_t Seek(thandle_t handle, toff_t offset, int whence) {
  auto* memory = static_cast<Memory*>(handle);
  const std::uint64_t from = whence == SEEK_CUR   ? memory->position
                             : whence == SEEK_END ? memory->bytes.size()
                                                  : 0;
  return memory->position = from + offset;
}

int Close(thandle_t) {
  return 0;
}

toff_t Size(thandle_t handle) {
  return static_cast<Memory*>(handle)->bytes.size();
}

// Opens a TIFF file in memory. `memory` must outlive the result.
Tiff Open(Memory& memory, const std::string& path, const char* mode) {
  const TiffOptions options = KeepFailures(&memory.failure);
  return Tiff(TIFFClientOpenExt(path.c_str(), mode, &memory, ReadSome, WriteSome, Seek, Close, Size, nullptr,
                                nullptr, options.get()));
}

// Copies a block of `width` × `height` numbers to (x, y), in rows of `stride`. Numbers outside the image are
// skipped.
template <typename T>
void CopyBlock(const T* block, std::uint32_t stride, std::uint32_t x, std::uint32_t y, std::uint32_t width,
               std::uint32_t height, DepthImage& image) {
  const std::uint32_t columns = std::min(width, static_cast<std::uint32_t>(image.width) - x);
  const std::uint32_t rows = std::min(height, static_cast<std::uint32_t>(image.height) - y);
  for (std::uint32_t row = 0; row < rows; ++row)
    std::copy_n(block + std::size_t{row} * stride, columns,
                image.depth.begin() + static_cast<std::ptrdiff_t>(std::size_t{y + row} * image.width + x));
}

// Reads all blocks, which are strips of the whole width or tiles.
template <typename T>
bool ReadBlocks(TIFF* tiff, DepthImage& image) {
  const auto image_width = static_cast<std::uint32_t>(image.width),
             image_height = static_cast<std::uint32_t>(image.height);
  const bool tiled = TIFFIsTiled(tiff) != 0;
  const std::uint32_t width = tiled ? TiffField<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH) : image_width;
  const std::uint32_t height =
      tiled ? TiffField<std::uint32_t>(tiff, TIFFTAG_TILELENGTH)
            : std::min(TiffField<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP), image_height);
  if (width == 0 || height == 0) return false;
  const tmsize_t size = tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
  if (size < 0 || static_cast<std::uint64_t>(size) < std::uint64_t{width} * height * sizeof(T)) return false;
  std::vector<T> block(static_cast<std::size_t>(size) / sizeof(T));
  std::uint32_t index = 0;
  for (std::uint32_t y = 0; y < image_height; y += height)
    for (std::uint32_t x = 0; x < image_width; x += width, ++index) {
      const std::uint32_t rows = tiled ? height : std::min(height, image_height - y);
      const tmsize_t wanted = static_cast<tmsize_t>(std::size_t{width} * rows * sizeof(T));
      const tmsize_t got = tiled ? TIFFReadEncodedTile(tiff, index, block.data(), size)
                                 : TIFFReadEncodedStrip(tiff, index, block.data(), wanted);
      if (got < wanted) return false;
      CopyBlock(block.data(), width, x, y, width, rows, image);
    }
  return true;
}

}  // namespace

Result<void> WriteDepth(const std::string& path, int width, int height, std::span<const double> depth) {
  if (Result<void> size = CheckImageSize(path, width, height, depth.size(), 1); !size.ok()) return size;
  Memory memory;
  const auto failed = [&] {
    return Error{ErrorCode::kWriteFailed,
                 path + ": " + (memory.failure.empty() ? "out of memory" : memory.failure)};
  };
  Tiff tiff = Open(memory, path, "wl");
  if (tiff == nullptr) return failed();
  TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(width));
  TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(height));
  TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, 64);
  TIFFSetField(tiff.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff.get(), TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(tiff.get(), TIFFTAG_PREDICTOR, PREDICTOR_FLOATINGPOINT);
  TIFFSetField(tiff.get(), TIFFTAG_ZIPQUALITY, kCompressionLevel);
  TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP, kRowsPerStrip);
  // The predictor modifies its input, so a copy is needed.
  std::vector<double> strip;
  const std::size_t per_strip = std::size_t{kRowsPerStrip} * static_cast<std::size_t>(width);
  for (std::size_t begin = 0; begin < depth.size(); begin += per_strip) {
    const std::span<const double> rows = depth.subspan(begin, std::min(per_strip, depth.size() - begin));
    strip.assign(rows.begin(), rows.end());
    if (TIFFWriteEncodedStrip(tiff.get(), static_cast<std::uint32_t>(begin / per_strip), strip.data(),
                              static_cast<tmsize_t>(rows.size_bytes())) < 0)
      return failed();
  }
  if (TIFFFlush(tiff.get()) == 0) return failed();
  tiff.reset();
  return WriteAtomically(path, memory.bytes);
}

Result<DepthImage> ReadDepth(const std::string& path) {
  Result<std::vector<unsigned char>> bytes = ReadImageBytes(path);
  if (!bytes.ok()) return bytes.error();
  const std::span<const unsigned char> start(bytes.value().data(),
                                             std::min<std::size_t>(bytes.value().size(), 4));
  const auto starts_with = [&](const char(&magic)[5]) {
    return start.size() == 4 && std::memcmp(start.data(), magic, 4) == 0;
  };
  // Accept both byte orders, and classic and large (BigTIFF) files.
  if (!starts_with("II*\0") && !starts_with("MM\0*") && !starts_with("II+\0") && !starts_with("MM\0+"))
    return Error{ErrorCode::kFormatUnknown, path + ": not a TIFF image"};
  Memory memory;
  memory.bytes = std::move(bytes).value();
  const auto broken = [&] {
    return Error{
        ErrorCode::kFormatBroken,
        path + ": " + (memory.failure.empty() ? "its blocks do not match its size" : memory.failure)};
  };
  const Tiff tiff = Open(memory, path, "r");
  if (tiff == nullptr) return broken();
  const auto width = TiffField<std::uint32_t>(tiff.get(), TIFFTAG_IMAGEWIDTH);
  const auto height = TiffField<std::uint32_t>(tiff.get(), TIFFTAG_IMAGELENGTH);
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
    return Error{ErrorCode::kLimitExceeded, path + ": each side must have 1 to 65536 pixels"};
  const auto bits = TiffField<std::uint16_t>(tiff.get(), TIFFTAG_BITSPERSAMPLE);
  if (TiffField<std::uint16_t>(tiff.get(), TIFFTAG_SAMPLESPERPIXEL) != 1 || (bits != 32 && bits != 64) ||
      TiffField<std::uint16_t>(tiff.get(), TIFFTAG_SAMPLEFORMAT) != SAMPLEFORMAT_IEEEFP)
    return Error{ErrorCode::kFormatBroken, path + ": a depth image has one channel of float32 or float64"};
  DepthImage image;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  try {
    image.depth.resize(std::size_t{width} * height);
    if (!(bits == 64 ? ReadBlocks<double>(tiff.get(), image) : ReadBlocks<float>(tiff.get(), image)))
      return broken();
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  }
  return image;
}

}  // namespace facetless
