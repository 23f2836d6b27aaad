#include "render/image/sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "render/image/codec.h"
#include "render/image/paint.h"
#include "render/image/text.h"

namespace facetless {
namespace {

constexpr Rgb8 kPaper = {250, 249, 246}, kInk = {40, 40, 44};
constexpr int kGap = 16, kLabelHeight = 34;
constexpr double kLabelSize = 15;

// The linear light of each byte value.
const std::array<double, 256>& Linear() {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> light;
    for (int byte = 0; byte < 256; ++byte) light[byte] = SrgbToLinear(byte / 255.0);
    return light;
  }();
  return table;
}

std::array<double, 3> OnPaper(const std::uint8_t* pixel, int channels) {
  const double alpha = channels == 4 ? pixel[3] / 255.0 : 1;
  std::array<double, 3> light;
  for (int c = 0; c < 3; ++c) light[c] = alpha * Linear()[pixel[c]] + (1 - alpha) * Linear()[kPaper[c]];
  return light;
}

// The old pixels that a new pixel covers: the index of the first one, and the shares, which sum to 1.
struct Cover {
  int first = 0;
  std::vector<double> shares;
};
std::vector<Cover> Covers(int old_count, int count) {
  std::vector<Cover> covers(static_cast<std::size_t>(count));
  const double step = static_cast<double>(old_count) / count;
  for (int i = 0; i < count; ++i) {
    const double begin = i * step, end = std::min((i + 1) * step, static_cast<double>(old_count));
    Cover& cover = covers[i];
    cover.first = std::min(static_cast<int>(begin), old_count - 1);
    for (int old = cover.first; old < old_count && old < end; ++old)
      cover.shares.push_back((std::min(end, old + 1.0) - std::max(begin, static_cast<double>(old))) / step);
  }
  return covers;
}

Image8 Blank(int width, int height) {
  Image8 image{width, height, 3, {}};
  image.bytes.resize(static_cast<std::size_t>(width) * height * 3);
  for (std::size_t i = 0; i < image.bytes.size(); ++i) image.bytes[i] = kPaper[i % 3];
  return image;
}

void Label(Image8& sheet, int left, int top, int width, const std::string& words) {
  TextStyle style;
  style.size_px = kLabelSize;
  std::copy(kInk.begin(), kInk.end(), style.color);
  // Write a long name smaller.
  const double full = TextWidth(words, style);
  if (full > width) style.size_px *= width / full;
  DrawText(sheet, left + 0.5 * (width - std::min(full, static_cast<double>(width))), top + 1.5 * kLabelSize,
           words, style);
}

}  // namespace

Result<Image8> Reduced(const Image8& picture, int most) {
  const int side = std::max(picture.width, picture.height);
  if (side < 1) return Error{ErrorCode::kBadUsage, "a picture of the contact sheet has no pixels"};
  const double scale = std::min(1.0, static_cast<double>(most) / side);
  const int width = std::max(1, static_cast<int>(std::round(picture.width * scale)));
  const int height = std::max(1, static_cast<int>(std::round(picture.height * scale)));
  const std::vector<Cover> columns = Covers(picture.width, width), rows = Covers(picture.height, height);
  Image8 reduced = Blank(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::array<double, 3> light = {0, 0, 0};
      for (std::size_t j = 0; j < rows[y].shares.size(); ++j)
        for (std::size_t i = 0; i < columns[x].shares.size(); ++i) {
          const auto pixel =
              OnPaper(picture.at(columns[x].first + static_cast<int>(i), rows[y].first + static_cast<int>(j)),
                      picture.channels);
          const double share = rows[y].shares[j] * columns[x].shares[i];
          for (int c = 0; c < 3; ++c) light[c] += share * pixel[c];
        }
      for (int c = 0; c < 3; ++c) reduced.at(x, y)[c] = EncodeByte(static_cast<float>(light[c]));
    }
  return reduced;
}

int SheetColumns(std::size_t count) {
  int columns = 1;
  while (static_cast<std::size_t>(columns) * columns < count) ++columns;
  return columns;
}

Result<Image8> DrawSheet(const std::vector<SheetTile>& tiles, int columns) {
  if (tiles.empty() || columns < 1) return Error{ErrorCode::kBadUsage, "the contact sheet has no pictures"};
  int width = 0, height = 0;
  for (const SheetTile& tile : tiles) {
    width = std::max(width, tile.picture.width);
    height = std::max(height, tile.picture.height);
  }
  const std::int64_t rows = (static_cast<std::int64_t>(tiles.size()) + columns - 1) / columns;
  const std::int64_t sheet_width = kGap + std::int64_t{columns} * (width + kGap);
  const std::int64_t sheet_height = kGap + rows * (height + kLabelHeight);
  if (std::max(sheet_width, sheet_height) > kMaxImageSide)
    return Error{ErrorCode::kLimitExceeded, "the contact sheet would have more than 65536 pixels on a side"};
  Image8 sheet = Blank(static_cast<int>(sheet_width), static_cast<int>(sheet_height));
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const Image8& picture = tiles[i].picture;
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    const int left = kGap + column * (width + kGap), top = kGap + row * (height + kLabelHeight);
    const int x0 = left + (width - picture.width) / 2, y0 = top + (height - picture.height) / 2;
    for (int y = 0; y < picture.height; ++y)
      std::copy_n(picture.at(0, y), static_cast<std::size_t>(picture.width) * 3, sheet.at(x0, y0 + y));
    Label(sheet, left, top + height, width, tiles[i].label);
  }
  return sheet;
}

}  // namespace facetless
