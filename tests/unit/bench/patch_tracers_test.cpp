// Martin's method, Newton–Cramer and the direct renderer find the same roots.
#include "bench/patch_tracers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/bernstein.h"
#include "bench/sisojevs.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

constexpr int kSize = 96;

TEST(Bernstein, EvaluatesAPolynomialAndItsSlopes) {
  // f = u²·v on a net of degrees 2 and 1.
  const std::array<double, 1> net[] = {{0}, {0}, {0}, {0}, {0}, {1}};
  const PatchJet<1> jet = EvaluatePatch<1>(net, 2, 1, 0.3, 0.7);
  EXPECT_NEAR(jet.value[0], 0.3 * 0.3 * 0.7, 1e-15);
  EXPECT_NEAR(jet.du[0], 2 * 0.3 * 0.7, 1e-15);
  EXPECT_NEAR(jet.dv[0], 0.3 * 0.3, 1e-15);
}

TEST(PatchTree, PiecesHoldTheirSurface) {
  for (const NamedScene& scene : PatchScenes()) {
    SCOPED_TRACE(scene.name);
    ASSERT_TRUE(Validate(scene.model).ok()) << Validate(scene.model).error().message;
    const std::vector<ScenePatch> patches = PatchesOf(scene.model);
    const PatchTree tree = BuildPatchTree(patches, kFlattening);
    std::vector<double> area(patches.size(), 0);
    for (const PatchPiece& piece : tree.pieces) {
      area[piece.patch] += (piece.u_high - piece.u_low) * (piece.v_high - piece.v_low);
      for (const double s : {0.0, 0.4, 1.0})
        for (const double t : {0.0, 0.7, 1.0}) {
          const ScenePatch& patch = patches[piece.patch];
          const double u = piece.u_low + s * (piece.u_high - piece.u_low),
                       v = piece.v_low + t * (piece.v_high - piece.v_low);
          const auto jet = EvaluatePatch<4>(patch.points.data(), patch.degree_u, patch.degree_v, u, v);
          const Vec3 p = (1 / jet.value[3]) * Vec3{jet.value[0], jet.value[1], jet.value[2]};
          const Box3& box = piece.box;
          ASSERT_TRUE(box.low.x <= p.x && p.x <= box.high.x && box.low.y <= p.y && p.y <= box.high.y &&
                      box.low.z <= p.z && p.z <= box.high.z);
        }
    }
    for (const double covered : area) EXPECT_NEAR(covered, 1, 1e-12);
    // Every node contains its children, and every piece occurs in the tree once.
    std::size_t leaves = 0;
    for (const PatchTreeNode& node : tree.nodes) {
      leaves += node.leaf;
      if (node.leaf) continue;
      for (const std::uint32_t child : {node.first, node.first + 1}) {
        Box3 both = node.box;
        both.Add(tree.nodes[child].box.low);
        both.Add(tree.nodes[child].box.high);
        EXPECT_EQ(both.diagonal(), node.box.diagonal());
      }
    }
    EXPECT_EQ(leaves, tree.pieces.size());
  }
}

TEST(PatchTracers, FindTheDirectRenderersRoots) {
  for (const NamedScene& scene : PatchScenes()) {
    SCOPED_TRACE(scene.name);
    const ThesisScene measured = MeasureThesisScene(scene, kSize, 1).value();
    EXPECT_GT(measured.direct.hits, 500u);
    EXPECT_EQ(measured.direct.unresolved, 0u);
    for (const DepthDifferences& differences :
         {measured.martin_differences, measured.newton_cramer_differences}) {
      EXPECT_EQ(differences.only_first, 0u) << "a root that the certified image does not have";
      // The stopping rules of the methods may lose roots at silhouettes.
      EXPECT_LE(differences.only_second + differences.apart, measured.direct.hits / 500);
      EXPECT_GT(differences.both_hit, 500u);
    }
    // The methods differ in the step, not in the pieces that they solve.
    EXPECT_LE(measured.newton_cramer.solves, 2 * measured.martin.solves);
    EXPECT_GE(measured.newton_cramer.iterations, measured.newton_cramer.solves / 2);
  }
}

TEST(PatchTracers, MeetASphereWhereItIs) {
  const double radius = 10;
  const Model ball = testing::ModelOf({testing::Sphere({0, 0, 0}, radius)});
  const Camera camera = NamedView("iso", ball.bounds, Projection::kOrthographic, kSize, kSize).value();
  const CameraFrame frame = MakeFrame(camera, ball.Diagonal()).value();
  const std::vector<ScenePatch> patches = PatchesOf(ball);
  for (const PatchImage& image :
       {TraceMartin(patches, frame, kSize, kSize), TraceNewtonCramer(patches, frame, kSize, kSize)}) {
    int hits = 0, missed = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const Ray ray = PixelRay(frame, x + 0.5, y + 0.5);
        const double along = -Dot(ray.origin, ray.direction),
                     distance2 = Dot(ray.origin, ray.origin) - along * along;
        const double depth = image.depth[static_cast<std::size_t>(y * kSize + x)];
        if (distance2 > radius * radius) {
          EXPECT_EQ(depth, INFINITY);
          continue;
        }
        const double expected = along - std::sqrt(radius * radius - distance2);
        hits += std::fabs(depth - expected) < 1e-6;
        missed += !(std::fabs(depth - expected) < 1e-6);
      }
    EXPECT_GT(hits, 2000);
    EXPECT_LE(missed, 5) << "at the silhouette";
  }
}

TEST(ThesisTables, HaveARowForEachScene) {
  std::vector<ThesisScene> scenes(4);
  for (ThesisScene& scene : scenes) scene.martin_ms = 2, scene.newton_cramer_ms = 1, scene.direct.rays = 100;
  const std::vector<Table> tables = ThesisTables(scenes);
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[0].rows.size(), 4u);
  EXPECT_EQ(tables[1].rows.size(), 12u);
  EXPECT_EQ(tables[0].rows[1][4], "50.0 %");
  EXPECT_EQ(tables[0].rows[1][5], "75.9 %") << "of the thesis's 27 ducks";
  const nlohmann::json json = ThesisJson(scenes);
  EXPECT_EQ(nlohmann::json::parse(json.dump()), json);
}

}  // namespace
}  // namespace facetless
