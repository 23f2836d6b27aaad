// The map of preliminary values is close to the surface, says what lies in front, leaves out what is trimmed away, and
// keeps the published format.
#include "render/solve/value_map.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "render/base/parallel.h"
#include "tests/support/shapes.h"
#include "tests/unit/solve/sheets.h"

namespace facetless {
namespace {

using testing::kSheetPixels;
using testing::MakeSheet;
using testing::OnScreen;
using testing::PointOn;
using testing::RayTo;
using testing::SceneOf;
using testing::SheetFrame;

ValueMap Drawn(const SolverScene& scene, SolverUnit unit = SolverUnit::kPatch, bool published = false,
               int size = kSheetPixels) {
  return ValueMap::Draw(scene, unit, {size, size, published}, 0, {}).value();
}

int CountValues(const ValueMap& map, int size = kSheetPixels) {
  int count = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) count += map.At(column, row).has_value();
  return count;
}

RC_GTEST_PROP(ValueMap, ValuesAreThoseOfTheSurfaceInThePixel, ()) {
  const int degree_u = *rc::gen::inRange(1, kMaxDegree + 1), degree_v = *rc::gen::inRange(1, kMaxDegree + 1);
  const bool perspective = *rc::gen::arbitrary<bool>(), rational = *rc::gen::arbitrary<bool>(),
             published = *rc::gen::arbitrary<bool>();
  const SolverScene scene = SceneOf(
      SheetFrame(perspective),
      MakeSheet(degree_u, degree_v, {0.2, 1, rational ? 2.0 : 1.0}, *rc::gen::arbitrary<std::uint32_t>()));
  const ValueMap map = Drawn(scene, SolverUnit::kPatch, published);
  const double half_level = 0.5 / (published ? 255 : 65535);
  // The sheet covers much of the picture, so that the map is not empty.
  RC_ASSERT(CountValues(map) > kSheetPixels * kSheetPixels / 8);
  for (int k = 0; k < 60; ++k) {
    const SolverRay ray = RayTo(scene, 0, 0.05 + 0.9 * (k % 8) / 7.0, 0.05 + 0.9 * (k / 8) / 7.0);
    const auto start = map.At(ray.column, ray.row);
    RC_ASSERT(start.has_value());
    RC_ASSERT(start->surface == 0u);
    RC_ASSERT(start->from_map);
    RC_ASSERT(start->u >= 0 && start->u <= 1 && start->v >= 0 && start->v <= 1);
    const auto at = OnScreen(scene, PointOn(scene, 0, start->u, start->v));
    const double x = ray.column + 0.5 - scene.frame().center_x, y = ray.row + 0.5 - scene.frame().center_y;
    // What rounding to a level can move the point, pixels.
    double rounding = 0;
    for (const double s : {-half_level, half_level})
      for (const double t : {-half_level, half_level}) {
        const auto other = OnScreen(scene, PointOn(scene, 0, start->u + s, start->v + t));
        rounding = std::max(rounding, static_cast<double>(std::hypot(other.x - at.x, other.y - at.y)));
      }
    RC_ASSERT(static_cast<double>(std::hypot(at.x - x, at.y - y)) <= 1 + 1.1 * rounding);
  }
}

TEST(ValueMap, APublishedMapHasLevelsOf8Bits) {
  const SolverScene scene = SceneOf(SheetFrame(false), MakeSheet(3, 3, {}, 1));
  const ValueMap published = Drawn(scene, SolverUnit::kPatch, true), wide = Drawn(scene);
  double apart = 0;
  for (int row = 0; row < kSheetPixels; ++row)
    for (int column = 0; column < kSheetPixels; ++column) {
      const auto coarse = published.At(column, row), fine = wide.At(column, row);
      ASSERT_EQ(coarse.has_value(), fine.has_value());
      if (!coarse) continue;
      const double level = 255 * coarse->u;
      ASSERT_NEAR(level, std::round(level), 1e-9);
      apart = std::max(apart, std::fabs(coarse->u - fine->u));
    }
  EXPECT_LE(apart, 0.5 / 255 + 1.0 / 65535);
  EXPECT_GT(apart, 0.4 / 255) << "otherwise the published map keeps more than 8 bits";
}

TEST(ValueMap, APublishedMapNumbers255Surfaces) {
  for (const int count : {255, 256}) {
    SolverScene scene(SheetFrame(false), {0, 0, 0});
    for (int k = 0; k < count; ++k) {
      const testing::Sheet sheet = MakeSheet(1, 1, {0, 0, 1}, 0);
      std::vector<Vec4> points = sheet.points;
      // Later sheets lie farther away.
      for (Vec4& p : points) p.y += 0.1 * k;
      scene.AddPatch(1, 1, points);
    }
    const auto map = ValueMap::Draw(scene, SolverUnit::kPatch, {50, 50, true}, 0, {});
    EXPECT_EQ(map.ok(), count == 255);
    if (!map.ok()) {
      EXPECT_EQ(map.error().code, ErrorCode::kBadUsage);
    }
    const ValueMap wide = ValueMap::Draw(scene, SolverUnit::kPatch, {200, 200, false}, 0, {}).value();
    EXPECT_EQ(wide.At(100, 100)->surface, 0u);
  }
}

TEST(ValueMap, SaysWhatLiesInFront) {
  for (const bool perspective : {false, true}) {
    SolverScene scene(SheetFrame(perspective), {0, 0, 0});
    for (const double depth : {20.0, -20.0, 0.0}) {
      std::vector<Vec4> points = MakeSheet(2, 3, {}, 5).points;
      for (Vec4& p : points) p.y += depth;
      scene.AddPatch(2, 3, points);
    }
    const ValueMap map = Drawn(scene);
    for (const double u : {0.2, 0.5, 0.8}) {
      const SolverRay ray = RayTo(scene, 1, u, 0.4);
      EXPECT_EQ(map.At(ray.column, ray.row)->surface, 1u) << "the front looks along +y";
    }
  }
}

TEST(ValueMap, CutsWhatLiesBehindTheEye) {
  // A ground from far in front of the eye to far behind it: its values are exact up to where it leaves the picture.
  const CameraFrame frame = SheetFrame(true);
  SolverScene scene(frame, frame.eye);
  std::vector<Vec4> points;
  for (const double along : {-500.0, 500.0})
    for (const double across : {-400.0, 400.0}) {
      const Vec3 p = frame.eye + along * frame.forward + across * frame.right + 20 * frame.down;
      points.push_back({p.x, p.y, p.z, 1});
    }
  scene.AddPatch(1, 1, points);
  const ValueMap map = Drawn(scene);
  int seen = 0;
  for (int row = 0; row < kSheetPixels; ++row)
    for (int column = 0; column < kSheetPixels; column += 7) {
      const double y = row + 0.5 - frame.center_y, depth = 20 / (frame.pixel_y * y);
      const auto start = map.At(column, row);
      if (y < 0 || depth > 499) {
        EXPECT_FALSE(start.has_value() && depth < 0) << "above the horizon";
        continue;
      }
      ASSERT_TRUE(start.has_value()) << column << " " << row;
      EXPECT_NEAR(start->u, (depth + 500) / 1000, 1e-4);
      ++seen;
    }
  EXPECT_GT(seen, 1000);
}

TEST(ValueMap, LeavesOutWhatIsTrimmedAway) {
  ModelBuilder builder;
  builder.AddPart("plate");
  SurfaceGrid plate{SurfaceKind::kPlane, 1, 1, {{0, 10, SpanMap::kLinear}}, {{0, 10, SpanMap::kLinear}}, {}};
  for (const double x : {0.0, 10.0})
    for (const double y : {0.0, 10.0}) plate.points.push_back({x, y, 0, 1});
  builder.AddFace(plate);
  for (const auto& [low, high] : {std::pair{0.0, 10.0}, {3.0, 6.0}}) {
    builder.AddLoop();
    const Vec3 corners[] = {{low, low, 1}, {high, low, 1}, {high, high, 1}, {low, high, 1}};
    for (int side = 0; side < 4; ++side) {
      builder.AddCoedge({});
      builder.AddTrimSegment(std::array{corners[side], corners[(side + 1) % 4]});
    }
  }
  builder.AddInstance({});
  const Model model = std::move(builder).Finish().value();
  const FaceTrim trim = FaceTrim::Build(model, 0);
  const Camera camera =
      NamedView("top", model.bounds, Projection::kOrthographic, 110, 110, {.margin = 0}).value();
  const CameraFrame frame = MakeFrame(camera, model.Diagonal()).value();
  SolverScene scene(frame, {5, 5, 0});
  scene.AddFace(model, 0, {}, 0, &trim, {});
  const ValueMap map = ValueMap::Draw(scene, SolverUnit::kFace, {110, 110, false}, 0, {}).value();
  int inside = 0, outside = 0;
  for (int row = 0; row < 110; ++row)
    for (int column = 0; column < 110; ++column) {
      const Ray ray = PixelRay(frame, column + 0.5, row + 0.5);
      const auto in_hole = [](double t) { return t > 3 && t < 6; };
      const bool hole = in_hole(ray.origin.x) && in_hole(ray.origin.y);
      EXPECT_EQ(map.At(column, row).has_value(), !hole) << column << " " << row;
      ++(hole ? outside : inside);
    }
  EXPECT_GT(inside, 5000);
  EXPECT_GT(outside, 500);
}

TEST(ValueMap, AFaceHasOneNumberAndItsOwnParameters) {
  const Model roof = testing::ModelOf({testing::Roof()});
  const Camera camera = NamedView("top", roof.bounds, Projection::kOrthographic, 100, 100).value();
  SolverScene scene(MakeFrame(camera, roof.Diagonal()).value(), {0, 0, 0});
  scene.AddFace(roof, 0, {}, 0, nullptr, {});
  const ValueMap by_face = Drawn(scene, SolverUnit::kFace, false, 100),
                 by_patch = Drawn(scene, SolverUnit::kPatch, false, 100);
  for (const int column : {30, 49, 51, 70}) {
    const auto face = by_face.At(column, 50), patch = by_patch.At(column, 50);
    ASSERT_TRUE(face && patch);
    EXPECT_EQ(face->surface, 0u);
    EXPECT_EQ(face->u_high, 2);
    EXPECT_EQ(face->v_high, 1);
    EXPECT_EQ(patch->surface, column < 50 ? 0u : 1u);
    EXPECT_NEAR(face->u, patch->surface + patch->u, 2.0 / 65535);
  }
}

TEST(ValueMap, IsTheSameForAnyNumberOfThreads) {
  const Model torus = testing::ModelOf({testing::Torus({0, 0, 0}, 20, 8)});
  const Camera camera = NamedView("iso", torus.bounds, Projection::kPerspective, 150, 150).value();
  SolverScene scene(MakeFrame(camera, torus.Diagonal()).value(), {0, 0, 0});
  scene.AddFace(torus, 0, {}, 0, nullptr, {});
  std::vector<ValueMap> maps;
  for (const int threads : {1, 4})
    RunWithThreads(threads, [&] { maps.push_back(Drawn(scene, SolverUnit::kPatch, false, 150)); });
  EXPECT_GT(CountValues(maps[0], 150), 4000);
  for (int row = 0; row < 150; ++row)
    for (int column = 0; column < 150; ++column) {
      const auto one = maps[0].At(column, row), four = maps[1].At(column, row);
      ASSERT_EQ(one.has_value(), four.has_value());
      if (!one) continue;
      ASSERT_EQ(one->surface, four->surface);
      ASSERT_EQ(one->u, four->u);
      ASSERT_EQ(one->v, four->v);
    }
}

TEST(ValueMap, SaysWhenItIsTooLargeOrCancelled) {
  const SolverScene scene = SceneOf(SheetFrame(false), MakeSheet(3, 3, {}, 1));
  const auto large = ValueMap::Draw(scene, SolverUnit::kPatch, {1000, 1000, false}, 1 << 20, {});
  ASSERT_FALSE(large.ok());
  EXPECT_EQ(large.error().code, ErrorCode::kLimitExceeded);
  const std::atomic<bool> stop = true;
  const auto cancelled = ValueMap::Draw(scene, SolverUnit::kPatch, {100, 100, false}, 0, {1, &stop});
  ASSERT_FALSE(cancelled.ok());
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace facetless
