// Reads Radiance RGBE files. Source: G. Ward, "Real Pixels", Graphics Gems II (1991). A pixel has three mantissas and a
// common exponent. In a row, either the four components follow each other, each packed by runs, or the pixels do,
// some of which may repeat the pixel before them.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <new>
#include <string_view>

#include "render/image/codec.h"
#include "render/image/radiance_map.h"

namespace facetless {
namespace {

using Pixel = std::array<unsigned char, 4>;

// Reads bytes one after the other. Beyond the end, Next returns 0, and good() is false from then on.
class Bytes {
 public:
  explicit Bytes(const std::vector<unsigned char>& bytes) : bytes_(bytes) {}
  bool good() const { return good_; }
  unsigned char Next() {
    if (at_ < bytes_.size()) return bytes_[at_++];
    good_ = false;
    return 0;
  }
  // Reads the rest of a line, and returns it without the character that ends it.
  std::string Line() {
    std::string line;
    while (at_ < bytes_.size() && bytes_[at_] != '\n') line += static_cast<char>(bytes_[at_++]);
    good_ = good_ && at_ < bytes_.size();
    ++at_;
    return line;
  }

 private:
  const std::vector<unsigned char>& bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

// Parses "-Y HEIGHT +X WIDTH". This is the usual order of the pixels; files with another order are not read.
bool ParseSize(std::string_view line, int* width, int* height) {
  const auto take = [&](std::string_view word, int* number) {
    if (!line.starts_with(word)) return false;
    line.remove_prefix(word.size());
    const auto parsed = std::from_chars(line.data(), line.data() + line.size(), *number);
    if (parsed.ec != std::errc{} || *number < 1) return false;
    line.remove_prefix(static_cast<std::size_t>(parsed.ptr - line.data()));
    return true;
  };
  return take("-Y ", height) && take(" +X ", width) && line.empty();
}

// Reads a row whose four components follow each other, each packed by runs.
bool ReadPackedRow(Bytes& bytes, std::vector<Pixel>& row) {
  constexpr int kRun = 128;  // a count above it starts a run of count − kRun equal values
  for (std::size_t component = 0; component < 4; ++component) {
    for (std::size_t x = 0; x < row.size();) {
      int count = bytes.Next();
      const bool run = count > kRun;
      if (run) count -= kRun;
      if (count == 0 || static_cast<std::size_t>(count) > row.size() - x) return false;
      unsigned char value = run ? bytes.Next() : 0;
      for (int k = 0; k < count; ++k, ++x) row[x][component] = run ? value : bytes.Next();
      if (!bytes.good()) return false;
    }
  }
  return true;
}

bool ReadRow(Bytes& bytes, std::vector<Pixel>& row) {
  Pixel first;
  for (unsigned char& byte : first) byte = bytes.Next();
  // A packed row begins with 2, 2 and its length.
  if (first[0] == 2 && first[1] == 2 && (std::size_t{first[2]} << 8 | first[3]) == row.size())
    return ReadPackedRow(bytes, row);
  // In other rows, the pixel 1, 1, 1, N says that the pixel before it follows N more times. If several of them follow each
  // other, each counts 256 times as much as the one before it.
  Pixel pixel = first;
  unsigned digit = 0;
  for (std::size_t x = 0; x < row.size();) {
    if (x > 0)
      for (unsigned char& byte : pixel) byte = bytes.Next();
    if (!bytes.good()) return false;
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      row[x++] = pixel;
      digit = 0;
      continue;
    }
    constexpr unsigned kMostDigits = 4;
    if (x == 0 || digit == kMostDigits) return false;
    const std::size_t count = std::size_t{pixel[3]} << (8 * digit++);
    if (count > row.size() - x) return false;
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), count, row[x - 1]);
    x += count;
  }
  return true;
}

}  // namespace

Result<RadianceMap> DecodeRgbe(const std::string& path, const std::vector<unsigned char>& bytes) {
  const auto broken = [&](const char* what) { return Error{ErrorCode::kFormatBroken, path + ": " + what}; };
  Bytes reader(bytes);
  double exposure = 1;
  for (std::string line = reader.Line(); !line.empty() && reader.good(); line = reader.Line()) {
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      return broken("only the format 32-bit_rle_rgbe can be read");
    // A file may state several exposures, which are multiplied.
    if (line.starts_with("EXPOSURE=")) exposure *= std::strtod(line.c_str() + 9, nullptr);
  }
  RadianceMap map;
  if (!reader.good() || !ParseSize(reader.Line(), &map.width, &map.height))
    return broken("the line with the size is missing, or is not -Y HEIGHT +X WIDTH");
  if (!(exposure > 0 && std::isfinite(exposure))) return broken("the exposure is not a number above 0");
  if (std::int64_t{map.width} * map.height > kMostRadiancePixels)
    return Error{ErrorCode::kLimitExceeded, path + ": the panorama has too many pixels for an environment"};
  // Each row takes at least one byte.
  if (bytes.size() < static_cast<std::size_t>(map.height)) return broken("the file ends too early");
  try {
    map.pixels.reserve(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
    std::vector<Pixel> row(static_cast<std::size_t>(map.width));
    for (int y = 0; y < map.height; ++y) {
      if (!ReadRow(reader, row)) return broken("a row is broken, or the file ends too early");
      for (const Pixel& pixel : row) {
        constexpr int kBias = 128 + 8;
        const double scale = pixel[3] == 0 ? 0 : std::ldexp(1.0, pixel[3] - kBias) / exposure;
        map.pixels.push_back({static_cast<float>(pixel[0] * scale), static_cast<float>(pixel[1] * scale),
                              static_cast<float>(pixel[2] * scale)});
      }
    }
  } catch (const std::bad_alloc&) {
    return ImageTooLarge(path);
  }
  return map;
}

}  // namespace facetless
