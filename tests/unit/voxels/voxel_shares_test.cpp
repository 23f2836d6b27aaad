// Shares of voxels against closed forms: whatever the solid and the divisions, the true share is within the bound.
#include "render/voxels/voxel_shares.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ClosedSolid;
using testing::LooseBox;
using testing::ModelOf;
using testing::Rectangle;
using testing::Sphere;
using testing::Torus;

constexpr double kPi = std::numbers::pi;

VoxelShares Measured(const Model& model, const VoxelGrid& grid, int divisions, int threads = 0) {
  const Scene scene(model);
  Result<VoxelShares> shares = MeasureShares(scene, grid, {.divisions = divisions}, {.threads = threads});
  if (!shares) {
    ADD_FAILURE() << shares.error().message;
    return {};
  }
  return std::move(shares).value();
}

// The share of the interval [low, low + 1] that lies in [from, to].
double Overlap(double low, double from, double to) {
  return std::max(0.0, std::min(low + 1, to) - std::max(low, from));
}

RC_GTEST_PROP(VoxelShares, OfABoxAreProductsOfOverlaps, ()) {
  const auto length = [] { return 1 + 0.01 * *rc::gen::inRange(0, 2000); };
  const Vec3 size{length(), length(), length()};
  const Model model = ClosedSolid(LooseBox(size, 0, 1));
  const int divisions = 1 << *rc::gen::inRange(1, 6);
  const VoxelGrid grid = GridOfResolution(model.bounds, *rc::gen::inRange(2, 20)).value();
  const VoxelShares shares = Measured(model, grid, divisions);
  const Vec3 low = (1 / grid.pitch) * (model.bounds.low - grid.origin),
             high = (1 / grid.pitch) * (model.bounds.high - grid.origin);
  std::uint64_t partial = 0;
  for (int x = 0; x < grid.size.x; ++x)
    for (int y = 0; y < grid.size.y; ++y)
      for (int z = 0; z < grid.size.z; ++z) {
        const double share =
            Overlap(x, low.x, high.x) * Overlap(y, low.y, high.y) * Overlap(z, low.z, high.z);
        const ShareRun run = shares.Get(x, y, z);
        RC_ASSERT(std::fabs(run.share - share) <= run.bound + 1e-6);
        partial += run.bound > 0;
      }
  RC_ASSERT(shares.partial == partial);
  RC_ASSERT(std::fabs(shares.volume_mm3 - size.x * size.y * size.z) <= shares.volume_bound_mm3);
}

RC_GTEST_PROP(VoxelShares, OfRoundSolidsBoundTheVolume, ()) {
  const double scale = std::exp2(*rc::gen::inRange(-20, 21));
  const double radius = scale * (1 + 0.13 * *rc::gen::inRange(0, 10)), tube = 0.3 * radius;
  const bool ball = *rc::gen::inRange(0, 2) == 0;
  const Model model =
      ClosedSolid(ModelOf({ball ? Sphere({3 * scale, 0, 0}, radius) : Torus({0, 0, 0}, radius, tube)}));
  const double volume = ball ? 4 * kPi / 3 * radius * radius * radius : 2 * kPi * kPi * radius * tube * tube;
  const int resolution = *rc::gen::inRange(2, 40), divisions = 1 << *rc::gen::inRange(1, 4);
  const VoxelShares shares = Measured(model, GridOfResolution(model.bounds, resolution).value(), divisions);
  RC_ASSERT(std::fabs(shares.volume_mm3 - volume) <= shares.volume_bound_mm3 + 1e-9 * volume);
  RC_ASSERT(shares.greatest_bound <= 1);
}

TEST(VoxelShares, ConvergeWithTheDivisions) {
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, 20).value();
  double bound = INFINITY;
  for (const int divisions : {2, 4, 8, 16}) {
    const VoxelShares shares = Measured(model, grid, divisions);
    EXPECT_LT(shares.volume_bound_mm3, 0.7 * bound) << divisions;
    bound = shares.volume_bound_mm3;
    EXPECT_NEAR(shares.volume_mm3, 4000 * kPi / 3, 0.05 * bound) << divisions;
  }
}

TEST(VoxelShares, OfSolidsThatOverlapCountTheSpaceOnce) {
  ModelBuilder builder(ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10), Sphere({10, 0, 0}, 10)})));
  builder.SetSolid(1, builder.AddSolid(true, "other"));
  const Model model = testing::Finished(std::move(builder));
  const VoxelShares shares = Measured(model, GridOfResolution(model.bounds, 30).value(), 4);
  // Two balls whose centres are one radius apart share two caps of the height r/2.
  const double ball = 4000 * kPi / 3, caps = 2 * kPi * 25 * (30 - 5) / 3;
  EXPECT_NEAR(shares.volume_mm3, 2 * ball - caps, 1e-3 * ball);
  EXPECT_NEAR(shares.volume_mm3, 2 * ball - caps, shares.volume_bound_mm3);
  EXPECT_EQ(shares.Get(15, 10, 10).share, 1);
}

TEST(VoxelShares, AreTheSameForAnyNumberOfThreads) {
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, 10, 3)}));
  const VoxelGrid grid = GridOfResolution(model.bounds, 50).value();
  const VoxelShares one = Measured(model, grid, 4, 1), two = Measured(model, grid, 4, 2);
  EXPECT_EQ(one.volume_mm3, two.volume_mm3);
  EXPECT_EQ(one.volume_bound_mm3, two.volume_bound_mm3);
  for (int x = 0; x < grid.size.x; ++x)
    for (int y = 0; y < grid.size.y; ++y) EXPECT_EQ(one.Column(x, y).size(), two.Column(x, y).size());
}

TEST(VoxelShares, OfAnOpenFaceAreNothingButMayBeTouched) {
  const Model model = ModelOf({Rectangle({0, 0, 0}, {10, 0, 0}, {0, 10, 3})});
  const VoxelShares shares = Measured(model, GridOfResolution(model.bounds, 10).value(), 2);
  EXPECT_EQ(shares.volume_mm3, 0);
  EXPECT_GT(shares.partial, 0u);
}

TEST(VoxelShares, RefuseOtherDivisions) {
  const Model model = ClosedSolid(LooseBox({4, 4, 4}, 0, 1));
  const Scene scene(model);
  const VoxelGrid grid = GridOfResolution(model.bounds, 9).value();
  for (const int divisions : {-4, 0, 1, 3, 6, 33, 64})
    EXPECT_EQ(MeasureShares(scene, grid, {.divisions = divisions}, {}).error().code, ErrorCode::kBadUsage);
  const VoxelGrid large = GridOfResolution(model.bounds, 4096).value();
  EXPECT_EQ(MeasureShares(scene, large, {.divisions = 32}, {}).error().code, ErrorCode::kBadUsage);
}

}  // namespace
}  // namespace facetless
