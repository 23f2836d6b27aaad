// Voxels of exact solids against closed forms: which centres are inside, what a surface touches, and that no path leads
// through a surface.
#include "render/voxels/voxelize.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "render/voxels/octree_model.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ClosedSolid;
using testing::Frustum;
using testing::LooseBox;
using testing::ModelOf;
using testing::Rectangle;
using testing::Sphere;
using testing::Torus;

Voxels Made(const Model& model, const VoxelGrid& grid, VoxelFill fill, int threads = 0) {
  const Scene scene(model);
  Result<Voxels> voxels = Voxelize(scene, grid, {.fill = fill, .accuracy = {}}, {.threads = threads});
  if (!voxels) {
    ADD_FAILURE() << voxels.error().message;
    return {RunModel(grid.size), grid, {}};
  }
  return std::move(voxels).value();
}

void ForEachVoxel(const VoxelGrid& grid, const std::function<void(VoxelPoint)>& act) {
  for (int x = 0; x < grid.size.x; ++x)
    for (int y = 0; y < grid.size.y; ++y)
      for (int z = 0; z < grid.size.z; ++z) act({x, y, z});
}

TEST(VoxelGrids, HoldTheBoxWithABorder) {
  const Box3 box{{-1, 2, 3}, {9, 7, 4}};
  for (const int resolution : {2, 3, 17, 256, 65536}) {
    const VoxelGrid grid = GridOfResolution(box, resolution).value();
    EXPECT_EQ(grid.size.x, resolution);
    for (const double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      EXPECT_LE(grid.origin.*axis, box.low.*axis - 0.499 * grid.pitch);
      EXPECT_GE(grid.bounds().high.*axis, box.high.*axis + 0.499 * grid.pitch);
    }
  }
  EXPECT_DOUBLE_EQ(GridOfPitch(box, 0.25).value().pitch, 0.25);
  EXPECT_EQ(GridOfResolution(box, 1).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(GridOfPitch(box, 1e-9).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(GridOfPitch(box, NAN).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(GridOfResolution({{0, 0, 0}, {0, 0, 0}}, 8).error().code, ErrorCode::kBadUsage);
}

RC_GTEST_PROP(Voxelize, CentresOfABallAreInsideIt, ()) {
  const double scale = std::exp2(*rc::gen::inRange(-20, 21));
  const Vec3 center = scale * Vec3{0.25 * *rc::gen::inRange(-40, 40), 0.1 * *rc::gen::inRange(-40, 40), 3};
  const double radius = scale * (1 + 0.13 * *rc::gen::inRange(0, 10));
  const Model model = ClosedSolid(ModelOf({Sphere(center, radius)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, *rc::gen::inRange(2, 40)).value();
  const Voxels voxels = Made(model, grid, VoxelFill::kSolid);
  std::uint64_t wrong = 0;
  ForEachVoxel(grid, [&](VoxelPoint p) {
    const double distance = Length(grid.Center(p) - center) - radius;
    if (std::fabs(distance) > 1e-9 * radius)
      wrong += voxels.model.Get(p.x, p.y, p.z).filled() != (distance < 0);
  });
  RC_ASSERT(wrong == 0u);
  const VoxelStats& stats = voxels.stats;
  RC_ASSERT(stats.certified + stats.not_certified == VoxelBox({{0, 0, 0}, grid.size}).volume());
  RC_ASSERT(stats.columns ==
            static_cast<std::uint64_t>(grid.size.x) * static_cast<std::uint64_t>(grid.size.y));
  RC_ASSERT(stats.solids == 1u && stats.open_faces == 0u);
}

TEST(Voxelize, ATorusHasItsHole) {
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, 10, 3)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, 60).value();
  const Voxels voxels = Made(model, grid, VoxelFill::kSolid);
  std::uint64_t wrong = 0, inside = 0;
  ForEachVoxel(grid, [&](VoxelPoint p) {
    const Vec3 c = grid.Center(p);
    const double d = std::hypot(std::hypot(c.x, c.y) - 10, c.z) - 3;
    inside += d < 0;
    wrong += voxels.model.Get(p.x, p.y, p.z).filled() != (d < 0);
  });
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(voxels.model.Count(), inside);
  EXPECT_GT(voxels.stats.certified, 0.95 * static_cast<double>(VoxelBox({{0, 0, 0}, grid.size}).volume()));
}

// The distances of the nearest and the farthest point of a voxel from a point.
std::pair<double, double> Distances(const VoxelGrid& grid, VoxelPoint p, Vec3 from) {
  const Vec3 low = grid.Corner(p), high = grid.Corner({p.x + 1, p.y + 1, p.z + 1});
  const Vec3 nearest{std::clamp(from.x, low.x, high.x), std::clamp(from.y, low.y, high.y),
                     std::clamp(from.z, low.z, high.z)};
  double far = 0;
  for (int corner = 0; corner < 8; ++corner)
    far = std::max(far, Length(Vec3{corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                    corner & 4 ? high.z : low.z} -
                               from));
  return {Length(nearest - from), far};
}

RC_GTEST_PROP(Voxelize, ASurfaceFillsWhatItTouches, ()) {
  const double radius = 0.05 * *rc::gen::inRange(20, 200);
  const Vec3 center{0.01 * *rc::gen::inRange(-300, 300), 0.01 * *rc::gen::inRange(-300, 300), 1};
  const Model model = ClosedSolid(ModelOf({Sphere(center, radius)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, *rc::gen::inRange(4, 40)).value();
  const Voxels voxels = Made(model, grid, VoxelFill::kSurface);
  std::uint64_t missing = 0, touched = 0, filled = 0, far = 0;
  ForEachVoxel(grid, [&](VoxelPoint p) {
    const auto [nearest, farthest] = Distances(grid, p, center);
    const bool touches = nearest < radius * (1 - 1e-9) && farthest > radius * (1 + 1e-9);
    const bool is = voxels.model.Get(p.x, p.y, p.z).filled();
    touched += touches;
    filled += is;
    missing += touches && !is;
    // What is filled in addition lies within a voxel of the surface.
    far += is && (nearest > radius + grid.pitch || farthest < radius - grid.pitch);
  });
  RC_ASSERT(missing == 0u);
  RC_ASSERT(far == 0u);
  RC_ASSERT(filled <= touched * 5 / 4 + 16);
  RC_ASSERT(voxels.stats.touched == filled);
}

// Whether a path through empty voxels leads from outside to the voxel of a point. Neighbours share a side, or at least a
// corner.
bool Leaks(const Voxels& voxels, Vec3 to, bool corners) {
  const VoxelPoint n = voxels.grid.size;
  const auto index = [&](VoxelPoint p) {
    return (static_cast<std::size_t>(p.x) * static_cast<std::size_t>(n.y) + static_cast<std::size_t>(p.y)) *
               static_cast<std::size_t>(n.z) +
           static_cast<std::size_t>(p.z);
  };
  std::vector<bool> seen(static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) *
                         static_cast<std::size_t>(n.z));
  std::vector<VoxelPoint> waiting;
  const auto enter = [&](VoxelPoint p) {
    if (!voxels.model.box().Holds(p) || voxels.model.Get(p.x, p.y, p.z).filled() || seen[index(p)]) return;
    seen[index(p)] = true;
    waiting.push_back(p);
  };
  for (int x = 0; x < n.x; ++x)
    for (int y = 0; y < n.y; ++y)
      for (int z = 0; z < n.z; ++z)
        if (x == 0 || y == 0 || z == 0 || x + 1 == n.x || y + 1 == n.y || z + 1 == n.z) enter({x, y, z});
  while (!waiting.empty()) {
    const VoxelPoint p = waiting.back();
    waiting.pop_back();
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          if (corners || std::abs(dx) + std::abs(dy) + std::abs(dz) == 1)
            enter({p.x + dx, p.y + dy, p.z + dz});
  }
  const Vec3 at = (1 / voxels.grid.pitch) * (to - voxels.grid.origin);
  return seen[index({static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z)})];
}

TEST(Voxelize, SurfacesSeparate) {
  const Model ball = ClosedSolid(ModelOf({Sphere({0.3, 0.1, 0.7}, 5)})), box = LooseBox({7, 5, 3}, 1e-9, 4);
  for (const int resolution : {9, 16, 33}) {
    for (const auto& [model, middle] :
         {std::pair<const Model&, Vec3>(ball, {0.3, 0.1, 0.7}), {box, {3.5, 2.5, 1.5}}}) {
      const VoxelGrid grid = GridOfResolution(model.bounds, resolution).value();
      const Voxels thin = Made(model, grid, VoxelFill::kThinSurface),
                   thick = Made(model, grid, VoxelFill::kSurface);
      EXPECT_FALSE(Leaks(thin, middle, false)) << resolution;
      EXPECT_FALSE(Leaks(thick, middle, true)) << resolution;
      EXPECT_LT(thin.model.Count(), thick.model.Count());
    }
  }
}

TEST(Voxelize, AThinPlateDoesNotVanish) {
  // 0.01 mm thick, at a pitch of 1 mm, across each axis.
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 size{20.3, 20.3, 20.3};
    (axis == 0 ? size.x : axis == 1 ? size.y : size.z) = 0.01;
    const Model plate = LooseBox(size, 1e-9, 3);
    const VoxelGrid grid = GridOfPitch(plate.bounds, 1).value();
    const Voxels solid = Made(plate, grid, VoxelFill::kSolid),
                 conservative = Made(plate, grid, VoxelFill::kConservative);
    EXPECT_EQ(solid.model.Count(), 0u) << "no centre lies in it";
    EXPECT_GE(conservative.model.Count(), 21u * 21);
    EXPECT_LE(conservative.model.Count(), 2 * 22u * 22);
  }
}

TEST(Voxelize, ConservativeHoldsSolidAndSurface) {
  const Model model = ClosedSolid(ModelOf({Torus({1, 2, 3}, 8, 2.5)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, 40).value();
  const Voxels solid = Made(model, grid, VoxelFill::kSolid), surface = Made(model, grid, VoxelFill::kSurface),
               both = Made(model, grid, VoxelFill::kConservative);
  std::uint64_t wrong = 0;
  ForEachVoxel(grid, [&](VoxelPoint p) {
    const bool expected =
        solid.model.Get(p.x, p.y, p.z).filled() || surface.model.Get(p.x, p.y, p.z).filled();
    wrong += both.model.Get(p.x, p.y, p.z).filled() != expected;
  });
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(both.stats.certified + both.stats.not_certified, VoxelBox({{0, 0, 0}, grid.size}).volume());
}

TEST(Voxelize, OpenFacesAreNamedAndFillNothing) {
  Model model = ModelOf({Rectangle({0, 0, 0}, {10, 0, 0}, {0, 10, 0})});
  model.faces[0].name = "lid";
  const VoxelGrid grid = GridOfResolution(model.bounds, 20).value();
  const Voxels solid = Made(model, grid, VoxelFill::kSolid);
  EXPECT_EQ(solid.model.Count(), 0u);
  EXPECT_EQ(solid.stats.open_faces, 1u);
  ASSERT_EQ(solid.stats.open_face_names.size(), 1u);
  EXPECT_NE(solid.stats.open_face_names[0].find("lid"), std::string::npos);
  const Voxels surface = Made(model, grid, VoxelFill::kSurface);
  EXPECT_GE(surface.model.Count(), 19u * 19);
  EXPECT_EQ(surface.model.Get(10, 10, grid.size.z / 2).material() |
                surface.model.Get(10, 10, (grid.size.z - 1) / 2).material(),
            kMostMaterials);
}

TEST(Voxelize, ThreadsDoNotMatter) {
  const Model model = ClosedSolid(ModelOf({Torus({1, 2, 3}, 8, 2.5)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, 70).value();
  for (const VoxelFill fill :
       {VoxelFill::kSolid, VoxelFill::kConservative, VoxelFill::kSurface, VoxelFill::kThinSurface}) {
    const Voxels one = Made(model, grid, fill, 1), four = Made(model, grid, fill, 4);
    EXPECT_TRUE(SameVoxels(one.model, four.model));
    EXPECT_GT(one.model.Count(), 1000u);
  }
}

TEST(Voxelize, SaysWhatExceedsItsMemory) {
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, 1)}));
  const Scene scene(model);
  const VoxelGrid grid = GridOfResolution(model.bounds, 200).value();
  ExactTraceOptions accuracy;
  accuracy.max_bytes = 20'000;
  const Result<Voxels> refused =
      Voxelize(scene, grid, {.fill = VoxelFill::kSurface, .accuracy = accuracy}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kLimitExceeded);
  const Result<Voxels> thin =
      Voxelize(scene, grid, {.fill = VoxelFill::kThinSurface, .accuracy = accuracy}, {});
  ASSERT_FALSE(thin);
  EXPECT_EQ(thin.error().code, ErrorCode::kLimitExceeded);
  const std::atomic<bool> stop = true;
  const Result<Voxels> stopped = Voxelize(scene, grid, {}, {.cancel = &stop});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace facetless
