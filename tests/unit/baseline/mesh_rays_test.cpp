// Secondary rays on triangles: what is between two points, and what comes first.
#include "render/baseline/mesh_rays.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

#include "tests/unit/baseline/meshes.h"

namespace facetless {
namespace {

using testing::BoxMesh;
using testing::OneNode;
using testing::SphereMesh;
using testing::Translation;

double Between(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1000001) / 1e6;
}

RayPassage Ask(const MeshRays& rays, const RayStart& start, Vec3 direction, double length = INFINITY) {
  const SecondaryRay ray{0, Normalized(direction), length};
  RayPassage passage;
  rays.FindBlocked(std::span(&start, 1), std::span(&ray, 1), std::span(&passage, 1));
  return passage;
}

SecondaryHit Nearest(const MeshRays& rays, const RayStart& start, Vec3 direction, double length = INFINITY) {
  const SecondaryRay ray{0, Normalized(direction), length};
  SecondaryHit hit;
  rays.FindNearest(std::span(&start, 1), std::span(&ray, 1), std::span(&hit, 1));
  return hit;
}

TEST(MeshRays, AFaceOfABoxBlocksWhatGoesInwardAndNothingElse) {
  EXPECT_TRUE(rc::check("boxes anywhere, rays from their upper faces", [] {
    const Vec3 size{Between(1, 50), Between(1, 50), Between(1, 50)};
    const Vec3 corner{Between(-1e6, 1e6), Between(-1e6, 1e6), Between(-1e6, 1e6)};
    const Mesh mesh = OneNode(BoxMesh(size), Translation(corner));
    const BaselineScene scene = BaselineScene::Build(mesh, {.threads = 1}).value();
    const MeshRays rays(scene);
    RayStart start;
    start.position = corner + Vec3{Between(0.1, 0.9) * size.x, Between(0.1, 0.9) * size.y, size.z};
    start.normal = {0, 0, 1};
    const Vec3 up{Between(-1, 1), Between(-1, 1), Between(0.05, 1)};
    RC_ASSERT(!Ask(rays, start, up).blocked);
    const RayPassage down = Ask(rays, start, -up);
    RC_ASSERT(down.blocked && !down.certified);
    RC_ASSERT(Nearest(rays, start, up).placed_face == kNoIndex);
    // The way through the box.
    const Vec3 d = Normalized(-up);
    double exit = size.z / -d.z;
    for (const auto& [o, along, width] :
         {std::tuple{start.position.x - corner.x, d.x, size.x}, {start.position.y - corner.y, d.y, size.y}})
      if (along != 0) exit = std::min(exit, (along > 0 ? width - o : -o) / along);
    const SecondaryHit hit = Nearest(rays, start, d);
    RC_ASSERT(hit.placed_face != kNoIndex);
    // The lift moves the ray sideways.
    RC_ASSERT(std::fabs(hit.distance - exit) < 40 * rays.lift_mm());
    RC_ASSERT(Length(hit.position - (start.position + hit.distance * d)) < 40 * rays.lift_mm());
    RC_ASSERT(std::fabs(Length(hit.normal) - 1) < 1e-6);
    RC_ASSERT(Dot(hit.normal, d) > 0);
    // A ray that ends before it meets nothing.
    RC_ASSERT(!Ask(rays, start, d, exit / 2).blocked);
    RC_ASSERT(Ask(rays, start, d, exit * 1.5).blocked);
  }));
}

TEST(MeshRays, ACoarseBallShadowsItselfBesideTheTerminatorAndAFineOneLess) {
  // This is the weakness that difference.light measures: near the terminator, the smooth normal faces the light, and
  // the facet does not.
  const Vec3 light = Normalized(Vec3{1, 0, 0.2});
  const auto falsely_dark = [&](int longitudes) {
    const Mesh mesh = OneNode(SphereMesh(5, longitudes, longitudes / 2));
    const BaselineScene scene = BaselineScene::Build(mesh, {.threads = 1}).value();
    const MeshRays rays(scene);
    int dark = 0;
    for (int i = 0; i < 4000; ++i) {
      const double height = -4 + 8 * (i % 80 + 0.5) / 80, turn = 6.283185307179586 * (i / 80 + 0.5) / 50;
      const double radius = std::sqrt(25 - height * height);
      const Vec3 toward = Normalized(Vec3{radius * std::cos(turn), radius * std::sin(turn), height});
      if (!(Dot(toward, light) > 0)) continue;
      // The point of the mesh in that direction.
      RayStart outside;
      outside.position = 20 * toward;
      const SecondaryHit on_mesh = Nearest(rays, outside, -toward);
      RayStart start;
      start.position = on_mesh.position;
      start.normal = toward;
      dark += Ask(rays, start, light).blocked;
    }
    return dark;
  };
  const int coarse = falsely_dark(12), fine = falsely_dark(192);
  EXPECT_GT(coarse, 20);
  EXPECT_LT(fine, coarse / 4);
}

TEST(MeshRays, AnswersDoNotDependOnTheBatch) {
  const Mesh mesh = OneNode(SphereMesh(5, 32, 16));
  const BaselineScene scene = BaselineScene::Build(mesh, {.threads = 1}).value();
  const MeshRays rays(scene);
  std::vector<RayStart> starts(53);
  std::vector<SecondaryRay> batch;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    starts[i].position = {-20, -5 + 0.2 * static_cast<double>(i), 0.3};
    batch.push_back({static_cast<std::uint32_t>(i), {1, 0, 0}, i % 3 == 0 ? 10.0 : INFINITY});
  }
  std::vector<RayPassage> passages(batch.size());
  rays.FindBlocked(starts, batch, passages);
  std::vector<SecondaryHit> hits(batch.size());
  rays.FindNearest(starts, batch, hits);
  int blocked = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    EXPECT_EQ(passages[i].blocked, Ask(rays, starts[i], {1, 0, 0}, batch[i].length).blocked);
    EXPECT_EQ(hits[i].distance, Nearest(rays, starts[i], {1, 0, 0}, batch[i].length).distance);
    EXPECT_EQ(passages[i].blocked, hits[i].placed_face != kNoIndex);
    blocked += passages[i].blocked;
  }
  EXPECT_GT(blocked, 20);
}

TEST(MeshRays, WhatIsOutOfReachMeetsNothing) {
  const Mesh mesh = OneNode(BoxMesh({1, 1, 1}));
  const BaselineScene scene = BaselineScene::Build(mesh, {.threads = 1}).value();
  const MeshRays rays(scene);
  RayStart start;
  start.position = {1e300, 0.5, 0.5};
  EXPECT_FALSE(Ask(rays, start, {-1, 0, 0}).blocked);
  start.position = {NAN, 0.5, 0.5};
  EXPECT_FALSE(Ask(rays, start, {-1, 0, 0}).blocked);
}

}  // namespace
}  // namespace facetless
