// Faces and normals near voxels, against closed forms.
#include "render/voxels/near_faces.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <utility>

#include "render/trace/direct.h"
#include "render/voxels/voxel_grid.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ClosedSolid;
using testing::LooseBox;
using testing::ModelOf;
using testing::Sphere;
using testing::Torus;

NearFaces Found(const Model& model, const VoxelGrid& grid) {
  const Scene scene(model);
  Result<std::vector<TouchedSlab>> slabs =
      FindTouchedVoxels(scene, grid, {.max_bytes = std::uint64_t{1} << 30, .details = true}, {});
  if (!slabs) {
    ADD_FAILURE() << slabs.error().message;
    return {{}, grid.size.y};
  }
  return {std::move(slabs).value(), grid.size.y};
}

double Angle(Vec3 a, Vec3 b) {
  return std::atan2(Length(Cross(a, b)), Dot(a, b));
}

RC_GTEST_PROP(NormalCodes, KeepUnitVectors, ()) {
  const auto draw = [] { return 1e-3 * *rc::gen::inRange(-1000, 1001); };
  const Vec3 v{draw(), draw(), draw()};
  RC_PRE(Length(v) > 1e-3);
  const std::uint32_t code = NormalCode(Normalized(v));
  RC_ASSERT(code != 0u);
  RC_ASSERT(Angle(NormalOfCode(code), v) < 1e-4);
}

TEST(NormalCodes, OfNothingIsZero) {
  EXPECT_EQ(NormalCode({0, 0, 0}), 0u);
  EXPECT_EQ(Length(NormalOfCode(0)), 0);
}

RC_GTEST_PROP(NearFaces, NormalsOfRoundSolidsPointOutwards, ()) {
  const double scale = std::exp2(*rc::gen::inRange(-20, 21));
  const bool ball = *rc::gen::inRange(0, 2) == 0;
  const double radius = 10 * scale, tube = 4 * scale;
  const Model model =
      ClosedSolid(ModelOf({ball ? Sphere({0, 0, 0}, radius) : Torus({0, 0, 0}, radius, tube)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, *rc::gen::inRange(30, 50)).value();
  const NearFaces faces = Found(model, grid);
  int touched = 0;
  for (int x = 0; x < grid.size.x; x += 3)
    for (int y = 0; y < grid.size.y; y += 5)
      for (int z = 0; z < grid.size.z; ++z) {
        if (faces.At({x, y, z}).empty()) continue;
        ++touched;
        const Vec3 p = grid.Center({x, y, z});
        const double around = std::hypot(p.x, p.y);
        const Vec3 outwards = ball ? p : p - (radius / around) * Vec3{p.x, p.y, 0};
        const auto near = faces.Near({x, y, z}, 1, -Normalized(outwards));
        RC_ASSERT(near.has_value());
        // The voxel's centre is up to a voxel away from the surface, and its normal turns within its neighbours.
        RC_ASSERT(Angle(near->normal, outwards) < 0.35);
      }
  RC_ASSERT(touched > 30);
}

TEST(NearFaces, ShowTheFaceThatIsTurnedToTheRay) {
  const Model model = ClosedSolid(LooseBox({8, 8, 8}, 0, 1));
  const VoxelGrid grid = GridOfPitch(model.bounds, 0.5).value();
  const NearFaces faces = Found(model, grid);
  // Along an edge of the box, the voxels touch two faces. Which of them is shown depends on the direction.
  const Vec3 low = model.bounds.low, high = model.bounds.high;
  const Vec3 edge = (1 / grid.pitch) * (Vec3{0.5 * (low.x + high.x), high.y, high.z} - grid.origin);
  const VoxelPoint at{int(edge.x), int(edge.y), int(edge.z)};
  for (const Vec3 outwards : {Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 direction = Normalized(-1.0 * outwards + Vec3{0.1, -0.2, -0.2});
    const auto near = faces.Near(at, 1, direction);
    ASSERT_TRUE(near.has_value());
    EXPECT_LT(Angle(near->normal, outwards), 1e-3);
  }
}

TEST(NearFaces, BesideNoFaceAreNothing) {
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, 64).value();
  const NearFaces faces = Found(model, grid);
  EXPECT_FALSE(faces.Near({32, 32, 32}, 3, {0, 0, 1}).has_value());
  EXPECT_FALSE(faces.Near({-100, 0, 200}, 3, {0, 0, 1}).has_value());
  EXPECT_TRUE(faces.At({-1, 0, 0}).empty());
  EXPECT_TRUE(faces.At({0, 64, 0}).empty());
}

}  // namespace
}  // namespace facetless
