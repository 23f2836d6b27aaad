// Surroundings: the studio is finite and smooth, and a panorama lies where it should.
#include "render/shade/environment.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

namespace facetless {
namespace {

Vec3 AnyDirection() {
  Vec3 v{};
  while (!(Length(v) > 0.1)) {
    const auto part = [] { return *rc::gen::inRange(-1000, 1001) / 1000.0; };
    v = {part(), part(), part()};
  }
  return Normalized(v);
}

CameraFrame Frame() {
  Camera camera;
  camera.eye = {10, -20, 15};
  camera.up = {0, 0, 1};
  return MakeFrame(camera, 10).value();
}

TEST(StudioSurroundings, AreFiniteAndBrightBehindTheModel) {
  EXPECT_TRUE(rc::check("any direction", [] {
    const Vec3 light = StudioSurroundings(AnyDirection());
    for (const double channel : {light.x, light.y, light.z}) RC_ASSERT(channel > 0 && channel < 3);
  }));
  EXPECT_GT(StudioSurroundings({0, 0, -1}).y, 0.8);
  EXPECT_LT(StudioSurroundings(Normalized({0, -0.5, 1})).y, 0.5);
}

TEST(StudioSurroundings, HaveNoSteps) {
  EXPECT_TRUE(rc::check("two directions next to each other", [] {
    const Vec3 d = AnyDirection(), step = 1e-5 * AnyDirection();
    RC_ASSERT(Length(StudioSurroundings(Normalized(d + step)) - StudioSurroundings(d)) < 1e-3);
  }));
}

TEST(Surroundings, APanoramaIsFixedToTheModel) {
  // Each pixel says where it is.
  auto map = std::make_shared<RadianceMap>();
  map->width = 360;
  map->height = 180;
  for (int row = 0; row < 180; ++row)
    for (int column = 0; column < 360; ++column)
      map->pixels.push_back({static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f, 1});
  const CameraFrame frame = Frame();
  const Surroundings surroundings(frame, map, UpAxis::kZ);
  const auto at = [&](Vec3 d) { return surroundings.Light(Normalized(d)); };
  EXPECT_NEAR(at({0, 1, 0}).x, 180, 0.01) << "the middle column lies straight ahead of the view front";
  EXPECT_NEAR(at({0, 1, 0}).y, 90, 0.01) << "on the horizon";
  EXPECT_NEAR(at({1, 0, 0}).x, 270, 0.01) << "right of it";
  EXPECT_NEAR(at({-1, 0, 0}).x, 90, 0.01) << "left of it";
  EXPECT_NEAR(at({1, 1, 0}).x, 225, 0.01);
  EXPECT_NEAR(at({0, 1, 1}).y, 45, 0.01) << "upper rows lie higher";
  EXPECT_LT(at({0, 0, 1}).y, 1);
  EXPECT_GT(at({0, 0, -1}).y, 179);
  EXPECT_TRUE(rc::check("any direction", [&] {
    const Vec3 d = AnyDirection(), light = surroundings.Light(d);
    RC_ASSERT(std::isfinite(light.x) && light.z > 0.999 && light.z < 1.001);
    const double height = 90 - light.y;  // degrees above the horizon
    RC_ASSERT(std::fabs(std::sin(height * 3.14159265358979 / 180) - d.z) < 0.02);
  }));
  // With Y up, the view front looks along −Z.
  const Surroundings turned(frame, map, UpAxis::kY);
  EXPECT_NEAR(turned.Light({0, 0, -1}).x, 180, 0.01);
  EXPECT_LT(turned.Light({0, 1, 0}).y, 1);
}

}  // namespace
}  // namespace facetless
