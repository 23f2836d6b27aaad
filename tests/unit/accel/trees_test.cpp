// The trees: bounding volumes, octree, BSP tree, uni-tree and direction tree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <thread>

#include "render/accel/bsp_tree.h"
#include "render/accel/bvh.h"
#include "render/accel/direction_tree.h"
#include "render/accel/octree.h"
#include "render/accel/uni_tree.h"
#include "tests/unit/accel/box_scenes.h"

namespace facetless {
namespace {

using testing::SceneKind;

std::vector<Box3> Draw(SceneKind kind, std::size_t least) {
  testing::Engine engine(3);
  std::vector<Box3> boxes;
  while (boxes.size() < least) boxes = testing::DrawScene(kind, 2 * least, engine);
  return boxes;
}

QueryCounters CountersOf(const auto& structure, const std::vector<RaySegment>& rays) {
  QueryState state(structure.state_size());
  for (const RaySegment& ray : rays) structure.Visit(ray, state, [](std::uint32_t) { return INFINITY; });
  return state.counters;
}

RC_GTEST_PROP(Bvh, BothBuildersPutEachObjectIntoOneLeaf, (std::uint64_t seed)) {
  testing::Engine engine(seed);
  const SceneKind kind = testing::kSceneKinds[engine() % std::size(testing::kSceneKinds)];
  const std::vector<Box3> boxes = testing::DrawScene(kind, 500, engine);
  if (boxes.empty()) return;
  const BoxSet set(boxes);
  for (const BvhTree& tree : {BuildTopDown(set), BuildBottomUp(set)}) {
    std::vector<int> seen(boxes.size(), 0);
    std::vector<std::uint32_t> below{tree.root};
    while (!below.empty()) {
      const std::uint32_t child = below.back();
      below.pop_back();
      if (child & BvhTree::kObject) {
        ++seen.at(child & ~BvhTree::kObject);
        continue;
      }
      const BvhTree::Node& node = tree.nodes.at(child);
      for (const std::uint32_t of : {node.left, node.right}) {
        // A node's box is the common box of what is below it.
        const SlabBox& box = of & BvhTree::kObject ? set[of & ~BvhTree::kObject] : tree.nodes[of].box;
        const SlabBox both = UnionOf(box, node.box);
        RC_ASSERT(std::equal(&both.side[0][0], &both.side[0][0] + 6, &node.box.side[0][0]));
        below.push_back(of);
      }
    }
    RC_ASSERT(std::ranges::all_of(seen, [](int times) { return times == 1; }));
  }
}

TEST(Bvh, BothBuildersMakeTreesThatTestFewBoxes) {
  const std::vector<Box3> boxes = Draw(SceneKind::kUniform, 2000);
  testing::Engine engine(4);
  const std::vector<RaySegment> rays = testing::DrawRays(boxes, 200, engine);
  for (const BvhBuild build : {BvhBuild::kTopDown, BvhBuild::kBottomUp}) {
    const Bvh bvh(boxes, build);
    const QueryCounters counters = CountersOf(bvh, rays);
    EXPECT_LT(counters.tests, boxes.size() * counters.rays / 10);
    EXPECT_GT(bvh.ExpectedTests(), 2);
    EXPECT_LT(bvh.ExpectedTests(), static_cast<double>(boxes.size()));
    EXPECT_EQ(bvh.figures().references, static_cast<double>(boxes.size())) << "nothing is listed twice";
  }
}

TEST(Octree, BothRestartsVisitTheSameLeaves) {
  for (const SceneKind kind : {SceneKind::kUniform, SceneKind::kClustered, SceneKind::kTiles}) {
    const std::vector<Box3> boxes = Draw(kind, 300);
    testing::Engine engine(4);
    const std::vector<RaySegment> rays = testing::DrawRays(boxes, 300, engine);
    const QueryCounters root = CountersOf(Octree(boxes, OctreeRestart::kRoot), rays),
                        ancestor = CountersOf(Octree(boxes, OctreeRestart::kCommonAncestor), rays);
    EXPECT_GT(root.regions, root.rays);
    EXPECT_EQ(root.regions, ancestor.regions);
    EXPECT_EQ(root.tests, ancestor.tests);
    EXPECT_EQ(root.repeats, ancestor.repeats);
  }
}

TEST(Octree, WhatDoesNotSeparateIsNotDivided) {
  const std::vector<Box3> same(1000, Box3{{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(Octree(same).figures().regions, 1);
  EXPECT_GT(Octree(Draw(SceneKind::kUniform, 300)).figures().regions, 8);
}

TEST(BspTree, LeavesHoldFewAndCopiesAreFew) {
  const std::vector<Box3> boxes = Draw(SceneKind::kClustered, 1000);
  const BspTree tree(boxes);
  const StructureFigures figures = tree.figures();
  EXPECT_LT(figures.references / figures.regions, 2 * BspTree::kFew);
  EXPECT_LT(figures.references, 4 * static_cast<double>(boxes.size()));
  const std::vector<Box3> same(1000, Box3{{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(BspTree(same).figures().regions, 1) << "no plane separates them";
}

TEST(UniTree, NothingIsListedTwice) {
  for (const SceneKind kind : testing::kSceneKinds) {
    testing::Engine engine(5);
    const std::vector<Box3> boxes = testing::DrawScene(kind, 500, engine);
    EXPECT_EQ(UniTree(boxes).figures().references, static_cast<double>(boxes.size()));
  }
  EXPECT_GT(UniTree(Draw(SceneKind::kUniform, 300)).figures().regions, 8);
}

TEST(DirectionTree, TheSourcesEstimateIsReproduced) {
  EXPECT_NEAR(DirectionTreeEstimate(3, 8), 0.0156, 0.00003);
}

TEST(DirectionTree, NodesAreMadeOnDemandAndOnce) {
  const std::vector<Box3> boxes = Draw(SceneKind::kUniform, 500);
  const DirectionTree tree(boxes);
  const std::size_t at_first = tree.node_bytes();
  testing::Engine engine(4);
  const std::vector<RaySegment> rays = testing::DrawRays(boxes, 100, engine);
  const QueryCounters first = CountersOf(tree, rays);
  const std::size_t made = tree.node_bytes();
  EXPECT_GT(made, at_first);
  const QueryCounters second = CountersOf(tree, rays);
  EXPECT_EQ(tree.node_bytes(), made) << "the same rays need nothing new";
  EXPECT_EQ(first.tests, second.tests);
  EXPECT_LT(first.tests, first.rays * boxes.size() / 2);
  EXPECT_GT(tree.figures().depth, 1);
}

TEST(DirectionTree, ItsMemoryIsCapped) {
  const std::vector<Box3> boxes = Draw(SceneKind::kUniform, 500);
  const std::size_t roots = DirectionTree(boxes).node_bytes(), most = 2 * roots;
  const DirectionTree tree(boxes, {.most_bytes = most});
  testing::Engine engine(4);
  const std::vector<RaySegment> rays = testing::DrawRays(boxes, 1000, engine);
  CountersOf(tree, rays);
  EXPECT_GE(tree.node_bytes(), most) << "the cap was reached";
  EXPECT_LT(tree.node_bytes(), most + roots) << "one node beyond it";
  // It still finds everything.
  QueryState state(tree.state_size());
  for (const RaySegment& ray : rays) {
    testing::ObjectHit nearest;
    tree.Visit(ray, state, [&](std::uint32_t id) {
      testing::AskObject(testing::ObjectKind::kBox, boxes, ray, id, nearest);
      return nearest.t;
    });
    EXPECT_EQ(nearest, testing::NearestByScan(testing::ObjectKind::kBox, boxes, ray));
  }
}

TEST(DirectionTree, ThreadsThatNeedTheSameNodesMakeThemOnce) {
  const std::vector<Box3> boxes = Draw(SceneKind::kUniform, 500);
  testing::Engine engine(4);
  const std::vector<RaySegment> rays = testing::DrawRays(boxes, 200, engine);
  const DirectionTree alone(boxes), shared(boxes);
  CountersOf(alone, rays);
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread) threads.emplace_back([&] { CountersOf(shared, rays); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(shared.node_bytes(), alone.node_bytes());
}

}  // namespace
}  // namespace facetless
