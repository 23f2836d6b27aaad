// Contrast: what has it and what does not, for pictures of any size.
#include "render/shade/contrast.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "render/shade/shade.h"

namespace facetless {
namespace {

Film FilmOf(int width, int height, const std::function<float(int x, int y)>& root) {
  Film film;
  film.width = width;
  film.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float light = root(x, y) * root(x, y);
      film.pixels.push_back({light, light, light, 1});
    }
  return film;
}

PixelSet ContrastOf(const Film& film) {
  PixelSet pixels(film.width, film.height);
  AddContrast(film, &pixels);
  pixels.Finish();
  return pixels;
}

TEST(Contrast, AGradientHasNone) {
  rc::check([] {
    const int width = *rc::gen::inRange(1, 90), height = *rc::gen::inRange(1, 90);
    const float across = *rc::gen::inRange(-50, 50) * 1e-4f, down = *rc::gen::inRange(-50, 50) * 1e-4f;
    const PixelSet pixels =
        ContrastOf(FilmOf(width, height, [&](int x, int y) { return 0.5f + across * x + down * y; }));
    // At the border, the picture is continued flat.
    RC_ASSERT(pixels.size() == 0u);
  });
}

TEST(Contrast, AStepHasItOnBothSidesAndNowhereElse) {
  rc::check([] {
    const int width = *rc::gen::inRange(2, 130), height = *rc::gen::inRange(2, 40);
    const int at = *rc::gen::inRange(1, width);
    const bool upright = *rc::gen::arbitrary<bool>();
    const float step = 0.03f + *rc::gen::inRange(0, 60) * 0.01f;
    const Film film = upright
                          ? FilmOf(width, height, [&](int x, int) { return x < at ? 0.2f : 0.2f + step; })
                          : FilmOf(height, width, [&](int, int y) { return y < at ? 0.2f : 0.2f + step; });
    const PixelSet pixels = ContrastOf(film);
    for (int y = 0; y < film.height; ++y)
      for (int x = 0; x < film.width; ++x) {
        const int along = upright ? x : y;
        RC_ASSERT(pixels.Has(x, y) == (along == at || along == at - 1));
      }
  });
}

TEST(Contrast, ASinglePixelGivesItToItsNeighbours) {
  const PixelSet pixels =
      ContrastOf(FilmOf(9, 7, [](int x, int y) { return x == 4 && y == 3 ? 0.9f : 0.1f; }));
  EXPECT_EQ(pixels.size(), 9u);
  EXPECT_TRUE(pixels.Has(3, 2) && pixels.Has(5, 4) && pixels.Has(4, 3));
}

TEST(Contrast, CountsAlphaAndDarkColours) {
  Film film = FilmOf(8, 1, [](int, int) { return 0.0f; });
  film.pixels[4][3] = 0;
  EXPECT_EQ(ContrastOf(film).size(), 3u);
  // Five levels of 255 near black, where linear light differs by little.
  const PixelSet dark = ContrastOf(FilmOf(8, 1, [](int x, int) { return x < 4 ? 0.0f : 6.0f / 255; }));
  EXPECT_EQ(dark.size(), 2u);
}

// Refined pixels have the bytes that Resolve makes from all samples.
TEST(ShadeRefinement, GivesTheBytesOfResolve) {
  rc::check([] {
    const SampleGrid grid{*rc::gen::inRange(1, 5), *rc::gen::inRange(1, 5)};
    const int width = *rc::gen::inRange(1, 20), height = *rc::gen::inRange(1, 20);
    Camera camera;
    camera.eye = {0, -10, 0};
    camera.up = {0, 0, 1};
    camera.projection = *rc::gen::element(Projection::kOrthographic, Projection::kPerspective);
    camera.height = height;
    camera.width_px = width;
    camera.height_px = height;
    const Camera fine = camera.Supersampled(grid.x, grid.y);
    const CameraFrame frame = MakeFrame(fine, 1).value();
    SampleBuffer all;
    all.Resize(fine.width_px, fine.height_px);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (*rc::gen::inRange(0, 4) == 0) continue;
      const double angle = *rc::gen::inRange(0, 628) * 0.01;
      all.depth[i] = 10;
      all.normal[i] = {static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0};
      all.face[i] = static_cast<std::uint32_t>(*rc::gen::inRange(0, 3));
    }
    const std::vector<Color> colors = {{0.8f, 0.2f, 0.1f}, {0.1f, 0.3f, 0.9f}};
    ShadeOptions options;
    options.samples_x = grid.x;
    options.samples_y = grid.y;
    const Film expected = Resolve(Shade(all, frame, colors, options).value(), grid.x, grid.y).value();

    Refinement refinement{grid, frame, PixelSet(width, height), {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (*rc::gen::arbitrary<bool>()) refinement.pixels.Add(x, y);
    refinement.pixels.Finish();
    refinement.samples.Resize(grid.count(), static_cast<int>(refinement.pixels.size()));
    for (std::size_t i = 0; i < refinement.samples.size(); ++i) {
      const auto count = static_cast<std::size_t>(grid.count());
      const SamplePlace at =
          PlaceOfSample(refinement.pixels.pixels()[i / count], width, grid, static_cast<int>(i % count));
      const std::size_t j = static_cast<std::size_t>(at.row) * all.width + at.column;
      refinement.samples.depth[i] = all.depth[j];
      refinement.samples.normal[i] = all.normal[j];
      refinement.samples.face[i] = all.face[j];
    }
    Film film;
    film.width = width;
    film.height = height;
    film.pixels.assign(static_cast<std::size_t>(width) * height, {-1, -1, -1, -1});
    RC_ASSERT(ShadeRefinement(refinement, colors, options, &film).ok());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * width + x;
        RC_ASSERT(film.pixels[i] ==
                  (refinement.pixels.Has(x, y) ? expected.pixels[i] : std::array<float, 4>{-1, -1, -1, -1}));
      }
  });
}

TEST(ShadeRefinement, RefusesAnotherSize) {
  Refinement refinement{{2, 2}, {}, PixelSet(4, 4), {}};
  refinement.pixels.Finish();
  Film film;
  film.width = 5;
  film.height = 4;
  EXPECT_EQ(ShadeRefinement(refinement, {}, {}, &film).error().code, ErrorCode::kSizeMismatch);
}

}  // namespace
}  // namespace facetless
