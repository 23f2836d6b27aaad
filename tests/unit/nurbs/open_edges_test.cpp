// Edges that the file leaves open are found, with their cause and place, the worst first.
#include "render/nurbs/open_edges.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

// A box whose edges have all the tolerance that they need.
Model Box() {
  return testing::LooseBox({10, 8, 6}, 0.05, 3);
}

TEST(OpenEdges, ABoxWhoseGapsAreWithinTolerancesHasNone) {
  EXPECT_TRUE(FindOpenEdges(Box()).empty());
}

TEST(OpenEdges, AGapWiderThanTheToleranceIsFoundWhereItIsWidest) {
  Model model = testing::LooseBox({10, 8, 6}, 0, 1);
  // The middle control point of one edge is lifted by 2 mm, which lifts the parabola by half of that.
  const EdgeSegment& segment = model.edge_segments[4];
  model.edge_points[segment.first_point + 1].x += 1.2;
  model.edge_points[segment.first_point + 1].z += 1.6;
  const Vec4 middle = model.edge_points[segment.first_point + 1];
  for (Coedge& coedge : model.coedges)
    if (coedge.edge == 4) coedge.gap_mm = 1;
  model.edges[4].tolerance_mm = 0.5;
  const std::vector<OpenEdge> open = FindOpenEdges(model);
  ASSERT_EQ(open.size(), 1u);
  EXPECT_EQ(open[0].cause, OpenCause::kGap);
  EXPECT_EQ(open[0].edge, 4u);
  EXPECT_EQ(open[0].faces.size(), 2u);
  EXPECT_EQ(open[0].gap_mm, 1);
  EXPECT_EQ(open[0].tolerance_mm, 0.5);
  // The reported place is on the face, beside the middle of the edge. The places that are tested are a tenth
  // of the edge apart.
  EXPECT_LE(Length(open[0].at - Vec3{middle.x - 1.2, middle.y, middle.z - 1.6}), 1.1);
}

TEST(OpenEdges, AFaceThatIsMissingLeavesItsEdgesUsedOnce) {
  Model model = Box();
  const std::uint32_t first = model.loops[model.faces[5].loops.first].coedges.first;
  model.faces.pop_back();
  model.parts[0].faces.count = 5;
  const std::vector<OpenEdge> open = FindOpenEdges(model);
  ASSERT_EQ(open.size(), 4u);
  for (const OpenEdge& edge : open) {
    EXPECT_EQ(edge.cause, OpenCause::kUsedOnce);
    EXPECT_EQ(edge.faces.size(), 1u);
    bool of_missing = false;
    for (std::uint32_t c = first; c < first + 4; ++c)
      of_missing = of_missing || model.coedges[c].edge == edge.edge;
    EXPECT_TRUE(of_missing);
  }
  // The longest first.
  for (std::size_t i = 1; i < open.size(); ++i) EXPECT_GE(open[i - 1].length_mm, open[i].length_mm);
}

TEST(OpenEdges, AFaceTheWrongWayRoundUsesItsEdgesInTheSenseOfItsNeighbours) {
  Model model = Box();
  model.faces[2].reversed = true;
  const std::vector<OpenEdge> open = FindOpenEdges(model);
  ASSERT_EQ(open.size(), 4u);
  for (const OpenEdge& edge : open) EXPECT_EQ(edge.cause, OpenCause::kSameSense);
  EXPECT_STREQ(OpenCauseName(open[0].cause), "same_sense");
}

TEST(OpenEdges, TheRimOfASheetIsNoHole) {
  Model model = Box();
  for (Face& face : model.faces) face.solid = kNoIndex;
  model.faces.pop_back();
  model.parts[0].faces.count = 5;
  EXPECT_TRUE(FindOpenEdges(model).empty());
}

TEST(OpenEdges, HolesComeBeforeGaps) {
  Model model = Box();
  model.edges[0].tolerance_mm = 0.01;
  const std::uint32_t e0 = 0;
  model.faces[5].reversed = true;
  const std::vector<OpenEdge> open = FindOpenEdges(model);
  ASSERT_GE(open.size(), 5u);
  EXPECT_EQ(open.front().cause, OpenCause::kSameSense);
  EXPECT_EQ(open.back().cause, OpenCause::kGap);
  EXPECT_EQ(open.back().edge, e0);
}

}  // namespace
}  // namespace facetless
