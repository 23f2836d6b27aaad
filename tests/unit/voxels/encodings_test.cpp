// The encodings of voxel models: all hold the same voxels, whatever is done to them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

#include "render/voxels/adaptive_octree_model.h"
#include "render/voxels/n3_tree_model.h"
#include "render/voxels/octree_model.h"
#include "render/voxels/raw_model.h"
#include "render/voxels/run_model.h"
#include "tests/support/random_voxels.h"

namespace facetless {
namespace {

using testing::AnyBox;
using testing::AnyModel;
using testing::AnySize;
using testing::AnyVoxel;
using ::testing::HasSubstr;

constexpr int kMost = 19;

std::vector<std::string> Names() {
  std::vector<std::string> names;
  for (const VoxelEncoding& encoding : VoxelEncodings()) names.emplace_back(encoding.name);
  return names;
}

TEST(VoxelEncodings, AreNamed) {
  EXPECT_THAT(Names(), ::testing::ElementsAre("raw", "runs", "octree", "adaptive-octree", "n3-tree"));
  for (const std::string& name : Names()) {
    const auto made = MakeVoxelModel(name, {3, 4, 5});
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(made.value()->encoding(), name);
    EXPECT_EQ(made.value()->Count(), 0u);
    EXPECT_FALSE(made.value()->Get(2, 3, 4).filled());
  }
}

TEST(VoxelEncodings, RefuseWhatIsNoModel) {
  const auto unknown = MakeVoxelModel("sparse", {1, 1, 1});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kBadUsage);
  EXPECT_THAT(unknown.error().message, HasSubstr("raw, runs, octree, adaptive-octree, n3-tree"));
  for (const VoxelPoint size : {VoxelPoint{0, 1, 1}, {1, -1, 1}, {1, 1, kMostVoxelsPerAxis + 1}})
    EXPECT_EQ(MakeVoxelModel("runs", size).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(MakeVoxelModel("raw", {1024, 1024, 1024}, 1 << 20).error().code, ErrorCode::kLimitExceeded);
}

RC_GTEST_PROP(VoxelEncodings, EveryPairConvertsWithoutLoss, ()) {
  const RunModel model = AnyModel(kMost);
  for (const std::string& first : Names()) {
    const auto a = Converted(model, first);
    RC_ASSERT(a.ok());
    RC_ASSERT(SameVoxels(model, *a.value()));
    RC_ASSERT(a.value()->Count() == model.Count());
    for (const std::string& second : Names()) {
      const auto b = Converted(*a.value(), second);
      RC_ASSERT(b.ok() && SameVoxels(model, *b.value()));
    }
  }
}

RC_GTEST_PROP(VoxelEncodings, GetIsWhatColumnsHold, ()) {
  const RunModel model = AnyModel(9);
  for (const std::string& name : Names()) {
    const auto other = Converted(model, name);
    for (int x = -1; x <= model.size().x; ++x)
      for (int y = -1; y <= model.size().y; ++y)
        for (int z = -1; z <= model.size().z; ++z)
          RC_ASSERT(other.value()->Get(x, y, z) == model.Get(x, y, z));
  }
}

RC_GTEST_PROP(VoxelEncodings, EditsAreTheSame, ()) {
  const VoxelPoint size = AnySize(kMost);
  std::map<std::string, std::unique_ptr<VoxelModel>> models;
  for (const std::string& name : Names()) models[name] = MakeVoxelModel(name, size).value();
  const int edits = *rc::gen::inRange(1, 8);
  for (int edit = 0; edit < edits; ++edit) {
    const VoxelBox box = AnyBox(size);
    const Voxel voxel = AnyVoxel();
    const int kind = *rc::gen::inRange(0, 3);
    const VoxelPoint at = AnyBox(size).low;
    for (auto& [name, model] : models) {
      if (kind == 0) model->Fill(box, voxel);
      if (kind == 1) model->Copy(*models["runs"], box, at);
      if (kind == 2) model->Set(at.x, at.y, at.z, voxel);
    }
    // A copy within "runs" itself comes first in the order of the names only for some; bring them together again.
    if (kind == 1)
      for (auto& [name, model] : models) model = Converted(*models["raw"], name).value();
    for (auto& [name, model] : models) RC_ASSERT(SameVoxels(*models["raw"], *model));
  }
}

RC_GTEST_PROP(VoxelEncodings, MeansAreTheSame, ()) {
  const RunModel model = AnyModel(kMost);
  const VoxelPoint size = model.size();
  const VoxelPoint p{*rc::gen::inRange(0, size.x), *rc::gen::inRange(0, size.y),
                     *rc::gen::inRange(0, size.z)};
  const int level = *rc::gen::inRange(0, 7);
  const VoxelMean expected = model.GetMean(p.x, p.y, p.z, level);
  for (const std::string& name : Names()) {
    const VoxelMean mean = Converted(model, name).value()->GetMean(p.x, p.y, p.z, level);
    RC_ASSERT(mean.voxel == expected.voxel);
    RC_ASSERT(mean.share == expected.share);
  }
}

TEST(VoxelMeans, AreWeightedByFilledVoxels) {
  RunModel model({4, 4, 4});
  model.Set(0, 0, 0, Voxel::Of(10, 0, 0, 3));
  model.Set(1, 0, 0, Voxel::Of(20, 0, 0, 4));
  model.Set(3, 3, 3, Voxel::Of(90, 60, 30, 5));
  EXPECT_EQ(model.GetMean(1, 1, 1, 1).voxel, Voxel::Of(15, 0, 0, 3));
  EXPECT_DOUBLE_EQ(model.GetMean(1, 1, 1, 1).share, 2 / 8.0);
  EXPECT_EQ(model.GetMean(0, 0, 0, 2).voxel, Voxel::Of(40, 20, 10, 3));
  EXPECT_DOUBLE_EQ(model.GetMean(0, 0, 0, 2).share, 3 / 64.0);
}

RC_GTEST_PROP(Octree, BothWaysOfCompilingGiveTheSameTree, ()) {
  const RunModel model = AnyModel(kMost);
  const OctreeModel down(model), up = OctreeModel::BottomUp(model);
  RC_ASSERT(down.SameTree(up));
  // So do edits one by one.
  OctreeModel edited(model.size());
  for (int x = 0; x < model.size().x; ++x)
    for (int y = 0; y < model.size().y; ++y)
      for (int z = 0; z < model.size().z; ++z) edited.Set(x, y, z, model.Get(x, y, z));
  RC_ASSERT(edited.SameTree(down));
  RC_ASSERT(edited.Count() == model.Count());
}

// The test of optimality: no node has eight children that are the same leaf.
RC_GTEST_PROP(Octree, IsOptimalAfterEveryEdit, ()) {
  OctreeModel model(AnySize(kMost));
  for (int edit = 0; edit < 6; ++edit) {
    model.Fill(AnyBox(model.size()), AnyVoxel());
    std::vector<OctreeNode> waiting{model.root()};
    while (!waiting.empty()) {
      const OctreeNode node = waiting.back();
      waiting.pop_back();
      if (node.leaf()) continue;
      const OctreeNode* children = model.Children(node);
      bool same = children[0].leaf();
      for (int child = 0; child < 8; ++child) {
        same = same && children[child] == children[0];
        waiting.push_back(children[child]);
      }
      RC_ASSERT(!same);
    }
    RC_ASSERT(model.SameTree(OctreeModel(RunsOf(model))));
  }
}

TEST(Octree, ACubeIsThreeNodesAtMost) {
  OctreeModel model({64, 64, 64});
  model.Fill({{0, 0, 0}, {64, 64, 64}}, Voxel::Of(1, 2, 3));
  EXPECT_EQ(model.CountNodes().nodes, 1u);
  EXPECT_EQ(model.Count(), 64u * 64 * 64);
  model.Fill({{32, 0, 0}, {64, 64, 64}}, {});
  EXPECT_EQ(model.CountNodes().nodes, 9u);
  EXPECT_EQ(model.CountNodes().filled_leaves, 4u);
}

// The seed's theorem: an adaptive octree is never larger than the raw model, and never larger than the octree.
RC_GTEST_PROP(AdaptiveOctree, IsNeverLargerThanRaw, ()) {
  RunModel model = AnyModel(kMost);
  // Noise is what octrees are worst at.
  if (*rc::gen::arbitrary<bool>())
    for (int x = 0; x < model.size().x; ++x)
      for (int y = 0; y < model.size().y; ++y)
        for (int z = 0; z < model.size().z; ++z)
          if ((x * 73856093u ^ y * 19349663u ^ z * 83492791u) & 16u)
            model.Set(x, y, z, Voxel::Of(static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 9));
  const AdaptiveOctreeModel adaptive(model);
  RC_ASSERT(adaptive.encoded_bytes() <= RawModel::BytesOf(model.size()));
  const OctreeModel octree(model);
  const OctreeModel::Figures figures = octree.CountNodes();
  RC_ASSERT(adaptive.encoded_bytes() <= (figures.nodes - 1) * sizeof(OctreeNode));
}

RC_GTEST_PROP(N3Tree, AnyNAndM, ()) {
  const RunModel model = AnyModel(kMost);
  const int n = 1 << *rc::gen::inRange(1, 4), m = 1 << *rc::gen::inRange(0, 5);
  const N3TreeModel tree(model, n, m);
  RC_ASSERT(tree.n() == n && tree.m() == m);
  RC_ASSERT(SameVoxels(tree, model));
  const VoxelPoint size = model.size();
  const VoxelPoint p{*rc::gen::inRange(0, size.x), *rc::gen::inRange(0, size.y),
                     *rc::gen::inRange(0, size.z)};
  for (int level = 0; level < 6; ++level)
    RC_ASSERT(tree.GetMean(p.x, p.y, p.z, level).voxel == model.GetMean(p.x, p.y, p.z, level).voxel);
}

TEST(N3Tree, WithTwoAndOneIsTheOctree) {
  RunModel model({16, 16, 16});
  model.Fill({{1, 2, 3}, {9, 10, 11}}, Voxel::Of(9, 9, 9));
  model.Set(15, 15, 15, Voxel::Of(1, 1, 1));
  const OctreeModel::Figures octree = OctreeModel(model).CountNodes();
  const N3TreeModel tree(model, 2, 1);
  EXPECT_EQ(tree.node_count(), octree.nodes);
  EXPECT_EQ(tree.brick_count(), 0u);
}

TEST(RunModel, BytesFollowTheSurface) {
  // A ball: the runs grow with the square of the resolution.
  const auto ball = [](int n) {
    RunModel model({n, n, n});
    const double r = n / 2.0;
    for (int x = 0; x < n; ++x)
      for (int y = 0; y < n; ++y) {
        const double h2 = r * r - (x + 0.5 - r) * (x + 0.5 - r) - (y + 0.5 - r) * (y + 0.5 - r);
        if (h2 > 0) {
          const int half = static_cast<int>(std::sqrt(h2));
          const VoxelRun run{n / 2 - half, n / 2 + half, Voxel::Of(8, 8, 8)};
          model.SetColumn(x, y, {&run, 1});
        }
      }
    return model;
  };
  const double ratio = static_cast<double>(ball(256).bytes()) / static_cast<double>(ball(64).bytes());
  EXPECT_LT(ratio, 24);
  EXPECT_GT(ratio, 8);
}

}  // namespace
}  // namespace facetless
