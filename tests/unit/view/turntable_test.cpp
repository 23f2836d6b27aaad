// Cameras around a model.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/view/camera.h"

namespace facetless {
namespace {

Box3 Bounds() {
  Box3 box;
  box.Add({-1, -2, -3});
  box.Add({5, 4, 3});
  return box;
}

Camera View(const char* name, Projection projection = Projection::kOrthographic, UpAxis up = UpAxis::kZ) {
  return NamedView(name, Bounds(), projection, 120, 80, {.up = up}).value();
}

TEST(Turntable, TurnsByEvenStepsAboutTheAxisThatIsUp) {
  for (const UpAxis up : {UpAxis::kX, UpAxis::kY, UpAxis::kZ}) {
    const Vec3 axis = RotateToUpAxis(up, {0, 0, 1});
    const Camera first = View("iso", Projection::kOrthographic, up);
    for (const int count : {2, 7, 36, 360}) {
      const auto cameras = TurntableCameras(first, up, count, nullptr).value();
      ASSERT_EQ(cameras.size(), static_cast<std::size_t>(count));
      const Vec3 start = first.eye - first.target;
      for (int i = 0; i < count; ++i) {
        const Vec3 offset = cameras[i].eye - cameras[i].target;
        EXPECT_NEAR(Dot(offset, axis), Dot(start, axis), 1e-12) << "the elevation must not change";
        EXPECT_NEAR(Length(offset), Length(start), 1e-12);
        const Vec3 flat = offset - Dot(offset, axis) * axis, flat_start = start - Dot(start, axis) * axis;
        const double angle = 2 * std::numbers::pi * i / count, square = Dot(flat_start, flat_start);
        EXPECT_NEAR(Dot(flat, flat_start) / square, std::cos(angle), 1e-14);
        EXPECT_NEAR(Dot(Cross(flat_start, flat), axis) / square, std::sin(angle), 1e-14);
      }
      EXPECT_EQ(cameras[0].eye.x, first.eye.x);
    }
  }
}

TEST(Turntable, QuartersOfATurnAreTheNamedViews) {
  const auto cameras = TurntableCameras(View("front"), UpAxis::kZ, 4, nullptr).value();
  const char* const names[] = {"front", "right", "back", "left"};
  for (int i = 0; i < 4; ++i) {
    const Camera named = View(names[i]);
    EXPECT_EQ(Normalized(cameras[i].eye - cameras[i].target).x, Normalized(named.eye - named.target).x);
    EXPECT_EQ(Normalized(cameras[i].eye - cameras[i].target).y, Normalized(named.eye - named.target).y);
  }
  EXPECT_EQ(cameras[1].name, "front-002");
}

TEST(Turntable, TurnsTheViewFromTheTopToo) {
  const auto cameras = TurntableCameras(View("top"), UpAxis::kZ, 4, nullptr).value();
  for (const Camera& camera : cameras) EXPECT_TRUE(MakeFrame(camera, 10).ok());
  EXPECT_NEAR(cameras[1].up.x, -1, 1e-15);
}

TEST(Turntable, OneWindowShowsTheModelInEveryFrame) {
  const TurntableFit fit = {Bounds(), 0.1};
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const auto cameras = TurntableCameras(View("iso", projection), UpAxis::kZ, 24, &fit).value();
    double tightest = INFINITY;
    for (const Camera& camera : cameras) {
      EXPECT_EQ(camera.height, cameras[0].height);
      EXPECT_NEAR(Length(camera.eye - camera.target), Length(cameras[0].eye - cameras[0].target), 1e-12);
      const CameraFrame frame = MakeFrame(camera, 10).value();
      for (int i = 0; i < 8; ++i) {
        const PixelPoint p = Project(frame, {i & 1 ? -1.0 : 5.0, i & 2 ? -2.0 : 4.0, i & 4 ? -3.0 : 3.0});
        tightest = std::min({tightest, p.x / 120, 1 - p.x / 120, p.y / 80, 1 - p.y / 80});
      }
    }
    EXPECT_NEAR(tightest, 0.1, 1e-12);
  }
}

}  // namespace
}  // namespace facetless
