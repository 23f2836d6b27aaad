// Walks of rays through voxels: all exact ones find the same voxel, at the same t, bit for bit.
#include "render/voxel_walks/voxel_walk.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "render/voxels/adaptive_octree_model.h"
#include "render/voxels/n3_tree_model.h"
#include "render/voxels/octree_model.h"
#include "render/voxels/raw_model.h"
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

std::unique_ptr<const BoundWalk> Bound(const VoxelModel& model, std::string_view walk) {
  Result<std::unique_ptr<const BoundWalk>> bound = BindVoxelWalk(model, walk);
  EXPECT_TRUE(bound.ok()) << (bound.ok() ? "" : bound.error().message);
  return std::move(bound).value();
}

// The name of a walk with a setting drawn from its whole range, if it has one.
std::string AnySetting(const NamedVoxelWalk& walk) {
  const std::string name(walk.name);
  return walk.setting.empty() ? name : name + ":" + std::to_string(*rc::gen::inRange(1, walk.most + 1));
}

RC_GTEST_PROP(VoxelWalks, AllFindWhatTheDefinitionSays, ()) {
  const RunModel model = AnyModel(17);
  std::vector<VoxelRay> rays;
  for (int i = 0; i < 8; ++i) {
    const Cast cast = AnyRay(model.size());
    VoxelRay ray;
    if (ray.Enter(cast.origin, cast.direction,
                  *rc::gen::arbitrary<bool>() ? 0 : 0.25 * *rc::gen::inRange(0, 40), model.size()))
      rays.push_back(ray);
  }
  std::vector<VoxelHit> expected;
  for (const VoxelRay& ray : rays) expected.push_back(ByDefinition(model, ray));
  std::size_t walks = 0;
  for (const NamedVoxelWalk& walk : VoxelWalks()) {
    if (!walk.exact) continue;
    ++walks;
    const auto encoded = Converted(model, walk.encoding);
    RC_ASSERT(encoded.ok());
    const std::string name = AnySetting(walk);
    const auto bound = Bound(*encoded.value(), name);
    WalkCounters counters;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!Same(bound->Walk(rays[i], {}, &counters), expected[i])) RC_FAIL(name + " finds another hit");
    }
    RC_ASSERT(counters.rays >= rays.size());
  }
  RC_ASSERT(walks == VoxelWalks().size() - 1);
}

// With a footprint, too, all walks through octrees stop at the same node, and N³-trees of N = 2 have the same levels.
RC_GTEST_PROP(VoxelWalks, OctreesAgreeOnLevels, ()) {
  const RunModel model = AnyModel(33);
  const OctreeModel octree(model);
  const N3TreeModel tree(model, 2, 1), bricks(model, 2, 1 << *rc::gen::inRange(1, 4));
  const auto descent = Bound(octree, "descent"), nodes = Bound(tree, "bricks"),
             mips = Bound(bricks, "bricks");
  for (int i = 0; i < 8; ++i) {
    const Cast cast = AnyRay(model.size());
    VoxelRay ray;
    if (!ray.Enter(cast.origin, cast.direction, 0, model.size())) continue;
    const double length = Length(cast.direction) + 1e-9;
    const WalkOptions options{.footprint_0 = 0.25 * *rc::gen::inRange(0, 40),
                              .footprint = 0.01 * *rc::gen::inRange(0, 100) * length};
    WalkCounters counters;
    const VoxelHit expected = descent->Walk(ray, options, &counters);
    for (const NamedVoxelWalk& walk : VoxelWalks()) {
      if (walk.encoding != "octree") continue;
      const std::string name = AnySetting(walk);
      if (!Same(Bound(octree, name)->Walk(ray, options, &counters), expected))
        RC_FAIL(name + " finds another hit");
    }
    RC_ASSERT(Same(nodes->Walk(ray, options, &counters), expected));
    const VoxelHit of_mips = mips->Walk(ray, options, &counters);
    RC_ASSERT(of_mips.t == expected.t && of_mips.voxel == expected.voxel);
    // The law itself: a stop at a level is at a node that is no wider than the footprint where it is entered.
    if (!expected.hit()) continue;
    RC_ASSERT(expected.level == 0 ||
              (1 << expected.level) <= options.footprint_0 + options.footprint * expected.t);
    RC_ASSERT(expected.level == 0 ||
              octree.GetMean(expected.at.x, expected.at.y, expected.at.z, expected.level).voxel ==
                  expected.voxel);
  }
}

TEST(VoxelWalks, AreSteppedThroughCorners) {
  RunModel model({4, 4, 4});
  model.Set(2, 2, 2, Voxel::Of(1, 2, 3));
  model.Set(2, 1, 1, Voxel::Of(4, 5, 6));  // only touched by the diagonal
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({0, 0, 0}, {1, 1, 1}, 0, model.size()));
  WalkCounters counters;
  const RawModel raw(model);
  const VoxelHit hit = Bound(raw, "grid")->Walk(ray, {}, &counters);
  EXPECT_EQ(hit.at, (VoxelPoint{2, 2, 2}));
  EXPECT_EQ(hit.t, 2);
  EXPECT_EQ(hit.side, 0);
  EXPECT_EQ(counters.steps, 3u);
}

TEST(VoxelWalks, EmptySpaceIsSkippedByTrees) {
  RunModel model({1024, 1024, 1024});
  model.Set(1023, 1023, 1023, Voxel::Of(1, 2, 3));
  const OctreeModel octree(model);
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({-5, 1023.5, 1023.5}, {1, 0, 0}, 0, model.size()));
  std::uint64_t restart = 0;
  for (const std::string_view walk :
       {"kd-restart", "descent", "kd-backtrack", "kd-shortstack:1", "neighbours"}) {
    WalkCounters counters;
    const VoxelHit hit = Bound(octree, walk)->Walk(ray, {}, &counters);
    EXPECT_EQ(hit.at, (VoxelPoint{1023, 1023, 1023})) << walk;
    EXPECT_EQ(hit.t, 1028) << walk;
    // Ten leaves are passed on the way.
    EXPECT_EQ(counters.steps, 11u) << walk;
    if (walk == "kd-restart") restart = counters.nodes;
    EXPECT_LE(counters.nodes, restart) << walk;
  }
  WalkCounters all, one;
  Bound(octree, "kd-backtrack")->Walk(ray, {}, &all);
  Bound(octree, "kd-shortstack:1")->Walk(ray, {}, &one);
  EXPECT_LT(all.nodes, restart);
  EXPECT_LE(all.nodes, one.nodes);
  // A stack for the whole path never restarts.
  WalkCounters whole;
  Bound(octree, "kd-shortstack:16")->Walk(ray, {}, &whole);
  EXPECT_EQ(whole.nodes, all.nodes);
}

TEST(VoxelWalks, ARayMayStartInside) {
  RunModel model({8, 8, 8});
  model.Fill({{0, 0, 0}, {8, 8, 8}}, Voxel::Of(9, 9, 9));
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({3.5, 3.5, 3.5}, {0, 0, -1}, 0, model.size()));
  for (const NamedVoxelWalk& walk : VoxelWalks()) {
    const auto encoded = Converted(model, walk.encoding);
    WalkCounters counters;
    const VoxelHit hit = Bound(*encoded.value(), walk.name)->Walk(ray, {}, &counters);
    EXPECT_EQ(hit.t, 0) << walk.name;
    EXPECT_EQ(hit.side, -1) << walk.name;
    EXPECT_EQ(hit.at, (VoxelPoint{3, 3, 3})) << walk.name;
  }
}

TEST(VoxelWalks, StopAtTheFootprint) {
  RunModel model({64, 64, 64});
  model.Fill({{0, 0, 32}, {64, 64, 33}}, Voxel::Of(200, 0, 0));
  const OctreeModel octree(model);
  const auto descent = Bound(octree, "descent");
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({20.5, 20.5, 1000}, {0, 0, -1}, 0, model.size()));
  WalkCounters counters;
  EXPECT_EQ(descent->Walk(ray, {}, &counters).level, 0);
  // A pixel that covers 9 voxels sees cubes of 8.
  const VoxelHit coarse = descent->Walk(ray, {.footprint_0 = 9, .footprint = 0}, &counters);
  EXPECT_EQ(coarse.level, 3);
  EXPECT_EQ(coarse.voxel, Voxel::Of(200, 0, 0));
  EXPECT_EQ(descent->Walk(ray, {.footprint_0 = 0, .footprint = 0.004}, &counters).level, 1);
}

// Bresenham's points lie on the ray, one for each step along the longest component.
TEST(VoxelWalks, BresenhamMissesVoxelsBetweenItsPoints) {
  RunModel model({8, 8, 1});
  model.Fill({{0, 3, 0}, {8, 4, 1}}, Voxel::Of(1, 2, 3));
  model.Set(4, 3, 0, {});
  RawModel raw(model);
  VoxelRay ray;
  ASSERT_TRUE(ray.Enter({0, 0.5, 0.5}, {1, 0.65, 0}, 0, raw.size()));
  WalkCounters counters;
  const VoxelHit exact = Bound(raw, "grid")->Walk(ray, {}, &counters),
                 points = Bound(raw, "bresenham")->Walk(ray, {}, &counters);
  EXPECT_EQ(exact.at, (VoxelPoint{3, 3, 0}));  // entered from (3, 2, 0), through its upper side
  EXPECT_EQ(exact.side, 1);
  EXPECT_EQ(points.at,
            (VoxelPoint{5, 3, 0}));  // the points are at x = 3, y = 2.45, and x = 4, y = 3.1, which is empty
  EXPECT_DOUBLE_EQ(points.t, 5);
}

TEST(VoxelWalks, AreFoundByName) {
  const RunModel runs({4, 4, 4});
  const OctreeModel octree(runs);
  EXPECT_EQ(FindVoxelWalk("neighbours").value()->encoding, "octree");
  const auto message = [&](std::string_view walk) {
    const auto bound = BindVoxelWalk(octree, walk);
    return bound.ok() ? std::string() : bound.error().message;
  };
  EXPECT_EQ(message(""), "");
  EXPECT_EQ(message("kd-shortstack:25"), "");
  EXPECT_NE(message("nonsense").find("there are: grid, bresenham, columns"), std::string::npos);
  EXPECT_NE(message("kd-shortstack:26").find("from 1 to 25"), std::string::npos);
  EXPECT_NE(message("kd-shortstack:").find("not ''"), std::string::npos);
  EXPECT_NE(message("descent:3").find("has no setting"), std::string::npos);
  EXPECT_NE(message("grid").find("takes voxels encoded as raw, not as octree"), std::string::npos);
  for (const VoxelEncoding& encoding : VoxelEncodings()) {
    EXPECT_EQ(UsualVoxelWalk(encoding.name).encoding, encoding.name);
    EXPECT_TRUE(UsualVoxelWalk(encoding.name).exact);
  }
}

TEST(VoxelWalks, LinksTakeMemory) {
  RunModel model({64, 64, 64});
  model.Fill({{3, 5, 7}, {50, 60, 40}}, Voxel::Of(9, 9, 9));
  const OctreeModel octree(model);
  EXPECT_EQ(Bound(octree, "descent")->bytes(), 0u);
  EXPECT_GE(Bound(octree, "neighbours")->bytes(), octree.CountNodes().nodes * 6 * 4);
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
    const VoxelHit hit = Bound(octree, "descent")->Walk(ray, {}, &counters),
                   other = Bound(raw, "grid")->Walk(ray, {}, &counters);
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
