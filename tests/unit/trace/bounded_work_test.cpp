// The work of a view is bounded, whatever numbers a model contains. Work that would not end is given up, and
// listed.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "render/nurbs/leaf_splitter.h"
#include "render/trace/direct.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

constexpr int kSize = 8;

Result<DirectResult> Render(const Model& model) {
  Camera camera;
  camera.eye = {35, -35, 35};
  camera.up = {0, 0, 1};
  camera.height = 35;
  camera.width_px = camera.height_px = kSize;
  DirectOptions options;
  options.execution.threads = 1;
  options.accuracy.precision = Precision::kCertified;
  options.accuracy.check = CheckLevel::kNone;
  return TraceDirect(Scene(model), camera, options);
}

// Returns a number between 10^low and 10^high, as a damaged file may contain.
double DamagedNumber(int low, int high, std::mt19937_64* random) {
  return std::pow(10.0, std::uniform_real_distribution<double>(low, high)(*random));
}

// Returns a sphere of which `count` control points from `first` on are damaged.
testing::PatchGrid DamagedSphere(std::uint64_t seed, std::size_t first, std::size_t count) {
  std::mt19937_64 random(seed);
  testing::PatchGrid grid = testing::Sphere({0, 0, 0}, 10);
  for (std::size_t i = first; i < std::min(first + count, grid.points.size()); ++i) {
    grid.points[i] = {-DamagedNumber(160, 235, &random), DamagedNumber(-320, -130, &random),
                      -DamagedNumber(-320, 280, &random), DamagedNumber(-320, -130, &random)};
  }
  return grid;
}

Model ModelOfSpheres(const std::vector<testing::PatchGrid>& spheres) {
  // The builder rejects such numbers, so they replace those of sound spheres afterwards.
  Model model =
      testing::ModelOf(std::vector<testing::PatchGrid>(spheres.size(), testing::Sphere({0, 0, 0}, 10)));
  auto point = model.control_points.begin();
  for (const testing::PatchGrid& sphere : spheres) point = std::ranges::copy(sphere.points, point).out;
  return model;
}

// The number of times that hard leaves may call the fallback solver in a view of such a model: for each
// patch, the number of its pieces, and one call at each sample for each piece that was given up.
std::uint64_t MostFallbacks(const Model& model) {
  const double samples = kSize * kSize;
  std::uint64_t most = 0;
  for (const Surface& surface : model.surfaces) {
    const std::uint64_t nodes = NodeLimit(samples, surface.degree_u, surface.degree_v);
    most += surface.PatchCount() * (kHardSamples * nodes + 65 * kSize * kSize);
  }
  return most;
}

RC_GTEST_PROP(BoundedWork, HoldsForDamagedNumbers, ()) {
  const Model model = ModelOfSpheres(
      {DamagedSphere(*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::inRange<std::size_t>(0, 72),
                     *rc::gen::inRange<std::size_t>(1, 73))});
  const Result<DirectResult> result = Render(model);
  RC_ASSERT(result.ok());
  const DirectStats& stats = result.value().stats;
  RC_ASSERT(stats.certified + stats.converged + stats.unresolved == stats.rays);
  RC_ASSERT(stats.fallbacks <= MostFallbacks(model));
}

// Each such sphere leaves some hundred leaves that the ray cannot be proven to miss. Together, many of them
// exceed the limit of work of a ray.
TEST(BoundedWork, EndsARayByName) {
  std::vector<testing::PatchGrid> spheres;
  for (std::uint64_t seed = 0; seed < 20; ++seed) spheres.push_back(DamagedSphere(seed, 0, 72));
  const Result<DirectResult> result = Render(ModelOfSpheres(spheres));
  ASSERT_TRUE(result.ok()) << result.error().message;
  const DirectStats& stats = result.value().stats;
  EXPECT_EQ(stats.certified + stats.converged + stats.unresolved, stats.rays);
  EXPECT_GT(stats.unresolved, stats.rays / 2);
  EXPECT_GT(stats.doubts[6], 0u) << kDoubtNames[6];
}

}  // namespace
}  // namespace facetless
