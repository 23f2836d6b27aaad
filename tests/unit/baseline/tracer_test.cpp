// The baseline against closed forms: the position of the triangles, the accuracy of the depth, and
// independence of everything that must not matter.
#include "render/baseline/tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "render/baseline/mesh_file.h"
#include "tests/unit/baseline/meshes.h"

namespace facetless {
namespace {

using testing::BoxMesh;
using testing::OneNode;
using testing::SphereMesh;
using testing::Translation;

BaselineResult Trace(const Mesh& mesh, const Camera& camera, int threads = 0) {
  const Result<BaselineScene> scene = BaselineScene::Build(mesh, {.threads = threads});
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  Result<BaselineResult> result = TraceBaseline(scene.value(), camera, {{.threads = threads}});
  EXPECT_TRUE(result.ok()) << result.error().message;
  return std::move(result).value();
}

Camera View(const Mesh& mesh, const std::string& name, Projection projection, int size = 64) {
  return NamedView(name, MeshBounds(mesh), projection, size, size).value();
}

TEST(Baseline, DepthOfAPlaneIsExactInDouble) {
  // A side of the box is seen head-on and at an angle. The depth follows from the camera alone.
  const Mesh mesh = OneNode(BoxMesh({10, 20, 30}));
  for (const char* name : {"front", "right", "top", "iso"})
    for (Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      const Camera camera = View(mesh, name, projection);
      const BaselineResult result = Trace(mesh, camera);
      std::size_t checked = 0;
      for (std::size_t i = 0; i < result.samples.size(); ++i) {
        if (!std::isfinite(result.samples.depth[i])) continue;
        const Ray ray = PixelRay(result.frame, i % 64 + 0.5, i / 64 + 0.5);
        const Vec3 p = ray.origin + result.samples.depth[i] * ray.direction;
        // The point must lie on the side that the face id names.
        const std::uint32_t face = result.samples.face[i];
        const double along[3] = {p.x, p.y, p.z}, extent[3] = {10, 20, 30};
        EXPECT_NEAR(along[face / 2], face % 2 ? extent[face / 2] : 0, 1e-12) << name;
        ++checked;
      }
      EXPECT_EQ(checked, result.stats.hits);
      EXPECT_GT(checked, 500u) << name;
    }
}

TEST(Baseline, ASphereIsInscribedAndItsNormalsAreSmooth) {
  const Mesh mesh = OneNode(SphereMesh(5, 256, 128));
  const BaselineResult result = Trace(mesh, View(mesh, "iso", Projection::kOrthographic, 128));
  // The largest distance of a facet to the sphere: the sagitta of the diagonal of an equatorial quad.
  const double step = 2 * 3.14159265358979 / 256, sagitta = 5 * (1 - std::cos(step / std::sqrt(2.0)));
  for (std::size_t i = 0; i < result.samples.size(); ++i) {
    if (!std::isfinite(result.samples.depth[i])) continue;
    const Ray ray = PixelRay(result.frame, i % 128 + 0.5, i / 128 + 0.5);
    const Vec3 p = ray.origin + result.samples.depth[i] * ray.direction;
    EXPECT_LE(Length(p), 5 + 1e-6);
    EXPECT_GE(Length(p), 5 - sagitta - 1e-6);
    const auto& n = result.samples.normal[i];
    EXPECT_NEAR(Dot(Vec3{n[0], n[1], n[2]}, Normalized(p)), 1, 1e-3);
    EXPECT_LE(Dot(Vec3{n[0], n[1], n[2]}, ray.direction), 1e-6) << "never turned away from the viewer";
  }
}

TEST(Baseline, AModelFarAwayKeepsItsDigits) {
  const Vec3 far{1e7, -1e7, 1e7};
  const Mesh near_mesh = OneNode(BoxMesh({1, 1, 1})),
             far_mesh = OneNode(BoxMesh({1, 1, 1}), Translation(far));
  for (Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const BaselineResult a = Trace(near_mesh, View(near_mesh, "iso", projection));
    const BaselineResult b = Trace(far_mesh, View(far_mesh, "iso", projection));
    // Coordinates of 1e7 in double are 2e-9 apart; the camera's own rounding of the eye is of that size, too.
    std::size_t differ = 0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
      differ += std::isfinite(a.samples.depth[i]) != std::isfinite(b.samples.depth[i]);
      if (!std::isfinite(a.samples.depth[i]) || !std::isfinite(b.samples.depth[i])) continue;
      EXPECT_NEAR(a.samples.depth[i], b.samples.depth[i], 1e-7);
    }
    EXPECT_EQ(differ, 0u);
    EXPECT_GT(a.stats.hits, 1000u);
  }
}

TEST(Baseline, AnEyeFarAwaySeesTheSame) {
  const Mesh mesh = OneNode(BoxMesh({1, 1, 1}));
  Camera camera = View(mesh, "iso", Projection::kOrthographic);
  const BaselineResult close = Trace(mesh, camera);
  const Vec3 toward = Normalized(camera.eye - camera.target);
  camera.eye = camera.target + 1e6 * toward;
  const BaselineResult distant = Trace(mesh, camera);
  EXPECT_EQ(close.stats.hits, distant.stats.hits);
}

TEST(Baseline, OrthographicSeesBehindTheEyePlaneAndPerspectiveDoesNot) {
  const Mesh mesh = OneNode(BoxMesh({1, 1, 1}));
  Camera camera = View(mesh, "front", Projection::kOrthographic);
  const BaselineResult outside = Trace(mesh, camera);
  // Move the eye beyond the box: orthographic depths become negative, and nothing else changes.
  camera.eye = camera.eye + Vec3{0, 10, 0};
  camera.target = camera.target + Vec3{0, 10, 0};
  const BaselineResult beyond = Trace(mesh, camera);
  ASSERT_EQ(outside.stats.hits, beyond.stats.hits);
  for (std::size_t i = 0; i < outside.samples.size(); ++i) {
    if (!std::isfinite(outside.samples.depth[i])) continue;
    EXPECT_NEAR(beyond.samples.depth[i], outside.samples.depth[i] - 10, 1e-12);
    EXPECT_LT(beyond.samples.depth[i], 0);
  }
  camera.projection = Projection::kPerspective;
  EXPECT_EQ(Trace(mesh, camera).stats.hits, 0u);
  // Seen from inside, every ray hits a wall.
  camera.eye = {0.5, 0.5, 0.5};
  camera.target = {0.5, 1.5, 0.5};
  camera.fov_y_deg = 120;
  EXPECT_EQ(Trace(mesh, camera).stats.hits, 64u * 64u);
}

TEST(Baseline, InstancesAndSinglePlacementsAgree) {
  // Place the same box once, and as one of two instances. Depths, normals and face numbers must be equal.
  const Placement turned = {{{0, -1, 0, 3}, {1, 0, 0, -2}, {0, 0, 1, 7}}};
  Mesh single = OneNode(BoxMesh({1, 2, 3}), turned);
  single.nodes[0].first_placed_face = 6;
  Mesh twice = single;
  twice.nodes.insert(twice.nodes.begin(), MeshNode{0, Translation({1000, 0, 0}), 0});
  const Camera camera = View(single, "iso", Projection::kPerspective);
  const BaselineResult a = Trace(single, camera), b = Trace(twice, camera);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    if (a.samples.face[i] != b.samples.face[i]) {
      ++differ;  // a ray along an edge may hit either side
      continue;
    }
    if (a.samples.face[i] == kNoIndex) continue;
    EXPECT_NEAR(a.samples.depth[i], b.samples.depth[i], 1e-12);
    EXPECT_EQ(a.samples.normal[i], b.samples.normal[i]);
    EXPECT_GE(a.samples.face[i], 6u);
    EXPECT_LT(a.samples.face[i], 12u);
  }
  EXPECT_LE(differ, 2u);
}

TEST(Baseline, AMirroredPlacementKeepsNormalsOutward) {
  Placement mirror;
  mirror.m[0][0] = -2;
  for (int uses : {1, 2}) {
    Mesh mesh = OneNode(SphereMesh(1, 64, 32), mirror);
    if (uses == 2) mesh.nodes.push_back({0, Translation({1000, 0, 0}), 0});
    Camera camera;
    camera.eye = {0, -10, 0};
    camera.up = {0, 0, 1};
    camera.height = 5;
    camera.width_px = camera.height_px = 64;
    const BaselineResult result = Trace(mesh, camera);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < result.samples.size(); ++i) {
      if (!std::isfinite(result.samples.depth[i])) continue;
      const Ray ray = PixelRay(result.frame, i % 64 + 0.5, i / 64 + 0.5);
      const Vec3 p = ray.origin + result.samples.depth[i] * ray.direction;
      // The ellipsoid x²/4 + y² + z² = 1.
      const Vec3 outward = Normalized({p.x / 4, p.y, p.z});
      const auto& n = result.samples.normal[i];
      EXPECT_GT(Dot(Vec3{n[0], n[1], n[2]}, outward), 0.99);
      ++hits;
    }
    EXPECT_GT(hits, 500u);
  }
}

TEST(Baseline, NoLightThroughTheSeamsOfAClosedMesh) {
  // From inside a finely divided sphere every ray must hit, also along the axes, where components of
  // directions vanish or nearly vanish. The same holds inside an instance that is turned by angles whose
  // sines nearly vanish.
  const Placement turned = {{{6.1e-17, -1, 1.2e-16, 0}, {1, 6.1e-17, -6.1e-17, 0}, {6.1e-17, 1.2e-16, 1, 0}}};
  for (int uses : {1, 2}) {
    Mesh mesh = OneNode(SphereMesh(1, 512, 256), turned);
    if (uses == 2) mesh.nodes.push_back({0, Translation({100, 0, 0}), 0});
    Camera camera;
    camera.projection = Projection::kPerspective;
    camera.fov_y_deg = 100;
    camera.width_px = camera.height_px = 256;
    camera.eye = {0, 0, 0};
    for (const Vec3 up : {Vec3{0.3, 0.2, 1}, Vec3{0, 0, 1}})
      for (const Vec3 target :
           {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{-1, 0.5, 0.1}, Vec3{0, 0.1, -1}}) {
        camera.up = up;
        camera.target = target;
        EXPECT_EQ(Trace(mesh, camera).stats.hits, 256u * 256u)
            << uses << ": " << target.x << " " << target.y << " " << target.z << ", up " << up.x;
      }
  }
}

TEST(Baseline, ThreadsDoNotChangeTheAnswer) {
  const Mesh mesh = OneNode(SphereMesh(5, 100, 50));
  const Camera camera = View(mesh, "iso", Projection::kPerspective, 100);
  const BaselineResult one = Trace(mesh, camera, 1), four = Trace(mesh, camera, 4);
  EXPECT_EQ(one.samples.depth, four.samples.depth);
  EXPECT_EQ(one.samples.normal, four.samples.normal);
  EXPECT_EQ(one.samples.face, four.samples.face);
}

TEST(Baseline, AgreesWithTracingEveryTriangle) {
  // Compute the nearest of all ray-triangle intersections in double, for a coarse sphere in front of a box.
  Mesh mesh = OneNode(SphereMesh(2, 12, 7), Translation({0, -3, 0}));
  mesh.parts.push_back(BoxMesh({3, 1, 3}));
  mesh.nodes.push_back({1, {}, 1});
  const Camera camera = View(mesh, "iso", Projection::kPerspective, 48);
  const BaselineResult result = Trace(mesh, camera);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < result.samples.size(); ++i) {
    const Ray ray = PixelRay(result.frame, i % 48 + 0.5, i / 48 + 0.5);
    double nearest = INFINITY;
    for (const MeshNode& node : mesh.nodes)
      for (const auto& triangle : mesh.parts[node.part].triangles) {
        Vec3 p[3];
        for (int k = 0; k < 3; ++k) {
          const auto& q = mesh.parts[node.part].positions[triangle[k]];
          p[k] = node.placement.Point({q[0], q[1], q[2]});
        }
        const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], cross = Cross(ray.direction, e2);
        const double det = Dot(e1, cross);
        if (det == 0) continue;
        const Vec3 to = ray.origin - p[0], across = Cross(to, e1);
        const double u = Dot(to, cross) / det, v = Dot(ray.direction, across) / det,
                     t = Dot(e2, across) / det;
        if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) nearest = std::min(nearest, t);
      }
    if (std::isfinite(nearest) != std::isfinite(result.samples.depth[i]) ||
        (std::isfinite(nearest) && std::fabs(nearest - result.samples.depth[i]) > 1e-5))
      ++differ;
  }
  EXPECT_LE(differ, 1u) << "only a ray that runs along an edge";
}

TEST(Baseline, ReportsWhatItTook) {
  const Mesh mesh = OneNode(SphereMesh(5, 100, 50));
  const Result<BaselineScene> scene = BaselineScene::Build(mesh, {});
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene.value().triangles(), 100u * 49 * 2);
  EXPECT_GT(scene.value().build_ms(), 0);
  EXPECT_GT(scene.value().bvh_bytes(), scene.value().triangles() * 36);
  EXPECT_GE(scene.value().bvh_peak_bytes(), scene.value().bvh_bytes());
  EXPECT_EQ(scene.value().mesh_bytes(), sizeof(MeshNode) + 101u * 51 * 24 + 100u * 49 * 2 * 16);
  EXPECT_GT(scene.value().noise_mm(), 0);
}

TEST(Baseline, NumbersBeyondSinglePrecisionEndNoProcess) {
  // Embree's assertions would fail. A mesh that is too large is refused.
  for (const float size : {1.84e18f, 1e25f, 3e38f}) {
    const Result<BaselineScene> scene = BaselineScene::Build(OneNode(BoxMesh({size, size, size})), {});
    ASSERT_FALSE(scene.ok()) << size;
    EXPECT_EQ(scene.error().code, ErrorCode::kLimitExceeded);
  }
  // Rays that begin far beside the box miss it.
  const Mesh box = OneNode(BoxMesh({10, 20, 30}));
  for (const double height : {1e12, 1e22, 1e30}) {
    Camera camera = View(box, "iso", Projection::kOrthographic);
    camera.height = height;
    EXPECT_EQ(Trace(box, camera).stats.hits, 0u) << height;
  }
  Camera wide = View(box, "iso", Projection::kPerspective);
  wide.fov_y_deg = 179.99999;
  EXPECT_LE(Trace(box, wide).stats.hits, 4u);
}

TEST(Baseline, PartsOfFlatOrTinyPlacementsAreSeen) {
  // The placement has no inverse, or is enormous. It is used twice, so that it becomes an instance.
  const MeshPart part = BoxMesh({10, 20, 30});
  for (const auto& [flat, scale] : {std::pair(0.0, 1.0), std::pair(1.0, 1e-15), std::pair(1.0, 1e14)}) {
    Mesh mesh = OneNode(part);
    mesh.nodes[0].placement = {{{scale, 0, 0, 0}, {0, scale, 0, 0}, {0, 0, flat * scale, 0}}};
    Mesh twice = mesh;
    twice.nodes.push_back(mesh.nodes[0]);
    const Camera camera = View(mesh, "iso", Projection::kOrthographic);
    const BaselineResult one = Trace(mesh, camera), two = Trace(twice, camera);
    EXPECT_GT(one.stats.hits, 500u) << flat << " " << scale;
    EXPECT_EQ(two.stats.hits, one.stats.hits) << flat << " " << scale;
  }
}

TEST(Baseline, RefusesAnEmptyMeshAndABadCameraAndCanBeCancelled) {
  EXPECT_EQ(BaselineScene::Build(Mesh{}, {}).error().code, ErrorCode::kNothingUsable);
  const Mesh mesh = OneNode(SphereMesh(5, 10, 5));
  const Result<BaselineScene> scene = BaselineScene::Build(mesh, {});
  ASSERT_TRUE(scene.ok());
  Camera camera = View(mesh, "iso", Projection::kPerspective);
  const std::atomic<bool> cancel{true};
  EXPECT_EQ(TraceBaseline(scene.value(), camera, {{.cancel = &cancel}}).error().code, ErrorCode::kCancelled);
  camera.eye = camera.target;
  EXPECT_EQ(TraceBaseline(scene.value(), camera, {}).error().code, ErrorCode::kBadUsage);
}

TEST(Baseline, ABuildThatIsCancelledEnds) {
  const std::atomic<bool> cancel{true};
  const Mesh mesh = OneNode(SphereMesh(5, 400, 200));
  EXPECT_EQ(BaselineScene::Build(mesh, {.cancel = &cancel}).error().code, ErrorCode::kCancelled);
}

TEST(Baseline, ABuildThatWouldTakeMoreMemoryThanItMayEnds) {
  // One part is in the tree itself, and one is shared by two instances.
  const Mesh once = OneNode(SphereMesh(5, 400, 200));
  Mesh two = once;
  two.nodes.push_back({.part = 0, .placement = Translation({20, 0, 0}), .first_placed_face = 1});
  const Mesh& twice = two;
  for (const Mesh* mesh : {&once, &twice}) {
    for (const int threads : {1, 0}) {
      const Result<BaselineScene> free = BaselineScene::Build(*mesh, {.threads = threads});
      ASSERT_TRUE(free.ok());
      const std::uint64_t peak = free.value().bvh_peak_bytes();
      ASSERT_GT(peak, std::uint64_t{1} << 20);
      // The limit must be detected at any stage of the build.
      for (const double share : {1e-6, 0.02, 0.1, 0.3, 0.5, 0.7}) {
        const auto most = static_cast<std::uint64_t>(share * static_cast<double>(peak)) + 1;
        const Result<BaselineScene> refused = BaselineScene::Build(*mesh, {.threads = threads}, false, most);
        ASSERT_FALSE(refused.ok()) << share;
        EXPECT_EQ(refused.error().code, ErrorCode::kLimitExceeded);
        EXPECT_NE(refused.error().message.find("the mesh's search tree needs more than the"),
                  std::string::npos)
            << refused.error().message;
      }
      const Result<BaselineScene> roomy = BaselineScene::Build(*mesh, {.threads = threads}, false, 2 * peak);
      ASSERT_TRUE(roomy.ok()) << roomy.error().message;
      EXPECT_LE(roomy.value().bvh_bytes(), roomy.value().bvh_peak_bytes());
    }
  }
}

}  // namespace
}  // namespace facetless
