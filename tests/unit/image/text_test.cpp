#include "render/image/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace facetless {
namespace {

Image8 Paper(int width, int height) {
  return {width, height, 3, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3, 255)};
}

int InkCount(const Image8& image) {
  return static_cast<int>(
      std::count_if(image.bytes.begin(), image.bytes.end(), [](std::uint8_t b) { return b < 128; }));
}

TEST(Text, KnowsWhatItCanDraw) {
  EXPECT_TRUE(CanDraw("0123456789 abcdefghijklmnopqrstuvwxyz ABCDEFGHIJKLMNOPQRSTUVWXYZ µ.,:-_−+±×/%()"));
  EXPECT_FALSE(CanDraw("Größe"));
  EXPECT_FALSE(CanDraw("\xff\xfe"));
}

TEST(Text, EveryGlyphLeavesInkAndNoTwoLookAlike) {
  const std::string glyphs[] = {
      "0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "a", "b", "c", "d", "e", "f", "g", "h", "i",
      "j", "k", "l", "m", "n", "o", "p", "q", "r", "s", "t", "u", "v", "w", "x", "y", "z", "A", "B",
      "C", "D", "E", "F", "G", "H", "I", "J", "K", "L", "M", "N", "O", "P", "Q", "R", "S", "T", "U",
      "V", "W", "X", "Y", "Z", "µ", "_", ".", ",", ":", "-", "−", "+", "±", "×", "/", "%", "(", ")"};
  std::vector<Image8> drawn;
  for (const std::string& glyph : glyphs) {
    Image8 image = Paper(40, 60);
    DrawText(image, 8, 40, glyph, {.size_px = 30});
    EXPECT_GT(InkCount(image), 10) << glyph;
    for (const Image8& other : drawn) EXPECT_NE(image.bytes, other.bytes) << glyph;
    drawn.push_back(std::move(image));
  }
}

TEST(Text, WidthIsWhereTheInkEnds) {
  const TextStyle style{.size_px = 24};
  const std::string words = "depth 0.05";
  Image8 image = Paper(400, 60);
  DrawText(image, 20, 40, words, style);
  int left = 400, right = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 400; ++x)
      if (image.at(x, y)[0] < 128) {
        left = std::min(left, x);
        right = std::max(right, x);
      }
  EXPECT_NEAR(left, 20, 4);
  EXPECT_NEAR(right, 20 + TextWidth(words, style), 4);
}

TEST(Text, CoversWhatIsTransparent) {
  Image8 image{40, 60, 4, std::vector<std::uint8_t>(40 * 60 * 4, 0)};
  DrawText(image, 8, 40, "I", {.size_px = 30, .weight = 0.2});
  int opaque = 0, between = 0;
  for (int i = 0; i < 40 * 60; ++i) {
    const std::uint8_t* pixel = &image.bytes[static_cast<std::size_t>(i) * 4];
    opaque += pixel[3] == 255;
    between += pixel[3] > 0 && pixel[3] < 255;
    if (pixel[3] > 0) {
      EXPECT_NEAR(pixel[0], 40, 1) << "nothing of what is transparent shines through";
    }
  }
  EXPECT_GT(opaque, 100);
  EXPECT_GT(between, 20);
}

TEST(Text, IsCutAtTheBorder) {
  // Draw a digit as tall as the picture that begins to the left of it and above it. There must be ink in the
  // first row and column, and no write outside the picture.
  Image8 image = Paper(10, 10);
  DrawText(image, -10, 12, "0", {.size_px = 20});
  EXPECT_GT(InkCount(image), 0);
  EXPECT_EQ(image.bytes.size(), 300u);
  Image8 clean = Paper(10, 10);
  DrawText(clean, 5, 500, "x", {});
  EXPECT_EQ(clean.bytes, Paper(10, 10).bytes);
}

}  // namespace
}  // namespace facetless
