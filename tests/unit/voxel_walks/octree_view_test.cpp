// The rays of a picture meet the same voxels by the lists of their tiles as from the root, bit for bit.
#include "render/voxel_walks/octree_view.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/random_voxels.h"

namespace facetless {
namespace {

using testing::AnyModel;

double Within(double low, double high) {
  return low + (high - low) * 0.001 * *rc::gen::inRange(0, 1001);
}

// A camera that looks at some place of the grid from around it, or from within.
Camera AnyCamera(const VoxelGrid& grid) {
  const auto place = [&](double reach) {
    const Vec3 size = grid.bounds().high - grid.bounds().low;
    return grid.bounds().center() + Vec3{Within(-reach, reach) * size.x, Within(-reach, reach) * size.y,
                                         Within(-reach, reach) * size.z};
  };
  Camera camera;
  camera.projection = *rc::gen::arbitrary<bool>() ? Projection::kPerspective : Projection::kOrthographic;
  camera.target = place(0.5);
  camera.eye = place(*rc::gen::arbitrary<bool>() ? 0.5 : 3);
  // Views along an axis have rays whose components vanish.
  const int axis = *rc::gen::inRange(0, 6);
  if (axis == 0) camera.eye = camera.target + Vec3{0, Within(1, 50), 0};
  if (axis == 1) camera.eye = camera.target + Vec3{-Within(1, 50), 0, 0};
  camera.up = axis == 2 ? Vec3{0.1, 0.9, 0.3} : Vec3{0, 0, 1};
  camera.height = Within(0.1, 3) * grid.bounds().diagonal();
  camera.fov_y_deg = Within(1, 150);
  camera.width_px = *rc::gen::inRange(1, 40);
  camera.height_px = *rc::gen::inRange(1, 40);
  return camera;
}

void ExpectSameHits(const OctreeModel& octree, const VoxelGrid& grid, const Camera& camera) {
  const Result<CameraFrame> frame = MakeFrame(camera, grid.bounds().diagonal());
  if (!frame.ok()) return;
  const VoxelCamera rays(frame.value(), grid, camera.width_px, camera.height_px);
  const OctreeView view(octree, rays);
  const auto descent = BindVoxelWalk(octree, "descent");
  const bool levels = *rc::gen::arbitrary<bool>();
  const WalkOptions options = levels ? rays.Footprint() : WalkOptions{};
  for (int row = 0; row < camera.height_px; ++row)
    for (int column = 0; column < camera.width_px; ++column) {
      VoxelRay ray;
      const double x = column + Within(0, 1), y = row + Within(0, 1);
      if (!rays.EnterPixel(x, y, octree.size(), &ray)) continue;
      WalkCounters counters;
      const VoxelHit expected = descent.value()->Walk(ray, options, &counters);
      if (!view.MayHit(column, row)) {
        RC_ASSERT(!expected.hit());
        continue;
      }
      const VoxelHit hit = view.Walk(column, row, ray, options, &counters);
      RC_ASSERT(hit.hit() == expected.hit());
      if (!hit.hit()) continue;
      RC_ASSERT(hit.t == expected.t);
      RC_ASSERT(hit.at == expected.at);
      RC_ASSERT(hit.voxel == expected.voxel);
      RC_ASSERT(hit.side == expected.side);
      RC_ASSERT(hit.level == expected.level);
    }
}

RC_GTEST_PROP(OctreeViews, HaveTheHitsOfTheDescent, ()) {
  const RunModel model = AnyModel(*rc::gen::inRange(1, 60));
  const OctreeModel octree(model);
  const VoxelGrid grid{
      {Within(-100, 100), Within(-100, 100), Within(-100, 100)}, Within(0.1, 10), model.size()};
  for (int i = 0; i < 12; ++i) ExpectSameHits(octree, grid, AnyCamera(grid));
}

TEST(OctreeViews, EmptyTilesCostNothing) {
  RunModel model({64, 64, 64});
  model.Fill({{28, 28, 28}, {36, 36, 36}}, Voxel::Of(9, 9, 9));
  model.Set(30, 30, 36, Voxel::Of(8, 8, 8));
  const OctreeModel octree(model);
  const VoxelGrid grid{{0, 0, 0}, 1, model.size()};
  const Camera camera = NamedView("iso", grid.bounds(), Projection::kOrthographic, 128, 128).value();
  const VoxelCamera rays(MakeFrame(camera, grid.bounds().diagonal()).value(), grid, 128, 128);
  const OctreeView view(octree, rays);
  WalkCounters counters;
  int hits = 0;
  for (int row = 0; row < 128; ++row)
    for (int column = 0; column < 128; ++column) {
      VoxelRay ray;
      if (view.MayHit(column, row) && rays.EnterPixel(column + 0.5, row + 0.5, octree.size(), &ray))
        hits += view.Walk(column, row, ray, {}, &counters).hit();
    }
  EXPECT_GT(hits, 100);
  EXPECT_LT(counters.rays, 128u * 128u / 10);
  EXPECT_LT(counters.nodes, 8 * counters.rays);
  EXPECT_GT(view.bytes(), 0u);
}

}  // namespace
}  // namespace facetless
