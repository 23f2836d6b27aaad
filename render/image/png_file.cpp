// Reads and writes PNG with libpng; libdeflate compresses.
#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <new>

#include "render/image/atomic_file.h"
#include "render/image/codec.h"
#include "render/image/io.h"
#include "render/image/slice_pictures.h"

namespace facetless {
namespace {

// The levels of compression, which zlib and libdeflate number alike, and the filter. Shaded surfaces are smooth along rows, and pictures of parts are mostly
// flat. According to measurements on both, and on data planes, trying every filter takes two to four times as
// long as this filter, for files that are between 12 % smaller and 20 % larger.
constexpr int kPictureLevel = 4, kLightLevel = 2, kStrongLevel = 6;
constexpr int kFilter = PNG_FILTER_SUB;
// libdeflate takes about half of zlib's time, but compresses in memory and in one piece. Larger pictures (bytes) are
// written row by row with zlib.
constexpr std::size_t kMostInOnePiece = std::size_t{1} << 26;

enum class Meaning { kColor, kData };

constexpr const char* kOutOfMemory = "out of memory";

// The target of libpng's callbacks. libpng is C, so they must not throw.
struct Sink {
  std::vector<unsigned char> bytes;
  std::string failure;
};

void Append(png_structp png, png_bytep data, png_size_t size) {
  auto* sink = static_cast<Sink*>(png_get_io_ptr(png));
  try {
    sink->bytes.insert(sink->bytes.end(), data, data + size);
  } catch (const std::bad_alloc&) {
    png_error(png, kOutOfMemory);
  }
}

void Flush(png_structp) {}

[[noreturn]] void Fail(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

void IgnoreWarning(png_structp, png_const_charp) {}

// The rows of an image as PNG stores them: each one behind the number of its filter, and each byte as its difference
// from that of the pixel to its left.
std::vector<unsigned char> FilteredRows(const Image8& image) {
  constexpr unsigned char kSub = 1;
  const std::size_t channels = static_cast<std::size_t>(image.channels),
                    stride = static_cast<std::size_t>(image.width) * channels;
  std::vector<unsigned char> filtered((stride + 1) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.at(0, y);
    unsigned char* to = filtered.data() + (stride + 1) * static_cast<std::size_t>(y);
    *to++ = kSub;
    std::copy_n(from, channels, to);
    for (std::size_t i = channels; i < stride; ++i)
      to[i] = static_cast<unsigned char>(from[i] - from[i - channels]);
  }
  return filtered;
}

// Compresses bytes as a zlib stream. Throws std::bad_alloc.
std::vector<unsigned char> Compressed(const std::vector<unsigned char>& bytes, int level) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::vector<unsigned char> stream(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()));
  stream.resize(
      libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), stream.data(), stream.size()));
  return stream;
}

// Encodes an image whose rows are compressed in `stream`; if that is empty, compresses them with zlib. libpng leaves this function by longjmp on errors, so every object with a destructor
// belongs to the caller. Returns false on failure, with the reason in sink.failure.
bool Encode(const Image8& image, Meaning meaning, int level, const std::vector<unsigned char>& stream,
            Sink& sink) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink.failure, Fail, IgnoreWarning);
  if (png == nullptr) return false;
  png_infop info = nullptr;
  if (setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  info = png_create_info_struct(png);
  if (info == nullptr) png_error(png, kOutOfMemory);
  png_set_write_fn(png, &sink, Append, Flush);
  png_set_user_limits(png, kMaxImageSide, kMaxImageSide);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               image.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
  if (meaning == Meaning::kColor) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, level);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, kFilter);
  png_write_info(png, info);
  if (stream.empty()) {
    for (int y = 0; y < image.height; ++y) png_write_row(png, image.at(0, y));
    png_write_end(png, info);
  } else {
    png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"), stream.data(), stream.size());
    png_write_chunk(png, reinterpret_cast<png_const_bytep>("IEND"), nullptr, 0);
  }
  png_destroy_write_struct(&png, &info);
  return true;
}

// Encodes an image as the bytes of a file. Messages name `path`.
Result<std::vector<unsigned char>> EncodePng(const std::string& path, const Image8& image, Meaning meaning,
                                             int level) {
  if (image.channels != 3 && (image.channels != 4 || meaning == Meaning::kData))
    return Error{ErrorCode::kBadUsage, path + ": a picture must have 3 or 4 channels, and data must have 3"};
  if (Result<void> size = CheckImageSize(path, image.width, image.height, image.bytes.size(), image.channels);
      !size.ok())
    return size.error();
  Sink sink;
  std::vector<unsigned char> stream;
  try {
    if (image.bytes.size() <= kMostInOnePiece) stream = Compressed(FilteredRows(image), level);
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  }
  if (!Encode(image, meaning, level, stream, sink)) {
    if (sink.failure.empty() || sink.failure == kOutOfMemory) return ImageTooLarge(path);
    return Error{ErrorCode::kWriteFailed, path + ": " + sink.failure};
  }
  return std::move(sink.bytes);
}

Result<void> Write(const std::string& path, const Result<std::vector<unsigned char>>& bytes) {
  if (!bytes.ok()) return bytes.error();
  return WriteAtomically(path, bytes.value());
}

// What ReadPngSlice reads: the bytes of the file become rows of 1 to 4 channels of 8 or 16 bits.
struct Slice {
  std::vector<unsigned char> bytes;
  std::size_t at = 0;
  std::uint64_t max_bytes = 0;
  std::string failure;
  bool too_large = false;

  std::size_t width = 0, height = 0, channels = 0, row_bytes = 0;
  bool wide = false;  // 16 bits
  std::vector<unsigned char> pixels;
  std::vector<png_bytep> rows;
};

void Take(png_structp png, png_bytep data, png_size_t size) {
  auto* slice = static_cast<Slice*>(png_get_io_ptr(png));
  if (slice->bytes.size() - slice->at < size) png_error(png, "the file ends too early");
  std::memcpy(data, slice->bytes.data() + slice->at, size);
  slice->at += size;
}

// libpng leaves this function by longjmp on errors, so every object with a destructor belongs to the caller.
bool Decode(Slice& slice) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &slice.failure, Fail, IgnoreWarning);
  if (png == nullptr) return false;
  png_infop info = nullptr;
  if (setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_read_struct(&png, &info, nullptr);
    return false;
  }
  info = png_create_info_struct(png);
  if (info == nullptr) png_error(png, kOutOfMemory);
  png_set_user_limits(png, kMaxImageSide, kMaxImageSide);
  png_set_read_fn(png, &slice, Take);
  png_read_info(png, info);
  png_set_expand(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  slice.width = png_get_image_width(png, info);
  slice.height = png_get_image_height(png, info);
  slice.channels = png_get_channels(png, info);
  slice.wide = png_get_bit_depth(png, info) == 16;
  slice.row_bytes = png_get_rowbytes(png, info);
  slice.too_large = (slice.row_bytes + 4 * slice.width) * slice.height > slice.max_bytes;
  if (slice.too_large) png_error(png, "too large");
  try {
    slice.pixels.resize(slice.row_bytes * slice.height);
    slice.rows.resize(slice.height);
  } catch (const std::bad_alloc&) {
    png_error(png, kOutOfMemory);
  }
  for (std::size_t y = 0; y < slice.height; ++y) slice.rows[y] = slice.pixels.data() + y * slice.row_bytes;
  png_read_image(png, slice.rows.data());
  png_read_end(png, nullptr);
  png_destroy_read_struct(&png, &info, nullptr);
  return true;
}

}  // namespace

Result<void> WritePng(const std::string& path, const Image8& image) {
  return Write(path, EncodePng(path, image, Meaning::kColor, kPictureLevel));
}

Result<void> WriteDataPng(const std::string& path, const Image8& image) {
  return Write(path, EncodePng(path, image, Meaning::kData, kLightLevel));
}

Result<std::string> EncodeDataPng(const Image8& image) {
  const auto bytes = EncodePng("data", image, Meaning::kData, kStrongLevel);
  if (!bytes.ok()) return bytes.error();
  return std::string(bytes.value().begin(), bytes.value().end());
}

Result<Image8> ReadPng(const std::string& path) {
  const Result<std::vector<unsigned char>> bytes = ReadImageBytes(path);
  if (!bytes.ok()) return bytes.error();
  if (bytes.value().size() < 8 || png_sig_cmp(bytes.value().data(), 0, 8) != 0)
    return Error{ErrorCode::kFormatUnknown, path + ": not a PNG image"};

  // The simplified interface of libpng converts palettes, grey images and 16-bit images to the requested
  // format.
  png_image reader;
  std::memset(&reader, 0, sizeof reader);
  reader.version = PNG_IMAGE_VERSION;
  struct Freed {
    png_image* reader;
    ~Freed() { png_image_free(reader); }
  } const freed{&reader};
  const auto broken = [&] { return Error{ErrorCode::kFormatBroken, path + ": " + reader.message}; };
  if (png_image_begin_read_from_memory(&reader, bytes.value().data(), bytes.value().size()) == 0)
    return broken();
  if (reader.width > kMaxImageSide || reader.height > kMaxImageSide)
    return Error{ErrorCode::kLimitExceeded, path + ": a side has more than 65536 pixels"};
  reader.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  const bool alpha = (reader.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  reader.format = alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  Image8 image;
  image.width = static_cast<int>(reader.width);
  image.height = static_cast<int>(reader.height);
  image.channels = alpha ? 4 : 3;
  try {
    image.bytes.resize(std::size_t{reader.width} * reader.height * static_cast<std::size_t>(image.channels));
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  }
  if (png_image_finish_read(&reader, nullptr, image.bytes.data(), 0, nullptr) == 0) return broken();
  return image;
}

Result<Image8> ReadPngSlice(const std::string& path, double threshold, std::uint64_t max_bytes) {
  Result<std::vector<unsigned char>> bytes = ReadImageBytes(path);
  if (!bytes.ok()) return bytes.error();
  if (bytes.value().size() < 8 || png_sig_cmp(bytes.value().data(), 0, 8) != 0)
    return Error{ErrorCode::kFormatUnknown, path + ": not a PNG image"};
  Slice slice;
  slice.bytes = std::move(bytes).value();
  slice.max_bytes = max_bytes;
  if (!Decode(slice)) {
    if (slice.too_large)
      return Error{ErrorCode::kLimitExceeded, path + ": needs more than " + std::to_string(max_bytes >> 20) +
                                                  " MB; raise --max-view-memory"};
    if (slice.failure == kOutOfMemory) return ImageTooLarge(path);
    return Error{ErrorCode::kFormatBroken, path + ": " + slice.failure};
  }
  Image8 image{static_cast<int>(slice.width), static_cast<int>(slice.height), 4, {}};
  try {
    image.bytes.resize(4 * slice.width * slice.height);
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  }
  const bool alpha = slice.channels == 2 || slice.channels == 4;
  const std::size_t width = slice.wide ? 2 : 1, colors = alpha ? slice.channels - 1 : slice.channels;
  std::uint8_t* to = image.bytes.data();
  for (std::size_t y = 0; y < slice.height; ++y)
    for (std::size_t x = 0; x < slice.width; ++x, to += 4) {
      // Numbers of 16 bits have their high byte first.
      const unsigned char* from = slice.rows[y] + x * slice.channels * width;
      const auto number = [&](std::size_t channel) {
        return slice.wide ? from[2 * channel] << 8 | from[2 * channel + 1] : from[channel];
      };
      bool filled = alpha && number(colors) > 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t channel = std::min(c, colors - 1);
        to[c] = from[channel * width];
        filled = filled || (!alpha && number(channel) > threshold);
      }
      to[3] = filled ? 255 : 0;
    }
  return image;
}

}  // namespace facetless
