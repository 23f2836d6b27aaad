// The camera is the contract between both tracers. This file tests every law of camera.h and every row of
// docs/cameras.md.
#include "render/view/camera.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace facetless {
namespace {

Box3 UnitBox() {
  Box3 box;
  box.Add({-1, -2, -3});
  box.Add({1, 2, 3});
  return box;
}

void ExpectNear(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

CameraFrame FrameOf(const Camera& camera) {
  const Result<CameraFrame> frame = MakeFrame(camera, 1);
  EXPECT_TRUE(frame.ok()) << frame.error().message;
  return frame.value();
}

TEST(Camera, AxesAreRightHandedAndOrthonormal) {
  Camera camera;
  camera.eye = {3, -5, 4};
  camera.target = {0.5, 0.25, -1};
  camera.up = {0, 0, 1};
  const CameraFrame frame = FrameOf(camera);
  ExpectNear(Cross(frame.forward, frame.right), frame.down, 1e-15);
  EXPECT_NEAR(Length(frame.right), 1, 1e-15);
  EXPECT_NEAR(Length(frame.forward), 1, 1e-15);
  EXPECT_NEAR(Dot(frame.right, frame.forward), 0, 1e-15);
  EXPECT_LT(Dot(frame.down, camera.up), 0);
}

TEST(Camera, OrthographicWindowHasTheGivenHeightAndSquarePixels) {
  Camera camera;
  camera.height = 10;
  camera.width_px = 200;
  camera.height_px = 100;
  const CameraFrame frame = FrameOf(camera);
  EXPECT_DOUBLE_EQ(frame.pixel_x, 0.1);
  EXPECT_DOUBLE_EQ(frame.pixel_y, 0.1);
  const Vec3 top = PixelRay(frame, 100, 0).origin, bottom = PixelRay(frame, 100, 100).origin;
  EXPECT_NEAR(Length(bottom - top), 10, 1e-12);
}

TEST(Camera, PerspectiveWindowSpansTheFieldOfView) {
  Camera camera;
  camera.projection = Projection::kPerspective;
  for (double fov : {1e-6, 0.5, 20.0, 40.0, 90.0, 135.0, 179.0, 179.999}) {
    camera.fov_y_deg = fov;
    const CameraFrame frame = FrameOf(camera);
    const double expected = 2 * std::tan(fov * std::numbers::pi / 360);
    EXPECT_NEAR(frame.pixel_y * camera.height_px / expected, 1,
                4e-15 / std::cos(fov * std::numbers::pi / 360))
        << fov;
  }
}

TEST(Camera, DirectionHasUnitComponentAlongForward) {
  Camera camera;
  camera.projection = Projection::kPerspective;
  camera.eye = {10, 20, 30};
  camera.up = {0, 0, 1};
  const CameraFrame frame = FrameOf(camera);
  for (double x : {0.5, 17.25, 511.5})
    EXPECT_NEAR(Dot(PixelRay(frame, x, 3.5).direction, frame.forward), 1, 1e-15);
}

TEST(Camera, ProjectInvertsPixelRay) {
  EXPECT_TRUE(rc::check("a point on a pixel's ray projects to that pixel at its depth", [] {
    const auto number = [] { return *rc::gen::inRange(-1000, 1000) / 16.0; };
    Camera camera;
    camera.eye = {number(), number(), number()};
    camera.target = camera.eye + Vec3{number(), number(), number()};
    camera.up = {number(), number(), number()};
    camera.projection = *rc::gen::element(Projection::kOrthographic, Projection::kPerspective);
    camera.height = *rc::gen::inRange(1, 1000);
    camera.fov_y_deg = *rc::gen::inRange(1, 170);
    const Result<CameraFrame> frame = MakeFrame(camera, 1);
    RC_PRE(frame.ok());
    const double x = *rc::gen::inRange(0, 512 * 4) / 4.0, y = *rc::gen::inRange(0, 512 * 4) / 4.0;
    const double depth = *rc::gen::inRange(1, 100000) / 64.0;
    const Ray ray = PixelRay(frame.value(), x, y);
    const PixelPoint back = Project(frame.value(), ray.origin + depth * ray.direction);
    const double size = Length(camera.eye) + depth * Length(ray.direction) + camera.height;
    const double pixel =
        frame.value().pixel_x * (camera.projection == Projection::kPerspective ? depth : 1.0);
    RC_ASSERT(std::fabs(back.x - x) <= 1e-14 * size / pixel + 1e-12);
    RC_ASSERT(std::fabs(back.y - y) <= 1e-14 * size / pixel + 1e-12);
    RC_ASSERT(std::fabs(back.depth - depth) <= 1e-14 * size);
  }));
}

TEST(Camera, SupersamplingKeepsTheWindow) {
  Camera camera;
  camera.height = 7;
  camera.width_px = 30;
  camera.height_px = 20;
  const CameraFrame frame = FrameOf(camera);
  const CameraFrame fine = FrameOf(camera.Supersampled(4, 2));
  EXPECT_EQ(camera.Supersampled(4, 2).width_px, 120);
  EXPECT_EQ(camera.Supersampled(4, 2).height_px, 40);
  // The corners of the window are the same, and the mean of a pixel's samples is its centre.
  ExpectNear(PixelRay(frame, 0, 0).origin, PixelRay(fine, 0, 0).origin, 1e-14);
  ExpectNear(PixelRay(frame, 30, 20).origin, PixelRay(fine, 120, 40).origin, 1e-14);
  Vec3 mean;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 4; ++i) mean = mean + 0.125 * PixelRay(fine, 5 * 4 + i + 0.5, 7 * 2 + j + 0.5).origin;
  ExpectNear(mean, PixelRay(frame, 5.5, 7.5).origin, 1e-14);
}

TEST(Camera, RefusesWhatGivesNoRays) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const auto& change) {
    Camera camera;
    change(camera);
    const Result<CameraFrame> frame = MakeFrame(camera, 1);
    return !frame.ok() && frame.error().code == ErrorCode::kBadUsage;
  };
  EXPECT_FALSE(refused([](Camera&) {}));
  EXPECT_TRUE(refused([](Camera& c) { c.eye = c.target; }));
  EXPECT_TRUE(refused([](Camera& c) { c.up = {0, 0, -2}; }));
  EXPECT_TRUE(refused([](Camera& c) { c.up = {0, 0, 0}; }));
  EXPECT_TRUE(refused([&](Camera& c) { c.eye.x = nan; }));
  EXPECT_TRUE(refused([&](Camera& c) { c.height = nan; }));
  EXPECT_TRUE(refused([](Camera& c) { c.height = 0; }));
  EXPECT_TRUE(refused([](Camera& c) { c.height = -1; }));
  EXPECT_TRUE(refused([](Camera& c) { c.width_px = 0; }));
  EXPECT_TRUE(refused([](Camera& c) { c.height_px = 65537; }));
  EXPECT_TRUE(refused([](Camera& c) { c.name = "../etc"; }));
  EXPECT_TRUE(refused([](Camera& c) { c.name = ""; }));
  for (double fov : {0.0, 180.0, -1.0, nan})
    EXPECT_TRUE(refused([&](Camera& c) {
      c.projection = Projection::kPerspective;
      c.fov_y_deg = fov;
    })) << fov;
}

TEST(Camera, RefusesLengthsWhoseProductsLeaveTheRangeOfNumbers) {
  for (const double length : {1e-310, 1e-40, 1e40, 1e300}) {
    Camera window, narrow;
    window.height = length;
    EXPECT_FALSE(MakeFrame(window, 1).ok()) << length;
    EXPECT_FALSE(MakeFrame(Camera{}, length).ok()) << length;
    narrow.projection = Projection::kPerspective;
    narrow.fov_y_deg = length;
    EXPECT_FALSE(MakeFrame(narrow, 1).ok()) << length;
  }
  for (const double length : {1e-28, 1e28}) {
    Camera camera;
    camera.eye = {0, 0, length};
    camera.height = length;
    EXPECT_TRUE(MakeFrame(camera, length).ok()) << length;
  }
}

struct Direction {
  const char* name;
  Vec3 forward, up, right;
};

TEST(NamedView, LooksWhereTheTableSays) {
  const double r = 1 / std::sqrt(3.0), s = 1 / std::sqrt(2.0);
  const Direction table[] = {
      {"front", {0, 1, 0}, {0, 0, 1}, {1, 0, 0}},        {"back", {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}},
      {"left", {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},        {"right", {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {"top", {0, 0, -1}, {0, 1, 0}, {1, 0, 0}},         {"bottom", {0, 0, 1}, {0, -1, 0}, {1, 0, 0}},
      {"iso", {-r, r, -r}, {0, 0, 1}, {s, s, 0}},        {"iso-left", {r, r, -r}, {0, 0, 1}, {s, -s, 0}},
      {"iso-back", {r, -r, -r}, {0, 0, 1}, {-s, -s, 0}}, {"iso-right", {-r, -r, -r}, {0, 0, 1}, {-s, s, 0}},
      {"iso-below", {-r, r, r}, {0, 0, 1}, {s, s, 0}},
  };
  ASSERT_EQ(ViewNames().size(), std::size(table));
  for (std::size_t i = 0; i < std::size(table); ++i) {
    EXPECT_EQ(ViewNames()[i], table[i].name);
    for (Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      const Result<Camera> camera = NamedView(table[i].name, UnitBox(), projection, 64, 48);
      ASSERT_TRUE(camera.ok());
      const CameraFrame frame = FrameOf(camera.value());
      ExpectNear(frame.forward, table[i].forward, 1e-15);
      ExpectNear(frame.right, table[i].right, 1e-15);
      EXPECT_LT(Dot(frame.down, table[i].up), 0);
    }
  }
}

TEST(NamedView, FitsTheBoxAndLeavesTheMargin) {
  for (const std::string& name : ViewNames())
    for (Projection projection : {Projection::kOrthographic, Projection::kPerspective})
      for (auto [width, height] : {std::pair{400, 100}, {100, 400}, {256, 256}}) {
        const Result<Camera> camera = NamedView(name, UnitBox(), projection, width, height);
        ASSERT_TRUE(camera.ok());
        const CameraFrame frame = FrameOf(camera.value());
        double border = INFINITY;  // smallest free margin, as a share of the width or the height
        for (int i = 0; i < 8; ++i) {
          const PixelPoint p = Project(frame, {i & 1 ? 1.0 : -1.0, i & 2 ? 2.0 : -2.0, i & 4 ? 3.0 : -3.0});
          EXPECT_GT(p.depth, 0);
          border = std::min({border, p.x / width, 1 - p.x / width, p.y / height, 1 - p.y / height});
        }
        EXPECT_NEAR(border, 0.05, 1e-12) << name << " " << width << "x" << height;
      }
}

TEST(NamedView, KeepsTheMarginThatIsAskedForAndRefusesOneThatLeavesNothing) {
  for (Projection projection : {Projection::kOrthographic, Projection::kPerspective})
    for (double margin : {0.0, 0.2, 0.45}) {
      const Camera camera = NamedView("iso", UnitBox(), projection, 300, 200, {.margin = margin}).value();
      const CameraFrame frame = FrameOf(camera);
      double border = INFINITY;
      for (int i = 0; i < 8; ++i) {
        const PixelPoint p = Project(frame, {i & 1 ? 1.0 : -1.0, i & 2 ? 2.0 : -2.0, i & 4 ? 3.0 : -3.0});
        border = std::min({border, p.x / 300, 1 - p.x / 300, p.y / 200, 1 - p.y / 200});
      }
      EXPECT_NEAR(border, margin, 1e-12);
    }
  for (double margin : {-0.01, 0.46, static_cast<double>(NAN)})
    EXPECT_FALSE(NamedView("iso", UnitBox(), Projection::kOrthographic, 64, 64, {.margin = margin}).ok());
}

TEST(NamedView, TurnsWithTheAxisThatIsUp) {
  const struct {
    UpAxis axis;
    Vec3 up, front_forward, front_right, top_up, iso_eye;
  } table[] = {{UpAxis::kZ, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, -1, 1}},
               {UpAxis::kY, {0, 1, 0}, {0, 0, -1}, {1, 0, 0}, {0, 0, -1}, {1, 1, 1}},
               {UpAxis::kX, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {1, 1, -1}}};
  for (const auto& [axis, up, front_forward, front_right, top_up, iso_eye] : table) {
    const auto frame = [axis = axis](const char* name) {
      return FrameOf(NamedView(name, UnitBox(), Projection::kOrthographic, 64, 64, {.up = axis}).value());
    };
    ExpectNear(frame("front").forward, front_forward, 1e-15);
    ExpectNear(frame("front").right, front_right, 1e-15);
    ExpectNear(-frame("front").down, up, 1e-15);
    ExpectNear(frame("top").forward, -up, 1e-15);
    ExpectNear(-frame("top").down, top_up, 1e-15);
    ExpectNear(-frame("iso").forward, Normalized(iso_eye), 1e-15);
    // The view is rotated: what is to the right of the front view is what the right view faces.
    ExpectNear(-frame("right").forward, front_right, 1e-15);
    ExpectNear(frame("back").right, -front_right, 1e-15);
  }
}

TEST(NamedView, WorksFarFromTheOriginAndForFlatAndPointLikeBoxes) {
  Box3 far;
  far.Add({1e7, 1e7, 1e7});
  far.Add({1e7 + 1, 1e7 + 1, 1e7 + 1});
  Box3 flat;
  flat.Add({0, 0, 0});
  flat.Add({1, 1, 0});
  Box3 point;
  point.Add({5, 5, 5});
  for (const Box3& box : {far, flat, point})
    for (const std::string& name : ViewNames())
      for (Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
        const Result<Camera> camera = NamedView(name, box, projection, 64, 64);
        ASSERT_TRUE(camera.ok()) << name;
        const PixelPoint center = Project(FrameOf(camera.value()), box.center());
        EXPECT_NEAR(center.x, 32, 1e-5);
        EXPECT_GT(center.depth, 0);
      }
}

TEST(NamedView, NamesTheValidNames) {
  const Result<Camera> camera = NamedView("isometric", UnitBox(), Projection::kOrthographic, 64, 64);
  ASSERT_FALSE(camera.ok());
  EXPECT_EQ(camera.error().code, ErrorCode::kBadUsage);
  EXPECT_NE(camera.error().message.find("iso-below"), std::string::npos);
  EXPECT_FALSE(NamedView("iso", Box3{}, Projection::kOrthographic, 64, 64).ok());
}

}  // namespace
}  // namespace facetless
