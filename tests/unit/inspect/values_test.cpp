// Draft, thickness, ranges, compared with closed forms.
#include "render/inspect/values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/inspect/report.h"
#include "tests/support/shapes.h"
#include "tests/unit/inspect/joined.h"
#include "tests/unit/inspect/traced.h"

namespace facetless {
namespace {

using testing::Frustum;
using testing::ModelOf;
using testing::Traced;

TEST(Draft, OfAConeIsItsHalfAngle) {
  // The wall leans by 5 over a height of 20.
  const double draft = std::atan(0.25) * 180 / std::numbers::pi;
  const Traced traced(ModelOf({Frustum({0, 0, 0}, 10, 5, 20)}), "front", Projection::kOrthographic);
  for (const auto& [shade, expected] :
       {std::pair{"draft:direction=z", draft}, std::pair{"draft:direction=-z", -draft},
        std::pair{"draft:direction=0,0,7", draft}}) {
    const PerSample<double> values = traced.Values(shade);
    for (std::size_t i = 0; i < traced.size(); ++i)
      if (traced.Hit(i)) {
        ASSERT_NEAR(values[i], expected, 1e-12);
      }
  }
}

TEST(Draft, AWallAtTheLimitHasOneClass) {
  const double draft = std::atan(0.25) * 180 / std::numbers::pi;
  const Traced traced(ModelOf({Frustum({0, 0, 0}, 10, 5, 20)}), "front");
  const auto classes = [&](double limit) {
    return traced.Measured("draft:limit=" + std::to_string(limit)).classes;
  };
  std::size_t hits = 0;
  for (std::size_t i = 0; i < traced.size(); ++i) hits += traced.Hit(i);
  char at_limit[64];
  std::snprintf(at_limit, sizeof at_limit, "draft:limit=%.17g", draft);
  EXPECT_EQ(traced.Measured(at_limit).classes[0].pixels, hits) << "exactly enough is enough";
  EXPECT_EQ(classes(draft - 0.1)[0].pixels, hits);
  EXPECT_EQ(classes(draft + 0.1)[1].pixels, hits);
  EXPECT_EQ(traced.Measured("draft:direction=-z,limit=3").classes[2].pixels, hits);
}

TEST(Thickness, OfAShellIsTheDifferenceOfItsRadii) {
  constexpr double kOuter = 12, kInner = 9.5;
  const Traced traced(testing::HollowBall({4, 5, -6}, kOuter, kInner));
  const PerSample<double> values = traced.Values("thickness");
  for (std::size_t i = 0; i < traced.size(); ++i)
    if (traced.Hit(i)) {
      ASSERT_NEAR(values[i], kOuter - kInner, 1e-9 * (kOuter - kInner));
    }
}

TEST(Thickness, OfABallIsItsDiameterAndOfATorusThatOfItsTube) {
  const Traced ball(ModelOf({testing::Sphere({0, 0, 0}, 5)})),
      torus(ModelOf({testing::Torus({0, 0, 0}, 20, 6)}));
  for (const auto& [traced, expected] : {std::pair{&ball, 10.0}, std::pair{&torus, 12.0}}) {
    const PerSample<double> values = traced->Values("thickness");
    for (std::size_t i = 0; i < traced->size(); ++i)
      if (traced->Hit(i)) {
        ASSERT_NEAR(values[i], expected, 1e-9 * expected);
      }
  }
}

TEST(Thickness, FollowsThePlacement) {
  // A box that is three times as long in y, turned by 90 degrees about z and mirrored.
  Model model = testing::LooseBox({10, 20, 30}, 0, 1);
  Placement placement;
  const double m[3][4] = {{0, -3, 0, 7}, {-1, 0, 0, 2}, {0, 0, 1, -5}};
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 4; ++k) placement.m[r][k] = m[r][k];
  testing::Place(&model, placement);
  model.bounds = {};
  for (int i = 0; i < 8; ++i)
    model.bounds.Add(placement.Point({i & 1 ? 10.0 : 0, i & 2 ? 20.0 : 0, i & 4 ? 30.0 : 0}));
  for (const auto& [view, expected] :
       {std::pair{"front", 10.0}, std::pair{"right", 60.0}, std::pair{"top", 30.0}}) {
    const Traced traced(model, view, Projection::kOrthographic, 40);
    const PerSample<double> values = traced.Values("thickness");
    std::size_t hits = 0;
    for (std::size_t i = 0; i < traced.size(); ++i) {
      if (!traced.Hit(i)) continue;
      ++hits;
      ASSERT_NEAR(values[i], expected, 1e-12 * expected) << view;
    }
    EXPECT_GT(hits, 100u);
  }
}

TEST(Thickness, OfAnOpenSheetHasNoNumber) {
  const Traced traced(ModelOf({testing::Rectangle({0, 0, 0}, {10, 0, 0}, {0, 10, 0})}), "top");
  const InspectionView view = traced.Measured("thickness");
  EXPECT_EQ(view.statistics.count, 0u);
  EXPECT_GT(view.statistics.none, 1000u);
  for (const double value : view.values) EXPECT_EQ(value, INFINITY);
  traced.Drawn("thickness");
}

TEST(Values, OfAMeshNeedNoParameters) {
  // A mesh's samples have no parameters, so its own normals are used, and a note says what they cannot give.
  Traced traced(ModelOf({Frustum({0, 0, 0}, 10, 5, 20)}), "front");
  traced.result.samples.uv.clear();
  const double draft = std::atan(0.25) * 180 / std::numbers::pi;
  const PerSample<double> values = traced.Values("draft");
  for (std::size_t i = 0; i < traced.size(); ++i)
    if (traced.Hit(i)) {
      ASSERT_NEAR(values[i], draft, 1e-5);
    }
  for (const char* shade : {"curvature", "thickness"}) {
    const auto refused = InspectionValues(traced.model, nullptr, traced.result.samples, traced.result.frame,
                                          ParseInspection(shade).value(), {});
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kBadUsage);
  }
}

TEST(Values, CanBeCancelled) {
  const Traced traced(ModelOf({testing::Sphere({0, 0, 0}, 5)}));
  const std::atomic<bool> cancel{true};
  const auto stopped =
      InspectionValues(traced.model, &traced.scene, traced.result.samples, traced.result.frame,
                       ParseInspection("thickness").value(), {.cancel = &cancel});
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

TEST(Orient, ByTheViewerTurnsASurfaceThatIsDrawnInsideOut) {
  // A ball that its file orients outwards, and the same ball inside out.
  Model outward = testing::ModelOf({testing::Sphere({0, 0, 0}, 10)});
  Model inward = outward;
  inward.faces[0].reversed = !inward.faces[0].reversed;
  const testing::Traced right(std::move(outward)), wrong(std::move(inward));
  const auto values = [](const testing::Traced& traced, const char* shade, Orient orient) {
    Inspection inspection = ParseInspection(shade).value();
    inspection.orient = orient;
    return Measure(traced.model, &traced.scene, traced.result.samples, traced.result.frame, inspection, {})
        .value();
  };
  for (const char* shade : {"draft", "curvature"}) {
    const InspectionView file = values(right, shade, Orient::kFile),
                         turned = values(wrong, shade, Orient::kViewer),
                         back = values(wrong, shade, Orient::kFile);
    EXPECT_EQ(file.back_pixels, 0u);
    EXPECT_EQ(back.back_pixels, back.statistics.count + back.statistics.none);
    EXPECT_EQ(turned.back_pixels, back.back_pixels) << "what the file says is counted all the same";
    for (std::size_t i = 0; i < right.size(); ++i) {
      if (!std::isfinite(file.values[i])) continue;
      EXPECT_NEAR(turned.values[i], file.values[i], 1e-9) << shade << " " << i;
      EXPECT_NEAR(back.values[i], -file.values[i], 1e-9) << shade << " " << i;
    }
    EXPECT_TRUE(InspectionJson(back, wrong.model).contains("note"));
    EXPECT_FALSE(InspectionJson(file, right.model).contains("note"));
    EXPECT_FALSE(InspectionJson(turned, wrong.model).contains("note"));
    for (std::size_t k = 0; k < file.classes.size(); ++k)
      EXPECT_EQ(turned.classes[k].pixels, file.classes[k].pixels) << file.classes[k].name;
  }
  // In the middle, a ball is as thick as its diameter. From the wrong side, the ray meets nothing.
  EXPECT_EQ(values(wrong, "thickness", Orient::kFile).statistics.count, 0u);
  const InspectionView thick = values(wrong, "thickness", Orient::kViewer);
  EXPECT_NEAR(thick.statistics.min, 20, 1e-6);
  EXPECT_NEAR(thick.statistics.max, 20, 1e-6);
  EXPECT_EQ(thick.range.low, 0);
}

TEST(Range, IgnoresFewOutliersAndIsSymmetric) {
  SampleBuffer samples;
  samples.Resize(1000, 1);
  PerSample<double> values(1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    samples.depth[i] = 1;
    values[i] = i < 5 ? 1e6 : i < 500 ? -0.5 : 0.25;
  }
  const ValueStatistics statistics = ComputeStatistics(values, samples);
  EXPECT_EQ(statistics.max, 1e6);
  Inspection curvature = ParseInspection("curvature").value();
  const ValueRange robust = ResolveRange(curvature, statistics, 100);
  EXPECT_EQ(robust.low, -0.5);
  EXPECT_EQ(robust.high, 0.5);
  curvature.range = ValueRange{-2, 3};
  EXPECT_EQ(ResolveRange(curvature, statistics, 100).high, 3);
}

TEST(Range, OfAFlatModelShowsNoNoise) {
  const Traced traced(ModelOf({testing::Rectangle({0, 0, 0}, {10, 3, 1}, {0, 10, 2})}), "top");
  const InspectionView view = traced.Measured("curvature:kind=max");
  const double diagonal = traced.model.Diagonal();
  EXPECT_NEAR(view.range.high, 1e-3 / diagonal, 1e-6 / diagonal);
  EXPECT_LT(std::max(std::fabs(view.statistics.min), view.statistics.max), 1e-3 * view.range.high);
}

}  // namespace
}  // namespace facetless
