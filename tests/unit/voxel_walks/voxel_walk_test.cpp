// Walks of rays through voxels: all exact ones find the same voxel, at the same t, bit for bit.
#include "render/voxel_walks/voxel_walk.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/support/random_voxels.h"

namespace facetless {
namespace {

using testing::AnyModel;

// A coordinate that is often a whole number or a half, so that rays run through edges and corners.
double AnyCoordinate(int most) {
  const int kind = *rc::gen::inRange(0, 3);
  const int steps = *rc::gen::inRange(-4, 2 * most + 4);
  return kind == 0 ? 0.5 * steps : 0.5 * steps + *rc::gen::inRange(-1000, 1000) * 1e-4;
}

Vec3 AnyDirection() {
  const auto component = [] {
    const int kind = *rc::gen::inRange(0, 4);
    if (kind == 0) return 0.0;
    if (kind == 1) return static_cast<double>(*rc::gen::inRange(-3, 4));
    return *rc::gen::inRange(-1000, 1000) * std::exp2(*rc::gen::inRange(-40, 20));
  };
  return {component(), component(), component()};
}

struct Cast {
  Vec3 origin, direction;
};
Cast AnyRay(VoxelPoint size) {
  return {{AnyCoordinate(size.x), AnyCoordinate(size.y), AnyCoordinate(size.z)}, AnyDirection()};
}

// The laws of voxel_ray.h, voxel by voxel.
VoxelHit ByDefinition(const RunModel& model, const VoxelRay& ray) {
  VoxelHit nearest;
  for (int x = 0; x < model.size().x; ++x)
    for (int y = 0; y < model.size().y; ++y)
      for (int z = 0; z < model.size().z; ++z) {
        const Voxel voxel = model.Get(x, y, z);
        if (!voxel.filled()) continue;
        const int low[3] = {x, y, z};
        double t_in = ray.t_first(), t_out = ray.t_last();
        bool beside = false;
        for (int axis = 0; axis < 3; ++axis) {
          if (ray.sign(axis) == 0) {
            beside = beside || !ray.IsAbove(axis, low[axis], 0) || ray.IsAbove(axis, low[axis] + 1, 0);
            continue;
          }
          const double a = ray.Pass(axis, low[axis]), b = ray.Pass(axis, low[axis] + 1);
          t_in = std::max(t_in, std::min(a, b));
          t_out = std::min(t_out, std::max(a, b));
        }
        if (beside || !(t_in < t_out) || !(t_in < nearest.t)) continue;
        nearest = ray.HitAt(t_in, voxel, 0);
        RC_ASSERT((nearest.at == VoxelPoint{x, y, z}));
      }
  return nearest;
}

bool Same(const VoxelHit& a, const VoxelHit& b) {
  return a.hit() == b.hit() && (!a.hit() || (a.t == b.t && a.at == b.at && a.voxel == b.voxel &&
                                             a.side == b.side && a.level == b.level));
}

RC_GTEST_PROP(VoxelWalks, AllFindWhatTheDefinitionSays, ()) {
  const RunModel model = AnyModel(17);
  const RawModel raw(model);
  const OctreeModel octree(model);
  for (int i = 0; i < 8; ++i) {
    const Cast cast = AnyRay(model.size());
    const double t_first = *rc::gen::arbitrary<bool>() ? 0 : 0.25 * *rc::gen::inRange(0, 40);
    VoxelRay ray;
    if (!ray.Enter(cast.origin, cast.direction, t_first, model.size())) continue;
    const VoxelHit expected = ByDefinition(model, ray);
    WalkCounters counters;
    RC_ASSERT(Same(WalkGrid(raw, ray, &counters), expected));
    RC_ASSERT(Same(WalkDescent(octree, ray, {}, &counters), expected));
  }
}

TEST(VoxelWalks, AreSteppedThroughCorners) {
  RunModel model({4, 4, 4});
  model.Set(2, 2, 2, Voxel::Of(1, 2, 3));
  model.Set(2, 1, 1, Voxel::Of(4, 5, 6));  // only touched by the diagonal
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({0, 0, 0}, {1, 1, 1}, 0, model.size()));
  WalkCounters counters;
  const VoxelHit hit = WalkGrid(RawModel(model), ray, &counters);
  EXPECT_EQ(hit.at, (VoxelPoint{2, 2, 2}));
  EXPECT_EQ(hit.t, 2);
  EXPECT_EQ(hit.side, 0);
  EXPECT_EQ(counters.steps, 3u);
}

TEST(VoxelWalks, EmptySpaceIsSkippedByTheTree) {
  RunModel model({1024, 1024, 1024});
  model.Set(1023, 1023, 1023, Voxel::Of(1, 2, 3));
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({-5, 1023.5, 1023.5}, {1, 0, 0}, 0, model.size()));
  WalkCounters counters;
  const VoxelHit hit = WalkDescent(OctreeModel(model), ray, {}, &counters);
  EXPECT_EQ(hit.at, (VoxelPoint{1023, 1023, 1023}));
  EXPECT_EQ(hit.t, 1028);
  EXPECT_LE(counters.steps, 2u * kMostOctreeLevels);
}

TEST(VoxelWalks, ARayMayStartInside) {
  RunModel model({8, 8, 8});
  model.Fill({{0, 0, 0}, {8, 8, 8}}, Voxel::Of(9, 9, 9));
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({3.5, 3.5, 3.5}, {0, 0, -1}, 0, model.size()));
  WalkCounters counters;
  const VoxelHit hit = WalkDescent(OctreeModel(model), ray, {}, &counters);
  EXPECT_EQ(hit.t, 0);
  EXPECT_EQ(hit.side, -1);
  EXPECT_EQ(hit.at, (VoxelPoint{3, 3, 3}));
}

TEST(VoxelWalks, StopAtTheFootprint) {
  RunModel model({64, 64, 64});
  model.Fill({{0, 0, 32}, {64, 64, 33}}, Voxel::Of(200, 0, 0));
  const OctreeModel octree(model);
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({20.5, 20.5, 1000}, {0, 0, -1}, 0, model.size()));
  WalkCounters counters;
  EXPECT_EQ(WalkDescent(octree, ray, {}, &counters).level, 0);
  // A pixel that covers 9 voxels sees cubes of 8.
  const VoxelHit coarse = WalkDescent(octree, ray, {.footprint_0 = 9, .footprint = 0}, &counters);
  EXPECT_EQ(coarse.level, 3);
  EXPECT_EQ(coarse.voxel, Voxel::Of(200, 0, 0));
  EXPECT_EQ(WalkDescent(octree, ray, {.footprint_0 = 0, .footprint = 0.004}, &counters).level, 1);
}

// The guess for a voxel is useless where the origin is so far away that its coordinates have no fractions.
TEST(VoxelRays, FromFarAwayEndSoon) {
  RunModel model({300, 200, 100});
  model.Fill({{0, 0, 0}, {300, 200, 100}}, Voxel::Of(9, 9, 9));
  const OctreeModel octree(model);
  const RawModel raw(model);
  for (const double far : {1e6, 1e12, 1e18, 1e30, 1e100}) {
    VoxelRay ray;
    if (!ray.Enter({-far, 100 - 0.3 * far, 50}, {1, 0.3, 0}, 0, model.size())) continue;
    WalkCounters counters;
    const VoxelHit hit = WalkDescent(octree, ray, {}, &counters), other = WalkGrid(raw, ray, &counters);
    EXPECT_TRUE(Same(hit, other)) << far;
    EXPECT_TRUE(!hit.hit() || model.box().Holds(hit.at)) << far;
  }
}

TEST(VoxelRays, ThatMissOrAreNotFinite) {
  VoxelRay ray;
  EXPECT_FALSE(ray.Enter({-1, 5, 5}, {-1, 0, 0}, 0, {10, 10, 10}));
  EXPECT_FALSE(ray.Enter({5, 5, 12}, {1, 1, 0}, 0, {10, 10, 10}));
  EXPECT_FALSE(ray.Enter({NAN, 5, 5}, {1, 0, 0}, 0, {10, 10, 10}));
  EXPECT_FALSE(ray.Enter({5, 5, 5}, {INFINITY, 0, 0}, 0, {10, 10, 10}));
  EXPECT_TRUE(ray.Enter({5, 5, 5}, {1e-300, 1, 0}, 0, {10, 10, 10}));
}

}  // namespace
}  // namespace facetless
