// Scale bars and axes.
#include "render/image/overlay.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace facetless {
namespace {

Image8 Blank(int width, int height, int channels, std::uint8_t value) {
  return {width, height, channels,
          std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * channels, value)};
}

CameraFrame Frame(const char* view, int width, int height, double window_mm,
                  Projection projection = Projection::kOrthographic) {
  Box3 box;
  box.Add({-1, -1, -1});
  box.Add({1, 1, 1});
  Camera camera = NamedView(view, box, projection, width, height).value();
  if (projection == Projection::kOrthographic) camera.height = window_mm;
  return MakeFrame(camera, box.diagonal()).value();
}

bool IsInk(const std::uint8_t* p) {
  return p[0] < 60 && p[1] < 60 && p[2] < 60;
}

// Returns the longest run of dark pixels in any row.
int LongestRun(const Image8& image) {
  int longest = 0;
  for (int y = 0; y < image.height; ++y) {
    int run = 0;
    for (int x = 0; x < image.width; ++x) {
      run = IsInk(image.at(x, y)) ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  return longest;
}

TEST(ScaleBar, IsTheLongestOfOneTwoFiveWithItsUnit) {
  const struct {
    double most;
    double length;
    const char* label;
  } table[] = {{1, 1, "1 mm"},         {1.99, 1, "1 mm"},    {2, 2, "2 mm"},          {49, 20, "20 mm"},
               {50, 50, "50 mm"},      {999, 500, "500 mm"}, {1000, 1000, "1 m"},     {7e5, 5e5, "500 m"},
               {3e6, 2e6, "2 km"},     {0.3, 0.2, "200 µm"}, {0.0012, 0.001, "1 µm"}, {6e-4, 5e-4, "500 nm"},
               {3e-7, 2e-7, "2e-1 nm"}};
  for (const auto& [most, length, label] : table) {
    const ScaleBar bar = LongestScaleBar(most);
    EXPECT_NEAR(bar.length_mm / length, 1, 1e-14) << most;
    EXPECT_EQ(bar.label, label) << most;
  }
}

TEST(ScaleBar, IsAsLongInThePictureAsItSays) {
  for (const auto& [width, height] : {std::pair{96, 96}, {640, 480}, {1024, 1024}, {2000, 300}}) {
    for (const double window : {0.37, 12.0, 4321.0}) {
      Image8 image = Blank(width, height, 3, 235);
      const CameraFrame frame = Frame("front", width, height, window);
      DrawOverlay(image, height, frame, {.scale_bar = true});
      const double length = LongestScaleBar(0.25 * width * frame.pixel_x).length_mm / frame.pixel_x;
      EXPECT_NEAR(LongestRun(image), length, 0.5 + 1e-9) << width << "×" << height << ", " << window;
    }
  }
}

TEST(ScaleBar, IsNotDrawnInPerspective) {
  Image8 image = Blank(200, 200, 3, 235);
  DrawOverlay(image, 200, Frame("front", 200, 200, 0, Projection::kPerspective), {.scale_bar = true});
  EXPECT_EQ(image.bytes, Blank(200, 200, 3, 235).bytes);
}

// Returns the mean position of the pixels in the axis's colour, relative to the common dot.
Vec2 MeanOf(const Image8& image, int channel) {
  Vec2 sum;
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.at(x, y);
      const int other = std::max(p[(channel + 1) % 3], p[(channel + 2) % 3]);
      if (p[channel] < other + 60) continue;
      sum = sum + Vec2{x + 0.5, y + 0.5};
      ++count;
    }
  return count > 0 ? (1.0 / count) * sum : Vec2{-1, -1};
}

TEST(Axes, PointWhereTheModelsAxesDo) {
  for (const std::uint8_t paper : {235, 20}) {
    Image8 front = Blank(400, 400, 3, paper);
    DrawOverlay(front, 400, Frame("front", 400, 400, 3), {.axes = true});
    const Vec2 x = MeanOf(front, 0), y = MeanOf(front, 1), z = MeanOf(front, 2);
    EXPECT_GT(x.x, y.x + 10) << "X to the right";
    EXPECT_NEAR(x.y, z.y + (x.x - z.x), 12) << "as far as Z upwards";
    EXPECT_LT(z.y, x.y - 10) << "Z upwards";
    EXPECT_LT(x.x, 200) << "on the left of the picture";
    EXPECT_GT(z.y, 200) << "and low";
  }
}

TEST(Overlay, CoversTransparencyAndLeavesTheRestAsItWas) {
  Image8 image = Blank(400, 300, 4, 0);
  DrawOverlay(image, 300, Frame("iso", 400, 300, 3), {.axes = true, .scale_bar = true});
  int opaque = 0;
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 400; ++x) EXPECT_EQ(image.at(x, y)[3], 0);
  for (int y = 150; y < 300; ++y)
    for (int x = 0; x < 400; ++x) opaque += image.at(x, y)[3] == 255;
  EXPECT_GT(opaque, 200);
}

TEST(Overlay, NeedsRoom) {
  Image8 image = Blank(95, 400, 3, 235);
  DrawOverlay(image, 400, Frame("iso", 95, 400, 3), {.axes = true, .scale_bar = true});
  EXPECT_EQ(image.bytes, Blank(95, 400, 3, 235).bytes);
}

TEST(Overlay, StaysOutOfALegendBelowTheView) {
  Image8 image = Blank(400, 500, 3, 235);
  DrawOverlay(image, 400, Frame("iso", 400, 400, 3), {.axes = true, .scale_bar = true});
  for (int y = 400; y < 500; ++y)
    for (int x = 0; x < 400; ++x) EXPECT_EQ(image.at(x, y)[0], 235);
}

}  // namespace
}  // namespace facetless
