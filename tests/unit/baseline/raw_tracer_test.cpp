// Embree alone sees the same triangles as the baseline, at the same depth to float32.
#include "render/baseline/raw_tracer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/baseline/mesh_file.h"
#include "tests/unit/baseline/meshes.h"

namespace facetless {
namespace {

using testing::BoxMesh;
using testing::OneNode;
using testing::SphereMesh;

// The size is no multiple of a packet or a tile.
constexpr int kWidth = 101, kHeight = 67;

Camera View(const Mesh& mesh, Projection projection) {
  return NamedView("iso", MeshBounds(mesh), projection, kWidth, kHeight).value();
}

TEST(RawTracer, SeesWhatTheBaselineSees) {
  const Mesh mesh = OneNode(SphereMesh(5, 256, 128));
  const BaselineScene scene = BaselineScene::Build(mesh, {.threads = 2}).value();
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Camera camera = View(mesh, projection);
    const RawResult raw = TraceRaw(scene, camera, {.threads = 2}).value();
    const BaselineResult baseline = TraceBaseline(scene, camera, {{.threads = 2}}).value();
    ASSERT_EQ(raw.distance.size(), std::size_t{kWidth} * kHeight);
    std::size_t hits = 0, differing = 0;
    for (std::size_t i = 0; i < raw.distance.size(); ++i) {
      const bool hit = std::isfinite(raw.distance[i]);
      EXPECT_EQ(hit, raw.triangle[i] != kNoIndex);
      hits += hit;
      // Steps in float32 move a ray by less than a thousandth of a pixel, which only the outline shows.
      differing += hit != std::isfinite(baseline.samples.depth[i]);
      if (!hit || !std::isfinite(baseline.samples.depth[i])) continue;
      EXPECT_NEAR(raw.start_mm + static_cast<double>(raw.distance[i]), baseline.samples.depth[i], 1e-2);
    }
    EXPECT_GT(hits, 500u);
    EXPECT_LE(differing, 2u);
  }
}

TEST(RawTracer, NamesTheTriangle) {
  const Mesh mesh = OneNode(BoxMesh({10, 20, 30}));
  const BaselineScene scene = BaselineScene::Build(mesh, {.threads = 1}).value();
  const Camera camera = View(mesh, Projection::kOrthographic);
  const RawResult raw = TraceRaw(scene, camera, {.threads = 1}).value();
  const BaselineResult baseline = TraceBaseline(scene, camera, {{.threads = 1}}).value();
  std::size_t checked = 0;
  for (std::size_t i = 0; i < raw.triangle.size(); ++i) {
    if (raw.triangle[i] == kNoIndex || baseline.samples.face[i] == kNoIndex) continue;
    ASSERT_LT(raw.triangle[i], mesh.parts[0].triangles.size());
    checked += mesh.parts[0].face_of_triangle[raw.triangle[i]] == baseline.samples.face[i];
  }
  EXPECT_GT(checked, 1000u);
  EXPECT_LE(baseline.stats.hits - checked, 20u) << "only pixels on an edge may show another face";
}

TEST(RawTracer, StopsWhenItIsTold) {
  const Mesh mesh = OneNode(BoxMesh({10, 20, 30}));
  const BaselineScene scene = BaselineScene::Build(mesh, {.threads = 1}).value();
  const std::atomic<bool> stop{true};
  const auto raw = TraceRaw(scene, View(mesh, Projection::kOrthographic), {.threads = 1, .cancel = &stop});
  ASSERT_FALSE(raw.ok());
  EXPECT_EQ(raw.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace facetless
