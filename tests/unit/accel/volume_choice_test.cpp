// Bounding spheres, the cost model that chooses between them and boxes, and plane traversal.
#include "render/accel/volume_choice.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include "render/accel/plane_traversal.h"
#include "tests/unit/accel/box_scenes.h"

namespace facetless {
namespace {

SlabBox Slab(Vec3 low, Vec3 high) {
  return {{{low.x, low.y, low.z}, {high.x, high.y, high.z}}};
}

TEST(VolumeChoice, CostsAreThoseOfTheModel) {
  EXPECT_EQ(TotalCost(100, 2, 10, 50), 700);
  EXPECT_EQ(Fit(2, 8), 0.25);
  EXPECT_EQ(Fit(0, 8), 0) << "a plate fits nothing";
}

TEST(VolumeChoice, TheFitGivesTheShareOfRays) {
  // A ball in its box: rays that meet the box meet the ball in p = π/6 of the cases.
  const SlabBox cube = Slab({0, 0, 0}, {2, 2, 2});
  const double ball = 4.0 / 3 * std::numbers::pi, scene = 600;
  const double of_ball = 4 * std::numbers::pi / scene;
  EXPECT_NEAR(MeetingShare(Volume::kBox, cube, ball, scene), of_ball / (std::numbers::pi / 6), 1e-12);
  // The sphere around the box has √27 times the ball's volume.
  EXPECT_NEAR(MeetingShare(Volume::kSphere, cube, ball, scene), of_ball * std::sqrt(27.0), 1e-12);
  EXPECT_EQ(MeetingShare(Volume::kSphere, cube, ball, 1), 1) << "no more rays than there are";
  // A plate: the ratio of the surfaces.
  const SlabBox plate = Slab({0, 0, 0}, {1, 1, 0});
  EXPECT_NEAR(MeetingShare(Volume::kBox, plate, 0, scene), 2 / scene, 1e-12);
}

TEST(VolumeChoice, AnExpensiveObjectGetsTheTighterVolume) {
  const SlabBox cube = Slab({0, 0, 0}, {1, 1, 1}), needle = Slab({0, 0, 0}, {1, 0.01, 0.01});
  const VolumeCosts costs{2, 1};
  constexpr double kScene = 60000;
  EXPECT_EQ(ChooseVolume(cube, {0.5, 10}, costs, kScene), Volume::kSphere) << "few rays meet it in any case";
  EXPECT_EQ(ChooseVolume(cube, {0.5, 1e6}, costs, kScene), Volume::kBox);
  EXPECT_EQ(ChooseVolume(needle, {1e-4, 1e5}, costs, kScene), Volume::kBox);
  EXPECT_EQ(ChooseVolume(cube, {0.5, 10}, {1, 1}, kScene), Volume::kBox) << "the box, if both cost the same";
}

TEST(VolumeChoice, TheChoiceCostsNoMoreThanEitherByTheModel) {
  testing::Engine engine(3);
  std::vector<Box3> boxes = testing::DrawScene(testing::SceneKind::kNeedles, 300, engine);
  const std::vector<Box3> more = testing::DrawScene(testing::SceneKind::kUniform, 300, engine);
  boxes.insert(boxes.end(), more.begin(), more.end());
  const VolumeChoice list(boxes, {}, {3, 2});
  EXPECT_EQ(list.boxes() + list.spheres(), boxes.size());
  EXPECT_LE(list.chosen_ns(), list.all_boxes_ns());
  EXPECT_LE(list.chosen_ns(), list.all_spheres_ns());
  EXPECT_GT(list.boxes(), 0u);
  EXPECT_GT(list.spheres(), 0u);
}

TEST(VolumeChoice, TheMeasuredCostsAreOfTheOrderOfNanoseconds) {
  const VolumeCosts costs = MeasureVolumeCosts();
  EXPECT_GT(costs.box_ns, 0.1);
  EXPECT_GT(costs.sphere_ns, 0.1);
  EXPECT_LT(costs.box_ns, 5000);
  EXPECT_LT(costs.sphere_ns, 5000);
}

TEST(PlaneTraversal, BoxesAreEnteredFromFrontToBack) {
  testing::Engine engine(3);
  std::vector<Box3> boxes;
  while (boxes.size() < 300) boxes = testing::DrawScene(testing::SceneKind::kNeedles, 600, engine);
  const PlaneTraversal traversal(boxes);
  const BoxSet set(boxes);
  QueryState state(traversal.state_size());
  for (const RaySegment& segment : testing::DrawRays(boxes, 200, engine)) {
    SlabRay ray;
    if (!set.Enter(segment, ray) || set.TooFar(ray)) continue;
    double last = 0;
    traversal.Visit(segment, state, [&](std::uint32_t id) {
      double t_in, t_out;
      EXPECT_TRUE(Meets(ray, set[id], t_in, t_out));
      EXPECT_GE(t_in, last * (1 - 0x1p-48));
      last = t_in;
      return INFINITY;
    });
  }
  EXPECT_GT(state.counters.candidates, 100u);
}

TEST(PlaneTraversal, PlanesAscendOnEachAxis) {
  const std::vector<SlabBox> boxes = {Slab({0, 0, 0}, {1, 2, 3}), Slab({-1, 2, 1}, {0, 4, 2})};
  std::vector<BoxPlane> planes;
  AppendPlanes(boxes, planes);
  ASSERT_EQ(planes.size(), 12u);
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 1; i < 4; ++i) EXPECT_LE(planes[4 * axis + i - 1].at, planes[4 * axis + i].at);
  EXPECT_EQ(planes[0].box, 1u);
  EXPECT_FALSE(planes[0].high);
}

}  // namespace
}  // namespace facetless
