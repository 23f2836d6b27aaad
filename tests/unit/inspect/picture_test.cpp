// The content of the pictures, and that their bytes are the same everywhere.
#include "render/inspect/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "render/inspect/stripes.h"
#include "render/kernels/dispatch.h"
#include "tests/support/shapes.h"
#include "tests/unit/inspect/joined.h"
#include "tests/unit/inspect/traced.h"

namespace facetless {
namespace {

using testing::Join;
using testing::Joined;
using testing::ModelOf;
using testing::Traced;

// Returns whether a pixel is dark. Only for black and white patterns.
bool Dark(const Film& film, std::size_t i) {
  return film.pixels[i][0] < 0.3f;
}

// Returns the share of rows in which the pixels on the left and on the right of the join have different
// stripes.
double BrokenShare(const Join& join) {
  Camera camera;
  camera.eye = {2, 2, 6};
  camera.target = {0, 2, 0};
  camera.projection = Projection::kPerspective;
  camera.fov_y_deg = 45;
  camera.width_px = camera.height_px = 400;
  const Traced traced(Joined(join), camera);
  const Film film = traced.Drawn("zebra:stripes=60,axis=1,2,0");
  int rows = 0, broken = 0;
  for (std::size_t y = 0; y < 400; ++y)
    for (std::size_t x = 0; x + 1 < 400; ++x) {
      const std::size_t i = 400 * y + x;
      if (!traced.Hit(i) || !traced.Hit(i + 1)) continue;
      if (traced.result.samples.face[i] == traced.result.samples.face[i + 1]) continue;
      ++rows;
      broken += Dark(film, i) != Dark(film, i + 1);
    }
  EXPECT_GT(rows, 100);
  return static_cast<double>(broken) / rows;
}

TEST(Zebra, StripesMeetAcrossG1AndEndAtG0) {
  EXPECT_LT(BrokenShare({.bend = 0.1, .other_bend = 0.1}), 0.15);
  EXPECT_LT(BrokenShare({.bend = 0.1, .other_bend = -0.1}), 0.15);
  EXPECT_GT(BrokenShare({.bend = 0.1, .other_bend = 0.1, .slope = 0.06}), 0.6);
}

TEST(Zebra, HasAsManyStripesAsItIsTold) {
  // Along a meridian of a ball seen from the front, the mirrored ray turns twice as fast as the normal. Its
  // 180 degrees from pole to pole lie between −45 and 45 degrees of latitude.
  const Traced traced(ModelOf({testing::Sphere({0, 0, 0}, 5)}), "front", Projection::kOrthographic, 999);
  for (int stripes : {8, 15}) {
    const Film film = traced.Drawn("zebra:stripes=" + std::to_string(stripes));
    int borders = 0;
    for (std::size_t y = 1; y < 999; ++y) {
      const std::size_t i = 999 * y + 499;
      if (!traced.Hit(i) || !traced.Hit(i - 999)) continue;
      const double z = std::fabs(traced.result.samples.normal[i][2]);
      if (z < std::sqrt(0.5)) borders += Dark(film, i) != Dark(film, i - 999);
    }
    EXPECT_EQ(borders, stripes);
  }
}

TEST(Isophotes, DependOnTheNormalAlone) {
  const Inspection inspection = ParseInspection("isophotes:bands=8,light=z").value();
  const StripePattern pattern(inspection, {}, {{0, 0, 0}, {1, 1, 1}});
  const Vec3 normal = Normalized({1, 2, 3});
  EXPECT_EQ(pattern.At({0, 0, 0}, normal, normal), pattern.At({9, -4, 2}, normal, {0, 0, 1}));
  // A wall parallel to the light is in the middle of a band, not at its border.
  EXPECT_EQ(pattern.At({}, {1, 0, 0}, {1, 0, 0}), pattern.At({}, {1, 0, 1e-7}, {1, 0, 0}));
  EXPECT_EQ(pattern.At({}, {1, 0, 0}, {1, 0, 0}), pattern.At({}, {1, 0, -1e-7}, {1, 0, 0}));
}

TEST(Reflection, LinesAllRoundTheTunnel) {
  // From the middle of the tunnel, a ray that turns once around the axis passes every lamp once.
  const Inspection inspection = ParseInspection("reflection:lines=12,direction=z").value();
  const StripePattern pattern(inspection, {}, {{-1, -1, -1}, {1, 1, 1}});
  int borders = 0;
  Stripe before = Stripe::kNone;
  for (int i = 0; i <= 3600; ++i) {
    const double a = i * 0.1 * M_PI / 180 + 0.001;
    const Vec3 ray{std::cos(a), std::sin(a), 0};
    const Stripe now = pattern.At({0, 0, 0}, ray, ray);
    if (i > 0) borders += now != before;
    before = now;
  }
  EXPECT_EQ(borders, 24);
  EXPECT_EQ(pattern.At({0, 0, 0}, {0, 0, 1}, {0, 0, 1}), Stripe::kNone) << "along the tunnel";
}

TEST(BackFaces, AreSignalledFromInside) {
  Model model = ModelOf({testing::Rectangle({0, 0, 0}, {10, 0, 0}, {0, 10, 0})});
  const InspectionView front = Traced(model, "top").Measured("back"),
                       back = Traced(model, "bottom").Measured("back");
  EXPECT_EQ(front.classes[1].pixels, 0u);
  EXPECT_GT(front.classes[0].pixels, 1000u);
  EXPECT_EQ(back.classes[0].pixels, 0u);
  EXPECT_EQ(back.classes[1].pixels, front.classes[0].pixels);
}

TEST(Unseen, FacesWithFewPixelsAreMarked) {
  const Model model = ModelOf({testing::Rectangle({0, 0, 0}, {100, 0, 0}, {0, 100, 0}),
                               testing::Rectangle({50, 50, 1}, {2, 0, 0}, {0, 2, 0}),
                               testing::Rectangle({10, 10, -5}, {5, 0, 0}, {0, 5, 0})});
  const Traced traced(model, "top", Projection::kOrthographic, 200);
  const InspectionView view = traced.Measured("unseen:pixels=50");
  EXPECT_EQ(view.face_pixels[2], 0u);
  EXPECT_GT(view.face_pixels[1], 0u);
  EXPECT_EQ(view.classes[1].pixels, view.face_pixels[1]);
  EXPECT_EQ(view.classes[0].pixels, view.face_pixels[0]);
}

TEST(Legend, IsThereForWhatHasAScaleOrClasses) {
  const Traced traced(testing::HollowBall({0, 0, 0}, 5, 4));
  for (const char* shade : {"curvature", "thickness", "draft", "back", "unseen"}) {
    const Image8 legend = DrawLegend(traced.Measured(shade), 300);
    EXPECT_EQ(legend.width, 300) << shade;
    EXPECT_GT(legend.height, 30) << shade;
  }
  EXPECT_EQ(DrawLegend(traced.Measured("zebra"), 300).width, 0);
  EXPECT_EQ(DrawLegend(traced.Measured("draft"), 20).width, kLeastLegend);
}

TEST(Pictures, AreTheSameBytesOnAnyThreadsAndInstructionSet) {
  const Model model = testing::HollowBall({1, 2, 3}, 12, 9.5);
  std::map<std::string, Film> expected;
  for (const Kernels& kernels : AvailableKernels()) {
    setenv("FACETLESS_ISA", kernels.isa.c_str(), 1);
    const Traced traced(model, "iso", Projection::kPerspective, 90);
    for (const std::string& shade : InspectionNames()) {
      if (shade == "studio") continue;
      for (const int threads : {1, 3}) {
        const Film film = traced.Drawn(shade, threads);
        const auto [known, is_new] = expected.try_emplace(shade, film);
        if (!is_new) {
          EXPECT_TRUE(known->second.pixels == film.pixels)
              << shade << " with " << kernels.isa << " on " << threads;
        }
      }
    }
  }
  unsetenv("FACETLESS_ISA");
}

TEST(Pictures, ASampleThatIsNoNumberIsNamed) {
  Traced traced(ModelOf({testing::Sphere({0, 0, 0}, 5)}), "front", Projection::kOrthographic, 20);
  const InspectionView view = traced.Measured("zebra");
  traced.result.samples.normal[20 * 10 + 7][1] = NAN;
  const Result<Film> film =
      Draw(traced.model, &traced.scene, traced.result.samples, traced.result.frame, view, {});
  ASSERT_FALSE(film.ok());
  EXPECT_EQ(film.error().code, ErrorCode::kNotFinite);
  EXPECT_NE(film.error().message.find("(7, 10)"), std::string::npos);
}

}  // namespace
}  // namespace facetless
