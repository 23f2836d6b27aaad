// Pictures of voxels: light, shadows, and that walks and threads change nothing.
#include "render/voxel_walks/voxel_picture.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "render/voxel_walks/voxel_normal.h"
#include "tests/support/random_voxels.h"

namespace facetless {
namespace {

using testing::AnyModel;

constexpr Voxel kWhite = Voxel::Of(255, 255, 255);

VoxelGrid GridOf(const VoxelModel& model) {
  return {{-3, 5, 7}, 0.5, model.size()};
}

VoxelPicture Picture(const VoxelModel& model, const Camera& camera, const VoxelPictureOptions& options,
                     int threads = 1) {
  Result<VoxelPicture> picture = RenderVoxelPicture(model, GridOf(model), camera, options, {threads});
  EXPECT_TRUE(picture.ok());
  return std::move(picture).value();
}

Camera CameraOf(const VoxelModel& model, const std::string& view, Projection projection, int pixels) {
  return NamedView(view, GridOf(model).bounds(), projection, pixels, pixels).value();
}

RC_GTEST_PROP(VoxelPictures, AreTheSameByAllWalksAndThreads, ()) {
  const RunModel runs = AnyModel(20);
  const Projection projection =
      *rc::gen::arbitrary<bool>() ? Projection::kPerspective : Projection::kOrthographic;
  const Camera camera = CameraOf(runs, *rc::gen::elementOf(ViewNames()), projection, 24);
  VoxelPictureOptions options;
  options.levels = false;
  options.grid_normals = *rc::gen::arbitrary<bool>();
  options.lights = {{.at = {0.5 * *rc::gen::inRange(-20, 20), 9, 11}},
                    {.at = {40, -30, 60}, .color = {0.5, 0, 1}}};
  const auto octree = Converted(runs, "octree");
  const VoxelPicture expected = Picture(*octree.value(), camera, options);
  for (const NamedVoxelWalk& walk : VoxelWalks()) {
    if (!walk.exact) continue;
    const auto model = Converted(runs, walk.encoding);
    options.walk = walk.name;
    const VoxelPicture picture = Picture(*model.value(), camera, options, 2);
    if (picture.film.pixels != expected.film.pixels)
      RC_FAIL(std::string(walk.name) + " gives another picture");
    RC_ASSERT(picture.hits == expected.hits);
  }
}

// A floor, and a block that hovers over it.
RunModel Hovering() {
  RunModel model({40, 40, 40});
  model.Fill({{0, 0, 0}, {40, 40, 1}}, kWhite);
  model.Fill({{15, 15, 20}, {25, 25, 25}}, kWhite);
  return model;
}

// The light in the picture of a floor, seen from above, at a voxel of the floor.
float FloorAt(const VoxelPicture& picture, int x, int y) {
  return picture.film.pixels[static_cast<std::size_t>((39 - y) * 40 + x)][0];
}

TEST(VoxelPictures, PointLightsCastShadows) {
  const auto model = Converted(Hovering(), "octree");
  const VoxelGrid grid = GridOf(*model.value());
  Camera camera = CameraOf(*model.value(), "top", Projection::kOrthographic, 40);
  camera.height = 20;
  VoxelPictureOptions options;
  options.ambient = 0.25;
  options.lights = {{.at = grid.Corner({20, 5, 35}), .color = {0.5, 0.5, 0.5}}};
  const VoxelPicture picture = Picture(*model.value(), camera, options);
  EXPECT_EQ(picture.hits, 1600u);
  // The block's shadow lies beyond the block, as seen from the light.
  EXPECT_FLOAT_EQ(FloorAt(picture, 20, 37), 0.25f);
  EXPECT_GT(FloorAt(picture, 20, 2), 0.7f);
  EXPECT_LT(FloorAt(picture, 20, 2), 0.75f);
  // The top of the block is lit, and more obliquely where it is farther from the light.
  EXPECT_GT(FloorAt(picture, 20, 15), FloorAt(picture, 20, 24));
  EXPECT_GT(picture.shadow.rays, 1000u);
  // Without the light, there is ambient light alone.
  options.lights.clear();
  EXPECT_FLOAT_EQ(FloorAt(Picture(*model.value(), camera, options), 20, 2), 0.25f);
}

TEST(VoxelPictures, ALightBetweenCastsNoShadowOfWhatIsBeyondIt) {
  const auto model = Converted(Hovering(), "octree");
  const VoxelGrid grid = GridOf(*model.value());
  Camera camera = CameraOf(*model.value(), "bottom", Projection::kOrthographic, 40);
  VoxelPictureOptions options;
  options.lights = {{.at = grid.Corner({20, 20, 10})}};
  camera.eye = grid.Corner({20, 20, 5});
  camera.target = grid.Corner({20, 20, 30});
  camera.up = {0, 1, 0};
  camera.projection = Projection::kPerspective;
  camera.fov_y_deg = 20;
  // The eye and the light are inside the model, below the block, and see its lower side.
  const VoxelPicture picture = Picture(*model.value(), camera, options);
  EXPECT_EQ(picture.hits, 1600u);
  EXPECT_NEAR(picture.film.pixels[20 * 40 + 20][0], options.ambient + 1, 0.01);
}

TEST(VoxelPictures, SpaceAroundTheModelCostsNothing) {
  const auto model = Converted(Hovering(), "octree");
  Camera camera = CameraOf(*model.value(), "iso", Projection::kOrthographic, 100);
  camera.target = camera.target + Vec3{1000, 0, 0};
  camera.eye = camera.eye + Vec3{1000, 0, 0};
  VoxelPictureOptions options;
  options.background = Background::kTransparent;
  const VoxelPicture tiles = Picture(*model.value(), camera, options);
  EXPECT_EQ(tiles.primary.rays, 0u);
  EXPECT_EQ(tiles.film.pixels[5050][3], 0);
  options.walk = "kd-restart";
  EXPECT_EQ(Picture(*model.value(), camera, options).primary.rays, 0u);
}

TEST(VoxelPictures, SamplesAreAveraged) {
  const auto model = Converted(Hovering(), "octree");
  const Camera camera = CameraOf(*model.value(), "iso", Projection::kOrthographic, 20);
  VoxelPictureOptions options;
  options.samples_x = 3;
  options.samples_y = 2;
  const VoxelPicture picture = Picture(*model.value(), camera, options);
  EXPECT_EQ(picture.film.width, 20);
  EXPECT_EQ(picture.film.pixels.size(), 400u);
  EXPECT_GT(picture.hits, 400u);
}

TEST(VoxelPictures, ErrorsNameTheWalk) {
  const auto model = Converted(Hovering(), "runs");
  VoxelPictureOptions options;
  options.walk = "descent";
  const auto picture =
      RenderVoxelPicture(*model.value(), GridOf(*model.value()),
                         CameraOf(*model.value(), "iso", Projection::kOrthographic, 20), options, {});
  ASSERT_FALSE(picture.ok());
  EXPECT_EQ(picture.error().code, ErrorCode::kBadUsage);
}

TEST(VoxelNormals, OfAPlaneAndOfASheet) {
  RunModel model({20, 20, 20});
  model.Fill({{0, 0, 0}, {20, 20, 8}}, kWhite);
  // A slope that is a voxel thick: the empty voxels on both sides cancel.
  for (int i = 0; i < 10; ++i) model.Fill({{5, 5 + i, 8 + i}, {15, 6 + i, 9 + i}}, kWhite);
  const RunModel& runs = model;
  const auto walk = BindVoxelWalk(runs, "");
  const auto normal = [&](Vec3 from, int* side) {
    VoxelRay ray;
    EXPECT_TRUE(ray.Enter(from, {0, 0.1, -1}, 0, runs.size()));
    WalkCounters counters;
    const VoxelHit hit = walk.value()->Walk(ray, {}, &counters);
    *side = hit.side;
    return GridNormal(runs, hit, ray.direction());
  };
  int side = 0;
  EXPECT_NEAR(normal({2.5, 5.5, 19}, &side).z, 1, 1e-12);
  EXPECT_EQ(normal({10.5, 8.5, 19}, &side).z, 1);
  EXPECT_EQ(side, 2);
}

TEST(VoxelNormals, OfASphere) {
  RunModel model({64, 64, 64});
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y)
      for (int z = 0; z < 64; ++z) {
        const Vec3 from{x - 31.5, y - 31.5, z - 31.5};
        if (Length(from) < 28) model.Set(x, y, z, Voxel::Of(255, y % 2 == 0 ? 9 : 0, 255));
      }
  const auto octree = Converted(model, "octree");
  const auto walk = BindVoxelWalk(*octree.value(), "");
  double worst = 1;
  for (int i = -20; i <= 20; ++i)
    for (int level = 0; level < 2; ++level) {
      VoxelRay ray;
      ASSERT_TRUE(ray.Enter({32 + i + 0.3, 100, 31.2}, {0, -1, 0}, 0, model.size()));
      WalkCounters counters;
      const VoxelHit hit = walk.value()->Walk(ray, {.footprint_0 = 2.0 * level, .footprint = 0}, &counters);
      ASSERT_TRUE(hit.hit());
      EXPECT_EQ(hit.level, level);
      const Vec3 normal = GridNormal(*octree.value(), hit, ray.direction());
      EXPECT_EQ(Length(normal - GridNormal(model, hit, ray.direction())), 0);
      EXPECT_EQ(SideNormal(hit, ray.direction()).y, 1);
      worst = std::min(worst, Dot(normal, Normalized(ray.PointAt(hit.t) - Vec3{32, 32, 32})));
    }
  EXPECT_GT(worst, 0.93);  // within 22°
}

}  // namespace
}  // namespace facetless
