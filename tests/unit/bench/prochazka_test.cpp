// The tables of voxels: their form, and figures that follow from the model.
#include "bench/prochazka.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace facetless {
namespace {

constexpr int kDivisor = 16;

TEST(VoxelTablesOfTheThesis, TheCubeIsOneLeafOfThree) {
  const Result<VoxelBench> bench = MeasureVoxels(CubeOfThesis(), {.repeats = 1, .divisor = kDivisor});
  ASSERT_TRUE(bench.ok());
  const VoxelBench& cube = bench.value();
  EXPECT_EQ(cube.filled, 256u * 256 * 256);
  // The root, its children and the children of one of them.
  EXPECT_EQ(cube.nodes, 17u);
  EXPECT_EQ(cube.filled_leaves, 1u);
  EXPECT_EQ(cube.nodes - (cube.leaves - cube.filled_leaves), 3u);
  // The raw model is too large to be made, so that its walks are left out.
  EXPECT_EQ(cube.sizes.front().encoding, "raw");
  EXPECT_EQ(cube.sizes.front().bytes, 4.0 * 1024 * 1024 * 1024);
  for (const WalkFigures& walk : cube.walks) EXPECT_NE(walk.walk, "grid");
  ASSERT_EQ(cube.paths.size(), 3u);
  EXPECT_EQ(cube.paths[2].walk, "kd-shortstack:5");
}

TEST(VoxelTablesOfTheThesis, WalksOfAModel) {
  RunModel model({48, 40, 32});
  for (int x = 0; x < 48; ++x)
    for (int y = 0; y < 40; ++y)
      model.Fill({{x, y, 0}, {x + 1, y + 1, 3 + (x * x + 3 * y) % 19}}, Voxel::Of(90, 120, 60));
  const VoxelGrid grid{{0, 0, 0}, 2, model.size()};
  const Result<VoxelBench> bench =
      MeasureVoxels({"terrain", std::move(model), grid}, {.repeats = 2, .divisor = kDivisor});
  ASSERT_TRUE(bench.ok());
  // All walks, and the octree once more by tiles.
  ASSERT_EQ(bench.value().walks.size(), VoxelWalks().size() + 1);
  const std::uint64_t hits = bench.value().walks.front().pixels_hit;
  EXPECT_GT(hits, 100u);
  for (const WalkFigures& walk : bench.value().walks) {
    EXPECT_GT(walk.rays_per_second, 0) << walk.walk;
    EXPECT_EQ(walk.distortion.has_value(), walk.walk == "bresenham");
    if (!walk.distortion) {
      EXPECT_EQ(walk.pixels_hit, hits) << walk.walk;
      continue;
    }
    EXPECT_GT(walk.distortion->other_voxel, 0.01);
    EXPECT_LT(walk.distortion->other_voxel, 0.7);
    EXPECT_GT(walk.distortion->most_depth, 0);
  }
  const auto nodes = [&](std::size_t path) { return bench.value().paths[path].primary.nodes; };
  EXPECT_GT(nodes(0), nodes(1));  // restarting reads more nodes than going back
  EXPECT_GE(nodes(2), nodes(1));
  for (const PathFigures& path : bench.value().paths) {
    EXPECT_EQ(path.primary.steps, bench.value().paths[0].primary.steps);
    EXPECT_GT(path.shadow.rays, 0u);
    EXPECT_LE(path.best_ms, path.worst_ms);
  }

  const std::vector<Table> tables = VoxelTables({bench.value()});
  ASSERT_EQ(tables.size(), 7u);
  for (const Table& table : tables)
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << table.title;
  // The published figures of the model that corresponds to a terrain.
  EXPECT_NE(tables[0].rows[0][5].find("(44 MB)"), std::string::npos);
  EXPECT_NE(tables[3].rows[0][1].find("(8.87)"), std::string::npos);
  EXPECT_NE(tables[4].rows[0][2].find("(5.80)"), std::string::npos);
  EXPECT_NE(tables[5].rows[0][3].find("(288 / 40)"), std::string::npos);
  EXPECT_NE(tables[3].notes[1].find("times as fast as"), std::string::npos);
  const nlohmann::json json = VoxelBenchJson(bench.value());
  EXPECT_EQ(json["walks"].size(), bench.value().walks.size());
  EXPECT_EQ(json["paths"][0]["primary"]["nodes"], nodes(0));
}

}  // namespace
}  // namespace facetless
