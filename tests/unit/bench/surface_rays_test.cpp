// Rays on exact surfaces in every structure: the answers agree, and a mesh of the same ball answers some wrongly.
#include "bench/surface_rays.h"

#include <gtest/gtest.h>

#include "render/view/secondary_rays.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

TEST(SurfaceRays, EveryStructureGivesTheSameAnswers) {
  const Model model = testing::ClosedSolid(testing::ModelOf({testing::Torus({0, 0, 0}, 5, 2)}));
  const Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 64, 64).value();
  const Mesh mesh = testing::BallMesh(6, 32);
  const SurfaceRayBench bench =
      MeasureSurfaceRays({"torus", &model, camera, &mesh, 0.01}, {.repeats = 1, .rays = 300}, {.threads = 1})
          .value();
  EXPECT_GT(bench.starts, 250u);
  ASSERT_EQ(bench.rows.size(), StructureNames().size() + 1);
  EXPECT_EQ(bench.rows[0].name, kUsualStructure);
  for (const SurfaceRayRow& row : bench.rows)
    for (const SurfaceRayCost& cost : row.kinds) {
      EXPECT_GE(cost.rays, 64u) << row.name;
      EXPECT_GT(cost.per_second, 0) << row.name;
      EXPECT_GT(cost.certified, 0.98) << row.name;
      EXPECT_EQ(cost.unlike, 0u) << row.name;
    }
  // The ball hides the torus, so that many answers of this mesh are wrong.
  const SurfaceRayPeer& ambient = bench.peers[static_cast<std::size_t>(BenchRays::kAmbient)];
  EXPECT_GT(ambient.per_second, 0);
  EXPECT_GT(ambient.ratio, 0);
  EXPECT_GT(ambient.wrong, 0.2);
  EXPECT_EQ(bench.peers[static_cast<std::size_t>(BenchRays::kPrimary)].per_second, 0)
      << "it is not asked for hits";

  const Table table = SurfaceRayTable(bench);
  EXPECT_EQ(table.rows.size(), bench.rows.size() + 1);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  const nlohmann::json json = SurfaceRayJson(bench);
  EXPECT_EQ(json["structures"].size(), bench.rows.size());
  EXPECT_EQ(json["embree"].size(), 2u);
  EXPECT_NE(SurfaceRayPlot({bench}).find("direction-tree"), std::string::npos);
  EXPECT_NE(SurfaceRayPlot({}).find("No file was measured"), std::string::npos);
}

TEST(SurfaceRays, AViewOfNothingIsAnError) {
  const Model model = testing::ClosedSolid(testing::ModelOf({testing::Sphere({0, 0, 0}, 5)}));
  Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 16, 16).value();
  camera.eye = camera.eye + Vec3{1000, 0, 0};
  camera.target = camera.target + Vec3{1000, 0, 0};
  EXPECT_EQ(MeasureSurfaceRays({"away", &model, camera, nullptr, 0}, {}, {.threads = 1}).error().code,
            ErrorCode::kNothingUsable);
}

}  // namespace
}  // namespace facetless
