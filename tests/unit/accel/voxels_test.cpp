// Voxels between planes: the walk of a ray, and the lists.
#include "render/accel/voxels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "tests/unit/accel/box_scenes.h"

namespace facetless {
namespace {

std::vector<std::size_t> WalkOf(const SlabRay& ray, const VoxelPlanes& planes) {
  std::vector<std::size_t> voxels;
  VoxelWalk walk(ray, planes, ray.t_first);
  do voxels.push_back(walk.voxel());
  while (walk.Next(ray.t_last));
  return voxels;
}

TEST(VoxelWalk, ARayAlongAnAxisPassesARow) {
  const BoxSet set(std::vector<Box3>{{{0, 0, 0}, {4, 4, 4}}});
  const VoxelPlanes planes = EvenPlanes(set.bounds(), {4, 4, 4});
  SlabRay ray;
  ASSERT_TRUE(set.Enter({{-3, 0.5, 2.5}, {1, 0, 0}}, ray));
  EXPECT_THAT(WalkOf(ray, planes), ::testing::ElementsAre(32, 33, 34, 35));
  ASSERT_TRUE(set.Enter({{2.5, 9, 0.5}, {0, -2, 0}}, ray));
  EXPECT_THAT(WalkOf(ray, planes), ::testing::ElementsAre(14, 10, 6, 2));
}

TEST(VoxelWalk, ItEndsWithTheInterval) {
  const BoxSet set(std::vector<Box3>{{{0, 0, 0}, {4, 4, 4}}});
  const VoxelPlanes planes = EvenPlanes(set.bounds(), {4, 4, 4});
  SlabRay ray;
  ASSERT_TRUE(set.Enter({{-3, 0.5, 0.5}, {1, 0, 0}, 4.5, 5.5}, ray));
  EXPECT_THAT(WalkOf(ray, planes), ::testing::ElementsAre(1, 2));
}

RC_GTEST_PROP(VoxelWalk, NeighboursShareAFaceAndEachVoxelComesOnce, (std::uint64_t seed)) {
  testing::Engine engine(seed);
  for (const testing::SceneKind kind : testing::kSceneKinds) {
    const std::vector<Box3> boxes = testing::DrawScene(kind, 50, engine);
    const BoxSet set(boxes);
    const std::array<std::uint32_t, 3> counts = CubicCounts(set, 3, 20);
    for (const VoxelPlanes& planes : {EvenPlanes(set.bounds(), counts), BoundaryPlanes(set, counts)})
      for (const RaySegment& segment : testing::DrawRays(boxes, 30, engine)) {
        SlabRay ray;
        if (!set.Enter(segment, ray)) continue;
        const std::vector<std::size_t> voxels = WalkOf(ray, planes);
        RC_ASSERT((std::set<std::size_t>(voxels.begin(), voxels.end()).size() == voxels.size()));
        for (std::size_t i = 1; i < voxels.size(); ++i) {
          const std::size_t step =
              voxels[i] > voxels[i - 1] ? voxels[i] - voxels[i - 1] : voxels[i - 1] - voxels[i];
          RC_ASSERT((step == 1 || step == planes.count(0) || step == planes.count(0) * planes.count(1)));
        }
      }
  }
}

RC_GTEST_PROP(VoxelLists, AVoxelListsTheBoxesThatReachIntoIt, (std::uint64_t seed)) {
  testing::Engine engine(seed);
  const testing::SceneKind kind = testing::kSceneKinds[engine() % std::size(testing::kSceneKinds)];
  const BoxSet set(testing::DrawScene(kind, 100, engine));
  const VoxelPlanes planes = BoundaryPlanes(set, CubicCounts(set, 2, 12));
  const VoxelLists lists(set, planes);
  std::uint64_t references = 0;
  for (std::uint32_t z = 0; z < planes.count(2); ++z)
    for (std::uint32_t y = 0; y < planes.count(1); ++y)
      for (std::uint32_t x = 0; x < planes.count(0); ++x) {
        const auto list = lists.Voxel(x + planes.count(0) * (y + std::size_t{planes.count(1)} * z));
        references += list.size();
        const std::uint32_t cell[3] = {x, y, z};
        for (std::uint32_t id = 0; id < set.size(); ++id) {
          // Inside by more than nothing: planes belong to the voxels on both sides only where they coincide.
          bool overlaps = true, touches = true;
          for (int axis = 0; axis < 3; ++axis) {
            const double low = planes.axis(axis)[cell[axis]], high = planes.axis(axis)[cell[axis] + 1];
            overlaps &= set[id].side[0][axis] < high && set[id].side[1][axis] > low;
            touches &= set[id].side[0][axis] <= high && set[id].side[1][axis] >= low;
          }
          const bool listed = std::ranges::count(list, id) > 0;
          RC_ASSERT(!overlaps || listed);
          RC_ASSERT(!listed || touches);
        }
      }
  RC_ASSERT(references == lists.references());
  RC_ASSERT(references == CountReferences(set, planes));
}

}  // namespace
}  // namespace facetless
