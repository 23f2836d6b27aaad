// Voxels as a representation: what a view of them shows, in every encoding and with all normals.
#include "render/compare/voxel_method.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/compare/representation.h"
#include "render/voxels/encodings.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ClosedSolid;
using testing::LooseBox;
using testing::ModelOf;
using testing::Sphere;

constexpr int kSize = 96;

std::unique_ptr<const Representation> Voxelized(const Scene& scene, const DirectOptions& direct,
                                                const VoxelLook& look, int resolution) {
  auto made = VoxelMethod().make({.scene = scene,
                                  .direct = direct,
                                  .name = "voxels",
                                  .title = "Voxels",
                                  .execution = {},
                                  .max_bytes = std::uint64_t{1} << 30,
                                  .voxels = look},
                                 resolution);
  if (made.ok()) return std::move(made).value();
  ADD_FAILURE() << made.error().message;
  return nullptr;
}

Camera View(const Model& model, Projection projection) {
  return NamedView("iso", model.bounds, projection, kSize, kSize).value();
}

SampleBuffer Traced(const Representation& representation, const Camera& camera,
                    const std::vector<bool>* leave_out = nullptr) {
  const Result<TracedView> view = representation.Trace(camera, {.leave_out = leave_out}, {});
  if (view.ok()) return view.value().samples;
  ADD_FAILURE() << view.error().message;
  return {};
}

TEST(VoxelMethod, ShowsTheSameVoxelsInEveryEncoding) {
  const Model model = ClosedSolid(ModelOf({Sphere({3, -2, 1}, 10)}));
  const Scene scene(model);
  const DirectOptions direct;
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Camera camera = View(model, projection);
    // Pixels are narrower than two voxels, so that no cubes are shown.
    const SampleBuffer expected = Traced(*Voxelized(scene, direct, {}, 70), camera);
    for (const VoxelEncoding& encoding : VoxelEncodings()) {
      const SampleBuffer samples =
          Traced(*Voxelized(scene, direct, {.encoding = std::string(encoding.name)}, 70), camera);
      EXPECT_EQ(samples.depth, expected.depth) << encoding.name;
      EXPECT_EQ(samples.normal, expected.normal) << encoding.name;
    }
  }
}

TEST(VoxelMethod, NormalsOfTheExactSurfaceAreSmooth) {
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10)}));
  const Scene scene(model);
  const DirectOptions direct;
  const Camera camera = View(model, Projection::kOrthographic);
  double mean[3] = {};
  for (const VoxelNormals normals : {VoxelNormals::kExact, VoxelNormals::kGrid, VoxelNormals::kSide}) {
    const auto voxels = Voxelized(scene, direct, {.normals = normals}, 64);
    EXPECT_EQ(voxels->names_faces(), normals == VoxelNormals::kExact);
    const Result<TracedView> view = voxels->Trace(camera, {}, {});
    ASSERT_TRUE(view.ok());
    const SampleBuffer& samples = view.value().samples;
    int count = 0;
    double& sum = mean[static_cast<std::size_t>(normals)];
    for (int row = 0; row < kSize; ++row)
      for (int column = 0; column < kSize; ++column) {
        const std::size_t i = static_cast<std::size_t>(row * kSize + column);
        if (!std::isfinite(samples.depth[i])) continue;
        const Ray ray = PixelRay(view.value().frame, column + 0.5, row + 0.5);
        const Vec3 at = ray.origin + samples.depth[i] * ray.direction;
        EXPECT_NEAR(Length(at), 10, 2 * 20.0 / 63);
        const Vec3 normal{samples.normal[i][0], samples.normal[i][1], samples.normal[i][2]};
        sum += std::acos(std::min(1.0, Dot(normal, Normalized(at))));
        ++count;
      }
    ASSERT_GT(count, 1000);
    sum /= count;
  }
  EXPECT_LT(mean[0], 0.04);
  EXPECT_LT(mean[0], mean[1]);
  EXPECT_LT(mean[1], mean[2]);
}

TEST(VoxelMethod, FacesAreLeftOut) {
  const Model model = ClosedSolid(LooseBox({8, 8, 8}, 0, 1));
  const Scene scene(model);
  const DirectOptions direct;
  const Camera camera = View(model, Projection::kOrthographic);
  const auto voxels = Voxelized(scene, direct, {}, 32);
  const SampleBuffer all = Traced(*voxels, camera);
  std::vector<bool> leave_out(model.PlacedFaceCount(), false);
  const std::size_t middle = static_cast<std::size_t>(kSize / 2 * kSize + kSize / 2);
  const std::uint32_t front = all.face[middle + 10 * kSize + 10];
  leave_out[front] = true;
  const SampleBuffer rest = Traced(*voxels, camera, &leave_out);
  int behind = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!std::isfinite(all.depth[i])) continue;
    EXPECT_GE(rest.depth[i], all.depth[i]);
    behind += all.face[i] == front && rest.depth[i] > all.depth[i] + 1;
  }
  EXPECT_GT(behind, 300);
  leave_out.assign(leave_out.size(), true);
  for (const double depth : Traced(*voxels, camera, &leave_out).depth) EXPECT_EQ(depth, INFINITY);

  const auto grid = Voxelized(scene, direct, {.normals = VoxelNormals::kGrid}, 32);
  EXPECT_EQ(grid->Trace(camera, {.leave_out = &leave_out}, {}).error().code, ErrorCode::kBadUsage);
}

TEST(VoxelMethod, RefusesWhatItCannotDo) {
  const Model model = ClosedSolid(LooseBox({8, 8, 8}, 0, 1));
  const Scene scene(model);
  DirectOptions direct;
  const auto made = [&](double setting, const VoxelLook& look) {
    return VoxelMethod().make(
        {.scene = scene, .direct = direct, .execution = {}, .max_bytes = 1 << 20, .voxels = look}, setting);
  };
  for (const double setting : {1.0, 2.5, 65537.0, double(NAN)})
    EXPECT_EQ(made(setting, {}).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(made(8, {.encoding = "none"}).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(made(4096, {.encoding = "raw"}).error().code, ErrorCode::kLimitExceeded);
  direct.sections = {{{0, 0, 0}, {0, 0, 1}}};
  EXPECT_EQ(made(8, {}).error().code, ErrorCode::kBadUsage);
}

}  // namespace
}  // namespace facetless
