// Breaks along shared edges, against closed forms.
#include "render/inspect/continuity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/inspect/report.h"
#include "tests/support/shapes.h"
#include "tests/unit/inspect/joined.h"

namespace facetless {
namespace {

using testing::Join;
using testing::Joined;

EdgeContinuity OnlyEdge(const Model& model) {
  const Continuity continuity = MeasureContinuity(model, {}).value();
  EXPECT_EQ(continuity.edges.size(), 1u);
  EXPECT_EQ(continuity.unmeasured_edges, 0u);
  return continuity.edges.empty() ? EdgeContinuity{} : continuity.edges[0];
}

TEST(Continuity, TheSameParabolaOnBothSidesIsG2) {
  const EdgeContinuity edge = OnlyEdge(Joined({.bend = 0.3, .other_bend = 0.3}));
  EXPECT_EQ(edge.grade, Grade::kG2);
  EXPECT_NEAR(edge.length_mm, 4, 1e-12);
  EXPECT_LT(edge.gap_mm.value, 1e-14);
  EXPECT_LT(edge.curvature_jump.value, 1e-12);
}

TEST(Continuity, AnotherBendIsG1AndTheJumpIsKnown) {
  const EdgeContinuity edge = OnlyEdge(Joined({.bend = 0.3, .other_bend = -0.1}));
  EXPECT_EQ(edge.grade, Grade::kG1);
  EXPECT_LT(edge.angle_deg.value, 1e-12);
  // The outside is upwards, so a cup has negative curvature.
  EXPECT_NEAR(edge.curvatures[0], -0.6, 1e-12);
  EXPECT_NEAR(edge.curvatures[1], 0.2, 1e-12);
  EXPECT_NEAR(edge.curvature_jump.value, 0.8, 1e-12);
  EXPECT_NEAR(edge.relative_jump, 0.8 / 0.6, 1e-12);
}

TEST(Continuity, ASlopeIsG0AndItsAngleIsKnown) {
  const EdgeContinuity edge = OnlyEdge(Joined({.slope = 0.05}));
  EXPECT_EQ(edge.grade, Grade::kG0);
  EXPECT_NEAR(edge.angle_deg.value, std::atan(0.05) * 180 / std::numbers::pi, 1e-12);
}

TEST(Continuity, AStepIsAGapUnlessTheEdgeAllowsIt) {
  Model model = Joined({.step = 0.01});
  EXPECT_EQ(OnlyEdge(model).grade, Grade::kGap);
  EXPECT_NEAR(OnlyEdge(model).gap_mm.value, 0.01, 1e-12);
  // Each face may use all of the tolerance.
  model.edges[0].tolerance_mm = 0.006;
  EXPECT_EQ(OnlyEdge(model).grade, Grade::kG2);
}

TEST(Continuity, FacesAgainstEachOtherAreTurned) {
  const EdgeContinuity edge = OnlyEdge(Joined({.bend = 0.3, .other_bend = 0.1, .against = true}));
  EXPECT_EQ(edge.grade, Grade::kG1);
  EXPECT_NEAR(edge.curvature_jump.value, 0.4, 1e-12);
  EXPECT_NEAR(edge.curvatures[1], -0.2, 1e-12);
}

TEST(Continuity, ASegmentOfNoLengthStandsForItselfOnly) {
  // Importers leave such segments at the start of a closed p-curve.
  Model model = Joined({.bend = 0.3, .other_bend = -0.1});
  const std::uint32_t first = model.coedges[1].segments.first;
  const TrimSegment whole = model.trim_segments[first];
  TrimSegment empty = whole;
  empty.first_point = static_cast<std::uint32_t>(model.trim_points.size());
  empty.edge_begin = empty.edge_end = whole.edge_begin;
  model.trim_points.push_back({1, 0, 1}), model.trim_points.push_back({1, 0, 1});
  model.coedges[1].segments = {static_cast<std::uint32_t>(model.trim_segments.size()), 2};
  model.trim_segments.push_back(empty), model.trim_segments.push_back(whole);
  EXPECT_LT(OnlyEdge(model).gap_mm.value, 1e-14);
}

TEST(Continuity, ABoxHasTwelveCorners) {
  const Continuity continuity = MeasureContinuity(testing::LooseBox({10, 20, 30}, 0, 1), {}).value();
  ASSERT_EQ(continuity.edges.size(), 12u);
  EXPECT_EQ(continuity.counts[static_cast<std::size_t>(Grade::kG0)], 12u);
  for (const EdgeContinuity& edge : continuity.edges) EXPECT_NEAR(edge.angle_deg.value, 90, 1e-12);
}

TEST(Continuity, TheWorstComesFirstAndTheReportLeavesOutWhatIsSmooth) {
  const Model model = testing::LooseBox({10, 20, 30}, 0, 1);
  const nlohmann::json json = ContinuityJson(MeasureContinuity(model, {}).value(), model);
  EXPECT_EQ(json["counts"]["G0"], 12);
  EXPECT_EQ(json["worst"]["G0"].size(), 12u);
  EXPECT_FALSE(json["worst"].contains("G2"));
  EXPECT_FALSE(json["worst"]["G0"][0].contains("curvature_jump")) << "curvatures say nothing across a corner";
  const Model smooth = Joined({.bend = 0.3, .other_bend = -0.1});
  EXPECT_TRUE(ContinuityJson(MeasureContinuity(smooth, {}).value(), smooth)["worst"]["G1"][0].contains(
      "curvature_jump"));
}

TEST(Continuity, CanBeCancelled) {
  const std::atomic<bool> cancel{true};
  EXPECT_EQ(MeasureContinuity(testing::LooseBox({10, 20, 30}, 0, 1), {.cancel = &cancel}).error().code,
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace facetless
