// The comparison of structures: rays, answers that agree, and what is reported of them.
#include "bench/structure_bench.h"

#include <gtest/gtest.h>

#include "bench/leaf_boxes.h"
#include "bench/volume_check.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

TEST(LeafBoxes, CoverTheSurfaceInSmallPieces) {
  const Model model = testing::ModelOf({testing::Torus({0, 0, 0}, 20, 6)});
  const std::vector<Box3> boxes = LeafBoxes(model, 100'000);
  ASSERT_GT(boxes.size(), 100u);
  Box3 bounds;
  for (const Box3& box : boxes) {
    bounds.Add(box.low), bounds.Add(box.high);
    EXPECT_LT(box.diagonal(), 10) << "a piece is nearly flat";
  }
  EXPECT_NEAR(bounds.high.x, 26, 0.01);
  EXPECT_NEAR(bounds.low.z, -6, 0.01);
  // Every point of the surface lies in a box.
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const double around = 0.1 * i, tube = 0.1 * j, ring = 20 + 6 * std::cos(tube);
      const Vec3 p{ring * std::cos(around), ring * std::sin(around), 6 * std::sin(tube)};
      EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Box3& box) {
        constexpr double kRounding = 1e-9;
        return p.x >= box.low.x - kRounding && p.x <= box.high.x + kRounding &&
               p.y >= box.low.y - kRounding && p.y <= box.high.y + kRounding &&
               p.z >= box.low.z - kRounding && p.z <= box.high.z + kRounding;
      }));
    }
  EXPECT_LT(LeafBoxes(model, 50).size(), boxes.size());
}

TEST(StructureBench, AllStructuresAgreeAndAreReported) {
  // Scenes whose cubes are so large that some rays of each kind hit one.
  const std::vector<BoxScenery> scenes = RandomBoxSceneries();
  for (const BoxScenery& scene : {scenes[0], scenes[1]}) {
    const std::vector<Box3> boxes(scene.boxes.begin(), scene.boxes.begin() + 500);
    const auto bench = MeasureStructures(scene.name, boxes, BoxEntry{boxes}, {.repeats = 1, .rays = 1600});
    ASSERT_TRUE(bench);
    ASSERT_EQ(bench.value().rows.size(), StructureNames().size());
    for (const StructureRow& row : bench.value().rows) {
      EXPECT_GT(row.bytes, 0u) << row.name;
      for (const StructureRays& rays : row.kinds) {
        EXPECT_EQ(rays.unlike, 0u) << row.name;
        EXPECT_GT(rays.rays, 0u) << row.name;
        EXPECT_GT(rays.hits, 0u) << row.name;
        EXPECT_GT(rays.ns_per_ray, 0) << row.name;
      }
    }
    const std::vector<Table> tables = StructureTables(bench.value());
    ASSERT_EQ(tables.size(), 2u);
    for (const Table& table : tables)
      for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
    const nlohmann::json json = StructureJson(bench.value());
    EXPECT_EQ(json.at("structures").size(), StructureNames().size());
    EXPECT_EQ(json.at("structures").at(0).at("rays").size(), 4u);
  }
}

TEST(VolumeCheck, TheModelAndTheClockAreBothReported) {
  const std::vector<BoxScenery> scenes = RandomBoxSceneries();
  const std::vector<Box3> boxes(scenes[0].boxes.begin(), scenes[0].boxes.begin() + 300);
  const std::vector<RaySegment> rays = RandomRays({{0, 0, 0}, {1, 1, 1}}, 50);
  const std::vector<VolumeCheck> checks = CheckVolumeModel(boxes, rays);
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_GT(checks[1].intersect_ns, checks[0].intersect_ns);
  for (const VolumeCheck& check : checks) {
    EXPECT_EQ(check.boxes + check.spheres, boxes.size());
    for (const VolumeCheck::Cost& cost : {check.all_boxes, check.all_spheres, check.chosen}) {
      EXPECT_GT(cost.predicted_ns, 0);
      EXPECT_GT(cost.measured_ns, 0);
    }
  }
  EXPECT_EQ(VolumeTable("cubes", checks).rows.size(), 2u);
  EXPECT_EQ(VolumeJson(checks).size(), 2u);
}

TEST(StructureBench, OnlySourcesWithAnEstimateHaveOne) {
  StructureRow row;
  row.figures = {8 * 8 * 8, 1.1 * 1000, 1};
  row.kinds[static_cast<int>(BenchRays::kRandom)].regions = 3;
  row.name = "grid";
  EXPECT_NEAR(SourceEstimate(row, 1000), 0.0065, 0.00006);
  row.name = "embree";
  EXPECT_EQ(SourceEstimate(row, 1000), 0);
}

}  // namespace
}  // namespace facetless
