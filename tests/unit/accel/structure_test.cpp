// What all structures rely on: the enlarged boxes, the prepared ray, and the state of a query.
#include "render/accel/structure.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/unit/accel/box_scenes.h"

namespace facetless {
namespace {

TEST(BoxSet, EnlargesEachBoxByItsMargin) {
  const BoxSet set(std::vector<Box3>{{{0, 0, 0}, {1, 0, 4}}, {{-4, 1, 1}, {-4, 1, 1}}});
  EXPECT_EQ(set.scale(), 5);
  EXPECT_EQ(set.margin(), 5 * 0x1p-40);
  EXPECT_EQ(set[0].side[0][1], -set.margin());
  EXPECT_EQ(set[0].side[1][2], 4 + set.margin());
  EXPECT_EQ(set.bounds().side[0][0], -4 - set.margin());
}

TEST(BoxSet, WhereNumbersAreCoarseABoxGrowsToTheNextNumber) {
  const BoxSet set(std::vector<Box3>{{{1e7, 1e7, 1e7}, {1e7, 1e7, 1e7}}});
  EXPECT_EQ(set[0].side[0][0], std::nextafter(1e7, 0));
  EXPECT_EQ(set[0].side[1][0], std::nextafter(1e7, 1e8));
}

TEST(BoxSet, ScalesTheDirectionByAPowerOfTwo) {
  const BoxSet set(std::vector<Box3>{{{0, 0, 0}, {1, 1, 1}}});
  for (const double length : {1.0, 3.0, 1e-300, 1e300, 5e-324}) {
    SlabRay ray;
    ASSERT_TRUE(set.Enter({{0.5, 0.5, 0.5}, {0, -length, 0}}, ray)) << length;
    EXPECT_LE(1, -ray.direction[1]) << length;
    EXPECT_LT(-ray.direction[1], 2) << length;
    EXPECT_EQ(-ray.direction[1] * ray.unit, length);
    EXPECT_EQ(ray.near_side[1], 1);
    EXPECT_EQ(ray.t_first, 0);
    EXPECT_NEAR(ray.t_last * -ray.direction[1], 0.5, 1e-11) << "the interval ends with the scene";
  }
}

RC_GTEST_PROP(BoxSet, ABoxIsMetIfItIsMetInExtendedPrecision, (std::uint64_t seed)) {
  testing::Engine engine(seed);
  for (const testing::SceneKind kind : testing::kSceneKinds) {
    const std::vector<Box3> boxes = testing::DrawScene(kind, 50, engine);
    const BoxSet set(boxes);
    for (const RaySegment& segment : testing::DrawRays(boxes, 50, engine)) {
      SlabRay ray;
      const bool entered = set.Enter(segment, ray);
      for (std::uint32_t id = 0; id < boxes.size(); ++id)
        if (testing::MeetsExactly(segment, boxes[id], 0)) RC_ASSERT(entered && Meets(ray, set[id]));
    }
  }
}

RC_GTEST_PROP(BoxSet, ABoxBetweenTwoPlanesIsMetBetweenTheirParameters, (std::uint64_t seed)) {
  testing::Engine engine(seed);
  for (const testing::SceneKind kind : testing::kSceneKinds) {
    const std::vector<Box3> boxes = testing::DrawScene(kind, 50, engine);
    const BoxSet set(boxes);
    for (const RaySegment& segment : testing::DrawRays(boxes, 50, engine)) {
      SlabRay ray;
      if (!set.Enter(segment, ray) || set.TooFar(ray)) continue;
      for (std::uint32_t id = 0; id < boxes.size(); ++id) {
        if (!testing::MeetsExactly(segment, boxes[id], 0)) continue;
        double first = ray.t_first, last = ray.t_last;
        for (int axis = 0; axis < 3; ++axis) {
          first = std::max(first, ray.Pass(axis, set[id].side[ray.near_side[axis]][axis]));
          last = std::min(last, ray.Pass(axis, set[id].side[1 - ray.near_side[axis]][axis]));
        }
        RC_ASSERT(first <= last);
      }
    }
  }
}

TEST(QueryState, AnObjectIsNewOncePerRay) {
  QueryState state({.stamps = 3});
  for (int ray = 0; ray < 5; ++ray) {
    state.NextRay();
    EXPECT_TRUE(state.FirstTime(1));
    EXPECT_FALSE(state.FirstTime(1));
    EXPECT_TRUE(state.FirstTime(2));
  }
  EXPECT_EQ(state.counters.rays, 5u);
  EXPECT_GE(state.bytes(), 3 * sizeof(std::uint32_t));
}

}  // namespace
}  // namespace facetless
