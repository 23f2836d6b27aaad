// Light in views: what each representation casts, and what a mesh gets wrong.
#include <gtest/gtest.h>

#include <cmath>

#include "render/accel/structures.h"
#include "render/baseline/mesh_file.h"
#include "render/compare/compare_view.h"
#include "render/compare/report.h"
#include "render/shade/environment.h"
#include "render/shade/studio.h"
#include "render/trace/direct.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

// A ball, whose shadows are known.
class BallTest : public ::testing::Test {
 protected:
  static constexpr double kRadius = 5;

  Camera Looking(const char* name, int size = 96) const {
    return NamedView(name, model_.bounds, Projection::kOrthographic, size, size, {.margin = 0.2}).value();
  }
  static ViewOptions Lit(int occlusion_rays = 0) {
    ViewOptions options;
    options.execution.threads = 2;
    options.light.shadows = true;
    options.light.occlusion_rays = occlusion_rays;
    return options;
  }

  const Model model_ = testing::ClosedSolid(testing::ModelOf({testing::Sphere({0, 0, 0}, kRadius)}));
  const Scene scene_{model_};
  const ExactSurfaces exact_{scene_, {}};
};

TEST_F(BallTest, HalfOfABallIsLitAndEveryRayIsProven) {
  const View view = RenderView(exact_, model_, Looking("iso"), Lit(16)).value();
  ASSERT_TRUE(view.light);
  const ViewLight& light = *view.light;
  const Vec3 key = TowardKeyLight(view.frame);
  for (std::size_t i = 0; i < view.samples.size(); ++i) {
    if (view.samples.face[i] == kNoIndex) continue;
    const Vec3 normal{view.samples.normal[i][0], view.samples.normal[i][1], view.samples.normal[i][2]};
    // Nothing shadows a ball: not itself, either, right up to the terminator.
    EXPECT_EQ(light.centres.key[i], Dot(Normalized(normal), key) > 0 ? 1 : 0) << "pixel " << i;
    EXPECT_EQ(light.centres.open[i], 1) << "pixel " << i;
  }
  EXPECT_GT(light.stats.samples, 900u);
  EXPECT_EQ(light.stats.certified_rays, light.stats.rays);
  EXPECT_EQ(light.rays->lift_mm(), 0);
}

TEST_F(BallTest, ACoarseMeshShadesItselfAndAFineOneHardly) {
  const Camera camera = Looking("iso");
  const auto false_share = [&](int longitudes) {
    const Mesh mesh = testing::BallMesh(kRadius, longitudes);
    const BaselineScene tree = BaselineScene::Build(mesh, {.threads = 2}).value();
    const Triangles triangles(tree, model_, {}, 0);
    const Representation* candidates[] = {&triangles};
    const ViewComparison compared = CompareView(exact_, candidates, model_, camera, Lit()).value();
    EXPECT_TRUE(compared.candidates[0].light);
    const LightDifference& light = compared.candidates[0].light->difference;
    EXPECT_TRUE(light.shadows);
    EXPECT_FALSE(light.occlusion);
    EXPECT_LE(light.false_self_shadow.value_or(0), light.lit_only_reference);
    EXPECT_EQ(compared.candidates[0].light->picture.width, camera.width_px);
    return static_cast<double>(light.lit_only_reference) / static_cast<double>(light.pixels);
  };
  const double coarse = false_share(16), fine = false_share(256);
  EXPECT_GT(coarse, 0.005);
  EXPECT_LT(fine, coarse / 4);
}

TEST_F(BallTest, TheGroundIsDarkUnderTheBallAndTransparentWhereItIsLit) {
  ViewOptions options = Lit(64);
  options.light.ground = true;
  options.background = Background::kTransparent;
  const View view = RenderView(exact_, model_, Looking("iso"), options).value();
  ASSERT_EQ(view.image.channels, 4);
  int shadow = 0, ground = 0;
  for (int y = 0; y < view.image.height; ++y)
    for (int x = 0; x < view.image.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * view.image.width + x;
      if (view.samples.face[i] != kNoIndex) continue;
      ++ground;
      EXPECT_EQ(view.light->centres.ground[i], 1);
      shadow += view.light->centres.key[i] == 0;
    }
  EXPECT_GT(shadow, 100);
  EXPECT_LT(shadow, ground / 2);
  EXPECT_EQ(view.image.at(0, 0)[3], 0) << "far from the ball, the ground is not seen";
}

TEST_F(BallTest, TheStructureDoesNotChangeThePicture) {
  ViewOptions options = Lit(4);
  options.light.ground = true;
  const Camera camera = Looking("left", 48);
  const Image8 usual = RenderView(exact_, model_, camera, options).value().image;
  for (const StructureName& structure : StructureNames()) {
    options.light.structure = structure.name;
    const View view = RenderView(exact_, model_, camera, options).value();
    EXPECT_EQ(view.image.bytes, usual.bytes) << structure.name;
    EXPECT_EQ(view.light->rays->structure(), structure.name);
  }
  options.light.structure = "no-such-structure";
  EXPECT_EQ(RenderView(exact_, model_, camera, options).error().code, ErrorCode::kBadUsage);
}

TEST_F(BallTest, AdaptiveAndUniformSamplesShowTheSameShadow) {
  ViewOptions options = Lit();
  options.light.ground = true;
  options.samples = 4;
  const Camera camera = Looking("iso");
  const View adaptive = RenderView(exact_, model_, camera, options).value();
  options.uniform_samples = true;
  const View uniform = RenderView(exact_, model_, camera, options).value();
  ASSERT_TRUE(adaptive.refined_pixels);
  // Rays from the samples of refined pixels are proven, too. A hit on the silhouette may be in doubt itself.
  EXPECT_GE(adaptive.light->stats.certified + 4, adaptive.light->stats.samples);
  EXPECT_GT(*adaptive.refined_pixels, 200u) << "the border of the shadow is refined";
  int differing = 0;
  for (std::size_t i = 0; i < uniform.image.bytes.size(); ++i)
    differing += std::abs(int{uniform.image.bytes[i]} - int{adaptive.image.bytes[i]}) > 4;
  EXPECT_LE(differing, 12);
}

TEST_F(BallTest, WithoutTheOptionsNothingIsCast) {
  ViewOptions options;
  options.execution.threads = 2;
  const View view = RenderView(exact_, model_, Looking("iso"), options).value();
  EXPECT_FALSE(view.light);
  EXPECT_TRUE(view.samples.uv.empty());
  EXPECT_TRUE(DirectJson(view)["light"].is_null());
}

// What a picture shows of linear light.
std::array<int, 3> Shown(Vec3 light) {
  const Vec3 tone = StudioTone(light);
  return {EncodeByte(static_cast<float>(tone.x)), EncodeByte(static_cast<float>(tone.y)),
          EncodeByte(static_cast<float>(tone.z))};
}

Vec3 InViewerAxes(const CameraFrame& frame, Vec3 v) {
  return {Dot(v, frame.right), -Dot(v, frame.down), -Dot(v, frame.forward)};
}

ViewOptions WithMaterial(const std::string& material, int bounces = 6) {
  ViewOptions options;
  options.execution.threads = 2;
  options.light.materials = {ParseMaterial(material).value()};
  options.light.bounces = bounces;
  return options;
}

TEST_F(BallTest, AMirrorShowsTheSurroundingsInTheReflectedDirection) {
  const View view = RenderView(exact_, model_, Looking("iso"), WithMaterial("*=mirror")).value();
  int checked = 0;
  for (int y = 0; y < view.image.height; ++y)
    for (int x = 0; x < view.image.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * view.image.width + x;
      if (view.samples.face[i] == kNoIndex) continue;
      const auto& n = view.samples.normal[i];
      const Vec3 normal = Normalized({n[0], n[1], n[2]}), d = view.frame.forward;
      const Vec3 reflected = d - (2 * Dot(normal, d)) * normal;
      const auto expected = Shown(0.94 * StudioSurroundings(InViewerAxes(view.frame, reflected)));
      // The normal of a sample is rounded to single precision.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(view.image.at(x, y)[c], expected[c], 1);
      ++checked;
    }
  EXPECT_GT(checked, 900);
  EXPECT_EQ(view.light->stats.certified_rays, view.light->stats.rays);
}

TEST_F(BallTest, GlassThatDoesNotRefractShowsWhatIsBehindIt) {
  const View view = RenderView(exact_, model_, Looking("iso"), WithMaterial("*=glass:1")).value();
  const Vec3 behind = StudioSurroundings({0, 0, -1});
  const Color color = FaceColors(model_)[0];
  const auto through = [&](double light, double channel) {
    const double tint = 0.92 + 0.08 * SrgbToLinear(channel);
    return light * tint * tint;  // the ray passes two faces
  };
  const auto expected =
      Shown({through(behind.x, color.r), through(behind.y, color.g), through(behind.z, color.b)});
  int checked = 0;
  for (int y = 0; y < view.image.height; ++y)
    for (int x = 0; x < view.image.width; ++x)
      if (view.samples.face[static_cast<std::size_t>(y) * view.image.width + x] != kNoIndex) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(view.image.at(x, y)[c], expected[c], 1);
        ++checked;
      }
  EXPECT_GT(checked, 900);
}

TEST_F(BallTest, ABallOfGlassTurnsThePictureOfItsSurroundingsUpsideDown) {
  // Above the middle of the ball, a ray leaves it downwards, and the other way around.
  const View view = RenderView(exact_, model_, Looking("front", 97), WithMaterial("*=glass:1.5")).value();
  const View plain = RenderView(exact_, model_, Looking("front", 97), WithMaterial("*=glass:1")).value();
  EXPECT_NE(view.image.bytes, plain.image.bytes);
  const auto brightness = [&](int y) {
    const std::uint8_t* p = view.image.at(48, y);
    return p[0] + p[1] + p[2];
  };
  EXPECT_GT(brightness(48 + 24), brightness(48 - 24)) << "the bright ceiling appears below";
  // The view is symmetric to the ball's seam, and rays that stay in its plane meet the seam again and again.
  EXPECT_GT(view.light->stats.certified, view.light->stats.samples * 95 / 100);
}

TEST_F(BallTest, ReflectionsDoNotDependOnThreadsAndEndAfterTheBounces) {
  for (const int bounces : {0, 1, 2, 6, kMostBounces}) {
    ViewOptions options = WithMaterial("*=glass:2.4", bounces);
    options.execution.threads = 1;
    const View one = RenderView(exact_, model_, Looking("iso"), options).value();
    options.execution.threads = 3;
    const View three = RenderView(exact_, model_, Looking("iso"), options).value();
    EXPECT_EQ(one.image.bytes, three.image.bytes);
    EXPECT_LE(one.light->stats.rays, one.light->stats.samples << (bounces + 2));
  }
  EXPECT_EQ(
      RenderView(exact_, model_, Looking("iso"), WithMaterial("*=mirror", kMostBounces + 1)).error().code,
      ErrorCode::kBadUsage);
}

TEST_F(BallTest, AMirrorOfTrianglesShowsNearlyTheSame) {
  const Camera camera = Looking("iso");
  const Mesh mesh = testing::BallMesh(kRadius, 256);
  const BaselineScene tree = BaselineScene::Build(mesh, {.threads = 2}).value();
  const Triangles triangles(tree, model_, {}, 0);
  const Representation* candidates[] = {&triangles};
  const Result<ViewComparison> compared =
      CompareView(exact_, candidates, model_, camera, WithMaterial("*=mirror"));
  if (triangles.names_faces()) {
    ASSERT_TRUE(compared.ok());
    EXPECT_LT(compared.value().candidates[0].difference.color.rms, 0.03);
  } else {
    EXPECT_EQ(compared.error().code, ErrorCode::kBadUsage);
  }
}

TEST_F(BallTest, AnInspectionHasNoLight) {
  ViewOptions options = Lit();
  options.inspection.kind = InspectionKind::kFaces;
  EXPECT_EQ(RenderView(exact_, model_, Looking("iso"), options).error().code, ErrorCode::kBadUsage);
}

}  // namespace
}  // namespace facetless
