// Contact sheets.
#include "render/image/sheet.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace facetless {
namespace {

Image8 Plain(int width, int height, std::vector<std::uint8_t> pixel) {
  Image8 image{width, height, static_cast<int>(pixel.size()), {}};
  for (int i = 0; i < width * height; ++i) image.bytes.insert(image.bytes.end(), pixel.begin(), pixel.end());
  return image;
}

TEST(Reduced, IsTheMeanInLinearLight) {
  // Alternating black and white has half of the light, which is 188 in sRGB.
  Image8 stripes = Plain(64, 32, {0, 0, 0});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; x += 2)
      for (int c = 0; c < 3; ++c) stripes.at(x, y)[c] = 255;
  const Image8 reduced = Reduced(stripes, 16).value();
  EXPECT_EQ(reduced.width, 16);
  EXPECT_EQ(reduced.height, 8);
  for (const std::uint8_t byte : reduced.bytes) EXPECT_EQ(byte, 188);
}

TEST(Reduced, NeverEnlargesAndPutsTransparencyOnPaper) {
  const Image8 small = Plain(7, 5, {10, 200, 30});
  EXPECT_EQ(Reduced(small, 480).value().bytes, small.bytes);
  const Image8 paper = Reduced(Plain(7, 5, {10, 200, 30, 0}), 480).value();
  EXPECT_EQ(paper.channels, 3);
  EXPECT_GT(paper.at(3, 3)[0], 240);
  EXPECT_FALSE(Reduced(Image8{}, 480).ok());
}

TEST(Reduced, KeepsTheLightOfSizesThatDontDivide) {
  const Image8 even = Reduced(Plain(1000, 333, {90, 120, 150}), 480).value();
  EXPECT_EQ(even.width, 480);
  EXPECT_EQ(even.height, 160);
  for (int x = 0; x < 480; ++x) EXPECT_NEAR(even.at(x, 100)[0], 90, 1);
}

TEST(Sheet, HasEveryPictureInItsPlaceWithALabel) {
  std::vector<SheetTile> tiles;
  for (int i = 0; i < 5; ++i)
    tiles.push_back({Plain(60, i == 0 ? 40 : 20, {static_cast<std::uint8_t>(50 * i), 0, 0}), "view"});
  const Image8 sheet = DrawSheet(tiles, 3).value();
  EXPECT_EQ(sheet.width, 16 + 3 * (60 + 16));
  EXPECT_EQ(sheet.height, 16 + 2 * (40 + 34));
  // Read the middle of each tile.
  for (int i = 0; i < 5; ++i) EXPECT_EQ(sheet.at(16 + i % 3 * 76 + 30, 16 + i / 3 * 74 + 20)[0], 50 * i) << i;
  EXPECT_GT(sheet.at(16 + 2 * 76 + 30, 16 + 74 + 20)[0], 240) << "the sixth place is empty";
  int ink = 0;
  for (int y = 56; y < 90; ++y)
    for (int x = 16; x < 76; ++x) ink += sheet.at(x, y)[0] < 128;
  EXPECT_GT(ink, 20) << "the label of the first";
}

TEST(Sheet, IsAboutSquare) {
  EXPECT_EQ(SheetColumns(1), 1);
  EXPECT_EQ(SheetColumns(2), 2);
  EXPECT_EQ(SheetColumns(4), 2);
  EXPECT_EQ(SheetColumns(5), 3);
  EXPECT_EQ(SheetColumns(11), 4);
  EXPECT_FALSE(DrawSheet({}, 1).ok());
  EXPECT_EQ(DrawSheet(std::vector<SheetTile>(200, {Plain(1, 480, {0, 0, 0}), ""}), 1).error().code,
            ErrorCode::kLimitExceeded);
}

}  // namespace
}  // namespace facetless
