// Reads and writes the pages of TIFF files with libtiff.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <new>

#include "render/image/codec.h"
#include "render/image/slice_pictures.h"
#include "render/image/tiff_handle.h"

namespace facetless {
namespace {

constexpr int kMostPages = 65536;
constexpr std::uint8_t kGrey = 178;

Tiff Open(const std::string& path, const char* mode, std::uint64_t max_bytes, std::string& failure) {
  const TiffOptions options = KeepFailures(&failure);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(),
                                      static_cast<tmsize_t>(std::min<std::uint64_t>(max_bytes, 1ULL << 40)));
  return Tiff(TIFFOpenExt(path.c_str(), mode, options.get()));
}

// What a page says of itself.
struct Page {
  std::uint32_t width = 0, height = 0;
  unsigned bits = 0, channels = 0, sample_format = 0, photometric = 0;
  bool alpha = false;

  explicit Page(TIFF* tiff)
      : width(TiffField<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH)),
        height(TiffField<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH)),
        bits(TiffField<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE)),
        channels(TiffField<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL)),
        sample_format(TiffField<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT)),
        photometric(TiffField<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC)),
        alpha(channels == 2 || channels == 4) {}

  std::size_t RowBytes(std::uint32_t pixels) const { return (std::size_t{pixels} * channels * bits + 7) / 8; }

  // What is not read of it; empty if it is read.
  std::string Unread(TIFF* tiff) const {
    const bool grey = photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE;
    if (!grey && photometric != PHOTOMETRIC_RGB)
      return "pages that are neither grey nor red, green and blue are not read";
    if (channels != (grey ? 1u : 3u) && channels != (grey ? 2u : 4u))
      return "pages with " + std::to_string(channels) + " channels are not read";
    if (channels > 1 && TiffField<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG) != PLANARCONFIG_CONTIG)
      return "pages whose channels lie one after the other are not read";
    const bool whole = sample_format == SAMPLEFORMAT_UINT || sample_format == SAMPLEFORMAT_INT ||
                       sample_format == SAMPLEFORMAT_VOID;
    if (!(whole && (bits == 1 || bits == 8 || bits == 16 || bits == 32)) &&
        !(sample_format == SAMPLEFORMAT_IEEEFP && bits == 32))
      return "samples of " + std::to_string(bits) +
             " bits are not read; whole numbers of 1, 8, 16 and 32 bits and float are";
    return "";
  }

  template <typename T>
  static double Load(const unsigned char* row, std::size_t index) {
    T number;
    std::memcpy(&number, row + index * sizeof(T), sizeof(T));
    return static_cast<double>(number);
  }
  // The number of a sample in a row.
  double Number(const unsigned char* row, std::size_t index) const {
    const bool is_signed = sample_format == SAMPLEFORMAT_INT;
    switch (bits) {
      case 1: {
        const unsigned bit = row[index / 8] >> (7 - index % 8) & 1u;
        return photometric == PHOTOMETRIC_MINISWHITE ? 1 - bit : bit;
      }
      case 8:
        return is_signed ? Load<std::int8_t>(row, index) : Load<std::uint8_t>(row, index);
      case 16:
        return is_signed ? Load<std::int16_t>(row, index) : Load<std::uint16_t>(row, index);
      default:
        return sample_format == SAMPLEFORMAT_IEEEFP ? Load<float>(row, index)
               : is_signed                          ? Load<std::int32_t>(row, index)
                                                    : Load<std::uint32_t>(row, index);
    }
  }
  std::uint8_t Color(double number) const {
    if (sample_format == SAMPLEFORMAT_INT || (bits != 8 && bits != 16)) return kGrey;
    return static_cast<std::uint8_t>(bits == 8 ? number : number / 256);
  }
};

// Reads all strips or tiles of a page into rows of the page's width.
bool ReadRows(TIFF* tiff, const Page& page, std::vector<unsigned char>& rows) {
  const bool tiled = TIFFIsTiled(tiff) != 0;
  const std::size_t stride = page.RowBytes(page.width);
  rows.assign(stride * page.height, 0);
  const std::uint32_t width = tiled ? TiffField<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH) : page.width;
  const std::uint32_t height =
      tiled ? TiffField<std::uint32_t>(tiff, TIFFTAG_TILELENGTH)
            : std::min(TiffField<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP), page.height);
  // The bits of a tile must begin at a byte of the page's row; the widths of tiles are multiples of 16.
  if (width == 0 || height == 0 || (tiled && width % 8 != 0)) return false;
  const std::size_t block_stride = page.RowBytes(width);
  const tmsize_t size = tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
  if (size <= 0 || static_cast<std::uint64_t>(size) < std::uint64_t{block_stride} * height) return false;
  std::vector<unsigned char> block(static_cast<std::size_t>(size));
  std::uint32_t index = 0;
  for (std::uint32_t y = 0; y < page.height; y += height)
    for (std::uint32_t x = 0; x < page.width; x += width, ++index) {
      const std::uint32_t count = std::min(height, page.height - y);
      const tmsize_t wanted = static_cast<tmsize_t>(block_stride * (tiled ? height : count));
      const tmsize_t got = tiled ? TIFFReadEncodedTile(tiff, index, block.data(), size)
                                 : TIFFReadEncodedStrip(tiff, index, block.data(), wanted);
      if (got < wanted) return false;
      const std::size_t at = page.RowBytes(x), bytes = std::min(block_stride, stride - at);
      for (std::uint32_t row = 0; row < count; ++row)
        std::memcpy(&rows[stride * (y + row) + at], &block[block_stride * row], bytes);
    }
  return true;
}

}  // namespace

struct TiffPages::File {
  std::string path, failure;
  Tiff tiff;
  int count = 0, next = 0;
};

TiffPages::TiffPages(std::unique_ptr<File> file) : file_(std::move(file)) {}
TiffPages::TiffPages(TiffPages&&) noexcept = default;
TiffPages::~TiffPages() = default;

int TiffPages::count() const {
  return file_->count;
}

Result<TiffPages> TiffPages::Open(const std::string& path, std::uint64_t max_bytes) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed))
    return Error{ErrorCode::kFileUnreadable,
                 path + ": " + (failed ? failed.message() : std::string("not a file"))};
  auto file = std::make_unique<File>();
  file->path = path;
  file->tiff = facetless::Open(path, "rm", max_bytes, file->failure);
  if (!file->tiff)
    return Error{ErrorCode::kFormatUnknown,
                 path + ": is no TIFF file that can be read (" + file->failure + ")"};
  const auto pages = static_cast<std::int64_t>(TIFFNumberOfDirectories(file->tiff.get()));
  if (!file->failure.empty())
    return Error{ErrorCode::kFormatBroken, path + ": its pages cannot be counted: " + file->failure};
  if (pages > kMostPages)
    return Error{ErrorCode::kLimitExceeded, path + ": has more than 65536 pages; use fewer slices"};
  file->count = static_cast<int>(pages);
  return TiffPages(std::move(file));
}

Result<Image8> TiffPages::Next(double threshold, std::uint64_t max_bytes) {
  File& file = *file_;
  TIFF* tiff = file.tiff.get();
  const std::string name = file.path + ": page " + std::to_string(file.next + 1);
  const auto broken = [&](const std::string& what) {
    return Error{ErrorCode::kFormatBroken, name + ": " + what};
  };
  file.failure.clear();
  if (file.next > 0 && TIFFReadDirectory(tiff) == 0)
    return broken(file.failure.empty() ? "is missing" : file.failure);
  ++file.next;
  const Page page(tiff);
  if (page.width < 1 || page.height < 1 || page.width > kMaxImageSide || page.height > kMaxImageSide)
    return broken("each side must have 1 to 65536 pixels");
  if (const std::string unread = page.Unread(tiff); !unread.empty()) return broken(unread);
  constexpr std::size_t kImageBytes = 4;
  if ((static_cast<double>(page.RowBytes(page.width)) + double{kImageBytes} * page.width) * page.height >
      static_cast<double>(max_bytes))
    return Error{ErrorCode::kLimitExceeded, name + ": needs more than " + std::to_string(max_bytes >> 20) +
                                                " MB; raise --max-view-memory"};
  Image8 image{static_cast<int>(page.width), static_cast<int>(page.height), 4, {}};
  try {
    std::vector<unsigned char> rows;
    if (!ReadRows(tiff, page, rows))
      return broken(file.failure.empty() ? "its blocks do not match its size" : file.failure);
    image.bytes.resize(std::size_t{page.width} * page.height * kImageBytes);
    std::uint8_t* to = image.bytes.data();
    const std::size_t colors = page.alpha ? page.channels - 1 : page.channels;
    for (std::uint32_t y = 0; y < page.height; ++y) {
      const unsigned char* row = rows.data() + page.RowBytes(page.width) * y;
      for (std::uint32_t x = 0; x < page.width; ++x, to += kImageBytes) {
        bool filled = false;
        for (std::size_t c = 0; c < 3; ++c) {
          const double number = page.Number(row, std::size_t{x} * page.channels + std::min(c, colors - 1));
          to[c] = page.Color(number);
          filled = filled || number > threshold;
        }
        if (page.alpha) filled = page.Number(row, std::size_t{x} * page.channels + colors) > 0;
        to[3] = filled ? 255 : 0;
      }
    }
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(name);
  }
  return image;
}

struct TiffPageWriter::File {
  std::string path, partial, failure;
  Tiff tiff;
  int next = 0;
  bool finished = false;
};

TiffPageWriter::TiffPageWriter(std::unique_ptr<File> file) : file_(std::move(file)) {}
TiffPageWriter::TiffPageWriter(TiffPageWriter&&) noexcept = default;
TiffPageWriter::~TiffPageWriter() {
  if (!file_ || file_->finished) return;
  file_->tiff.reset();
  std::remove(file_->partial.c_str());
}

Result<TiffPageWriter> TiffPageWriter::Open(const std::string& path, double pixels) {
  auto file = std::make_unique<File>();
  file->path = path;
  file->partial = path + ".partial";
  // A classic file has offsets of 32 bits. Compression makes pages no more than slightly larger.
  constexpr double kMostClassic = 3e9;
  file->tiff =
      facetless::Open(file->partial, 4 * pixels > kMostClassic ? "w8l" : "wl", 1ULL << 40, file->failure);
  if (!file->tiff) return Error{ErrorCode::kWriteFailed, path + ": cannot be written: " + file->failure};
  return TiffPageWriter(std::move(file));
}

Result<void> TiffPageWriter::Add(const Image8& slice) {
  File& file = *file_;
  TIFF* tiff = file.tiff.get();
  const auto set = [&](std::uint32_t tag, auto... values) { TIFFSetField(tiff, tag, values...); };
  set(TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(slice.width));
  set(TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(slice.height));
  set(TIFFTAG_SUBFILETYPE, std::uint32_t{FILETYPE_PAGE});
  set(TIFFTAG_BITSPERSAMPLE, 8);
  set(TIFFTAG_SAMPLESPERPIXEL, 4);
  const std::uint16_t extra[] = {EXTRASAMPLE_UNASSALPHA};
  set(TIFFTAG_EXTRASAMPLES, 1, extra);
  set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  set(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  set(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  set(TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  set(TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(slice.height));
  // libtiff does not change the pixels, since no predictor is set.
  void* pixels = const_cast<std::uint8_t*>(slice.bytes.data());
  if (TIFFWriteEncodedStrip(tiff, 0, pixels, static_cast<tmsize_t>(slice.bytes.size())) < 0 ||
      TIFFWriteDirectory(tiff) == 0)
    return Error{ErrorCode::kWriteFailed, file.path + ": cannot be written: " + file.failure};
  ++file.next;
  return {};
}

Result<void> TiffPageWriter::Finish() {
  File& file = *file_;
  file.tiff.reset();
  if (!file.failure.empty() || std::rename(file.partial.c_str(), file.path.c_str()) != 0)
    return Error{
        ErrorCode::kWriteFailed,
        file.path + ": cannot be written: " +
            (file.failure.empty() ? "the directory is absent, permission is missing, or the disk is full"
                                  : file.failure)};
  file.finished = true;
  return {};
}

}  // namespace facetless
