// Meshes that are cut: their views, and the areas of the cuts.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/baseline/mesh_file.h"
#include "render/baseline/mesh_section.h"
#include "render/baseline/tracer.h"
#include "tests/support/shapes.h"
#include "tests/unit/baseline/meshes.h"

namespace facetless {
namespace {

using testing::BoxMesh;
using testing::OneNode;
using testing::SphereMesh;
using testing::Translation;

TEST(MeshSection, AreaOfABoxIsExact) {
  const Mesh mesh = OneNode(BoxMesh({10, 20, 30}), Translation({5, 6, 7}));
  EXPECT_NEAR(MeshSectionArea(mesh, {{0, 0, 20}, {0, 0, 1}}), 200, 1e-10);
  EXPECT_NEAR(MeshSectionArea(mesh, {{0, 0, 20}, {0, 0, -1}}), 200, 1e-10);
  EXPECT_NEAR(MeshSectionArea(mesh, {{10, 16, 22}, {0, std::sqrt(0.5), std::sqrt(0.5)}}),
              10 * 20 * std::sqrt(2.0), 1e-10);
  EXPECT_EQ(MeshSectionArea(mesh, {{0, 0, 38}, {0, 0, 1}}), 0);
}

TEST(MeshSection, AreaOfASphereIsThatOfItsPolygon) {
  const int sides = 64;
  const Mesh mesh = OneNode(SphereMesh(5, sides, 32));
  // Cut near the equator, which is a ring of vertices.
  const double polygon = 0.5 * sides * 25 * std::sin(2 * std::numbers::pi / sides);
  EXPECT_NEAR(MeshSectionArea(mesh, {{0, 0, 1e-4}, {0, 0, 1}}), polygon, 1e-3);
}

TEST(MeshSection, OfABallShowsACapWhereTheBallIsCut) {
  Mesh mesh = OneNode(SphereMesh(5, 96, 48));
  mesh.from_model = true;
  // The mesh belongs to this model: one closed solid with one face.
  const Model model = testing::ClosedSolid(testing::ModelOf({testing::Sphere({0, 0, 0}, 5)}), "ball");
  const SectionSolids solids(model);
  const SectionPlane plane{{0, 0, 2}, {0, 0, 1}};
  const auto scene = BaselineScene::Build(mesh, {}, /*to_be_cut=*/true);
  ASSERT_TRUE(scene.ok());
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Camera camera = NamedView("iso", MeshBounds(mesh), projection, 100, 100).value();
    const auto result = TraceBaseline(scene.value(), camera, {{}, {&plane, 1}, &solids});
    ASSERT_TRUE(result.ok()) << result.error().message;
    std::uint64_t caps = 0;
    for (std::size_t i = 0; i < result.value().samples.size(); ++i) {
      const double depth = result.value().samples.depth[i];
      if (!std::isfinite(depth)) continue;
      const Ray ray = PixelRay(result.value().frame, i % 100 + 0.5, i / 100 + 0.5);
      const Vec3 point = ray.origin + depth * ray.direction;
      EXPECT_LE(point.z, 2 + 1e-9);
      if (result.value().samples.face[i] != solids.CapId(0, 0)) {
        // The mesh itself lies within its chord error of the ball.
        EXPECT_NEAR(Length(point), 5, 0.02);
        continue;
      }
      ++caps;
      EXPECT_NEAR(point.z, 2, 1e-9);
      EXPECT_LE(Length(point), 5 + 1e-6);
    }
    EXPECT_GT(caps, 500u);
  }
}

TEST(MeshSection, NeedsAMeshThatIsPreparedForIt) {
  const Mesh mesh = OneNode(BoxMesh({1, 1, 1}));
  const auto scene = BaselineScene::Build(mesh, {});
  const SectionPlane plane{{0, 0, 0.5}, {0, 0, 1}};
  const Camera camera = NamedView("iso", MeshBounds(mesh), Projection::kOrthographic, 8, 8).value();
  EXPECT_EQ(TraceBaseline(scene.value(), camera, {{}, {&plane, 1}, nullptr}).error().code,
            ErrorCode::kBadUsage);
}

}  // namespace
}  // namespace facetless
