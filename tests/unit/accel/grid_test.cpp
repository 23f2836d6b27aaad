// Grid and lattice: how they divide space, and what numbers of rays save.
#include "render/accel/grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "render/accel/lattice.h"
#include "tests/unit/accel/box_scenes.h"

namespace facetless {
namespace {

std::vector<Box3> Draw(testing::SceneKind kind, std::size_t least) {
  testing::Engine engine(3);
  std::vector<Box3> boxes;
  while (boxes.size() < least) boxes = testing::DrawScene(kind, 2 * least, engine);
  return boxes;
}

TEST(Grid, TheSourcesEstimateIsReproduced) {
  // c = 8, k = 1.1, d = 3.
  EXPECT_NEAR(EstimatedShare(3, {8 * 8 * 8, 1.1 * 1000, 1}, 1000), 0.0065, 0.00006);
}

TEST(Grid, HasTheVoxelsThatItIsAskedFor) {
  const Grid grid(Draw(testing::SceneKind::kUniform, 100), {.c = 8});
  EXPECT_EQ(grid.c(), 8u);
  EXPECT_EQ(grid.figures().regions, 512);
}

TEST(Grid, LargeObjectsMakeItCoarser) {
  const std::vector<Box3> boxes(1000, Box3{{0, 0, 0}, {1, 1, 1}});
  const Grid grid(boxes);
  EXPECT_LE(grid.figures().references, Grid::kMostReferences * 1000);
}

TEST(Grid, NumbersOfRaysSaveRepeatedQuestions) {
  const std::vector<Box3> boxes = Draw(testing::SceneKind::kNeedles, 300);
  const Grid grid(boxes);
  const RepeatingGrid repeating(boxes);
  QueryState once(grid.state_size()), often(repeating.state_size());
  testing::Engine engine(4);
  const auto nothing = [](std::uint32_t) { return INFINITY; };
  for (const RaySegment& ray : testing::DrawRays(boxes, 100, engine)) {
    grid.Visit(ray, once, nothing);
    repeating.Visit(ray, often, nothing);
  }
  EXPECT_GT(once.counters.repeats, 0u);
  EXPECT_EQ(often.counters.repeats, 0u);
  EXPECT_EQ(once.counters.regions, often.counters.regions);
  EXPECT_EQ(once.counters.tests + once.counters.repeats, often.counters.tests);
  EXPECT_LT(once.counters.candidates, often.counters.candidates);
}

TEST(Lattice, InnerPlanesAreSidesOfBoxes) {
  const std::vector<Box3> boxes = Draw(testing::SceneKind::kClustered, 200);
  const BoxSet set(boxes);
  const Lattice lattice(boxes);
  for (int axis = 0; axis < 3; ++axis) {
    ASSERT_GT(lattice.planes().count(axis), 2u);
    for (std::uint32_t i = 0; i <= lattice.planes().count(axis); ++i) {
      const double at = lattice.planes().axis(axis)[i];
      EXPECT_TRUE(std::ranges::any_of(set.boxes(), [&](const SlabBox& box) {
        return box.side[0][axis] == at || box.side[1][axis] == at;
      }));
    }
  }
}

TEST(Lattice, InClustersItTestsFewerBoxesThanTheGrid) {
  const std::vector<Box3> boxes = Draw(testing::SceneKind::kClustered, 400);
  const Grid grid(boxes);
  const Lattice lattice(boxes);
  QueryState of_grid(grid.state_size()), of_lattice(lattice.state_size());
  testing::Engine engine(4);
  const auto nothing = [](std::uint32_t) { return INFINITY; };
  for (const RaySegment& ray : testing::DrawRays(boxes, 200, engine)) {
    grid.Visit(ray, of_grid, nothing);
    lattice.Visit(ray, of_lattice, nothing);
  }
  EXPECT_LT(of_lattice.counters.tests, of_grid.counters.tests);
}

}  // namespace
}  // namespace facetless
