// The oracle judges the direct renderer: no certified sample may ever be wrong. Models and views are random,
// and aim at difficult places: along axes, through seams, poles, vertices, edges and corners of trims, from
// both sides.
#include "render/trace/direct.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/shapes.h"
#include "tests/verify/oracle/aim.h"
#include "tests/verify/oracle/judge.h"
#include "tests/verify/oracle/random_models.h"

namespace facetless::oracle {
namespace {

constexpr int kSize = 21;  // odd, so that a pixel centre is exactly in the middle
// The memory limit of a picture of that size. An explosion of leaves is a failure, which this limit ends
// quickly.
constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;
constexpr std::size_t kRandomSamples = 20, kHardSamples = 60;

// Counts what a property has judged, so that it cannot pass by judging nothing.
struct Judged {
  std::uint64_t samples = 0, certified = 0;
};

std::string Numbers(const Camera& camera) {
  char numbers[500];
  std::snprintf(numbers, sizeof numbers,
                "%s %s: eye %.17g,%.17g,%.17g target %.17g,%.17g,%.17g up %g,%g,%g height %.17g fov %.17g\n",
                camera.projection == Projection::kPerspective ? "perspective" : "orthographic",
                camera.name.c_str(), camera.eye.x, camera.eye.y, camera.eye.z, camera.target.x,
                camera.target.y, camera.target.z, camera.up.x, camera.up.y, camera.up.z, camera.height,
                camera.fov_y_deg);
  return numbers;
}

// A square picture of a window of the given size.
Camera WindowOf(Vec3 eye, Vec3 target, Vec3 up, double window) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.up = up;
  camera.height = window;
  camera.width_px = camera.height_px = kSize;
  return camera;
}

class DirectBeforeTheOracle : public ::testing::TestWithParam<Precision> {
 protected:
  DirectResult Traced(const Model& model, const Camera& camera) const {
    DirectOptions options;
    options.accuracy.precision = GetParam();
    options.depth_error = true;
    return TraceDirect(Scene(model), camera, options).value();
  }

  // Renders the view and lets the oracle judge it.
  void ExpectCertifiedSamplesRight(const Model& model, const Camera& camera, std::uint64_t seed) {
    const Result<void> valid = Validate(model);
    if (!valid.ok()) RC_FAIL(valid.error().message);
    DirectOptions options;
    options.accuracy.precision = GetParam();
    options.accuracy.max_bytes = kMostBytes;
    options.depth_error = true;
    const Result<DirectResult> direct = TraceDirect(Scene(model), camera, options);
    if (!direct.ok()) RC_FAIL(direct.error().message + "\n" + Numbers(camera));
    const SampleBuffer& samples = direct.value().samples;
    Random random(seed);
    std::vector<std::uint32_t> pixels =
        HardPixels(direct.value(), Features(model, 20, random), kHardSamples, random);
    for (const std::uint32_t pixel : RandomPixels(samples, kRandomSamples, random)) pixels.push_back(pixel);
    pixels.push_back(static_cast<std::uint32_t>(samples.size() / 2));  // the middle pixel
    judged_.samples += pixels.size();
    // The others are the slowest to judge, and may be wrong.
    std::erase_if(pixels,
                  [&](std::uint32_t pixel) { return samples.certificate[pixel] != Certificate::kCertified; });
    judged_.certified += pixels.size();
    const Oracle oracle(model);
    const Tally tally = JudgePixels(Judge(oracle, camera), samples, pixels);
    if (tally.CertifiedWrong() == 0) return;
    std::string text = Numbers(camera);
    for (const Judgement& judgement : tally.list)
      if (judgement.verdict == Verdict::kWrong && judgement.claim.certificate == Certificate::kCertified)
        text += Describe(judgement, model) + "\n";
    RC_FAIL(text);
  }

  // Judges a named view of the whole, and close-ups from the same side and from the opposite one. They show a
  // feature, or what a ray along an axis of the model meets.
  void LookAround(const Model& model) {
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    Random random(seed);
    const std::string view = ViewNames()[*rc::gen::inRange<std::size_t>(0, ViewNames().size())];
    const Projection projection =
        *rc::gen::arbitrary<bool>() ? Projection::kPerspective : Projection::kOrthographic;
    const int closeness = *rc::gen::inRange(0, 10);
    Camera camera = NamedView(view, model.bounds, projection, kSize, kSize).value();
    if (closeness > 0) {
      const Vec3 point = Features(model, 1, random)[0];
      const CameraFrame frame = MakeFrame(camera, model.Diagonal()).value();
      camera = CloseUp(camera, frame, point, model.Diagonal() * std::pow(10.0, -closeness), kSize);
    }
    ExpectCertifiedSamplesRight(model, camera, seed);
    camera.eye = camera.target + (camera.target - camera.eye);
    ExpectCertifiedSamplesRight(model, camera, seed);
  }

  // Runs a property and reports how much it has judged.
  template <typename Property>
  void Check(const char* description, const Property& property) {
    judged_ = {};
    EXPECT_TRUE(rc::check(description, property));
    // Cameras look closely at seams, poles and edges, where many samples are in doubt. But a property that
    // certifies few samples proves little.
    EXPECT_GT(judged_.certified, judged_.samples / 2) << "of " << judged_.samples << " samples";
  }

  Judged judged_;
};

SurfaceRecipe AnyRecipe() {
  SurfaceRecipe recipe;
  // All degrees that a file may have; most files have low ones.
  const auto degree =
      rc::gen::weightedOneOf<int>({{3, rc::gen::inRange(1, 8)}, {1, rc::gen::inRange(1, kMaxDegree + 1)}});
  recipe.degree_u = *degree;
  recipe.degree_v = *degree;
  recipe.spans_u = *rc::gen::inRange(1, 4);
  recipe.spans_v = *rc::gen::inRange(1, 4);
  recipe.bump = 0.1 * *rc::gen::inRange(0, 6);
  recipe.weight_spread = *rc::gen::element(1.0, 2.0, 10.0);
  recipe.seed = *rc::gen::arbitrary<std::uint64_t>();
  RC_LOG() << "degrees " << recipe.degree_u << "x" << recipe.degree_v << ", spans " << recipe.spans_u << "x"
           << recipe.spans_v << ", bump " << recipe.bump << ", weights " << recipe.weight_spread << ", seed "
           << recipe.seed << "\n";
  return recipe;
}

TEST_P(DirectBeforeTheOracle, RandomSurfaces) {
  Check("certified samples of B-splines are right", [this] { LookAround(RandomSurface(AnyRecipe())); });
}

TEST_P(DirectBeforeTheOracle, RandomTrims) {
  Check("certified samples of trimmed B-splines are right", [this] {
    Model model = RandomSurface(AnyRecipe());
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    AddRandomLoop(model, *rc::gen::inRange(3, 9), 0.99, false, seed);
    for (int holes = *rc::gen::inRange(0, 3); holes > 0; --holes)
      AddRandomLoop(model, *rc::gen::inRange(3, 7), 0.15 * holes, true,
                    seed + static_cast<std::uint64_t>(holes));
    LookAround(model);
  });
}

TEST_P(DirectBeforeTheOracle, QuadricsAndTori) {
  Check("certified samples of spheres, tori, cylinders and cones are right", [this] {
    using namespace facetless::testing;
    const double size = std::exp2(*rc::gen::inRange(-10, 11));
    const Vec3 center{*rc::gen::element(0.0, 1.0, 1000.0), 0, *rc::gen::element(0.0, 0.1)};
    Model model;
    switch (*rc::gen::inRange(0, 5)) {
      case 0:
        model = ModelOf({Sphere(center, size)});
        break;
      case 1:
        model = ModelOf({Torus(center, size, size * *rc::gen::element(0.01, 0.25, 0.99, 1.0, 1.5))});
        break;
      case 2:
        model = ModelOf({Frustum(center, size, size, 2 * size)});
        break;
      case 3:
        model = ModelOf({Frustum(center, size, 0, size)});
        break;
      default:  // two loops that touch
        model =
            ModelOf({Sphere(center, size), Frustum(center + Vec3{2 * size, 0, -size}, size, size, 2 * size)});
    }
    LookAround(model);
  });
}

TEST_P(DirectBeforeTheOracle, SolidsWithSharedEdges) {
  Check("certified samples of boxes are right, at their edges and vertices too", [this] {
    Random random(*rc::gen::arbitrary<std::uint64_t>());
    LookAround(SolidBox(*rc::gen::arbitrary<bool>() ? Placement{} : RandomPlacement(random)));
  });
}

// A sphere of a thousandth of a millimetre, a metre from the origin, with a column of pixel centres on the
// seam of two patches next to the pole. The rounding of a metre is 1e-10 of the sphere, and each patch is
// rounded separately. Leaves without a certificate once overlapped by less than that, and each of them left
// the root to the other.
TEST_P(DirectBeforeTheOracle, SeamsHoldFarFromTheOrigin) {
  const double radius = 0x1p-10;
  const Model model = facetless::testing::ModelOf({facetless::testing::Sphere({1000, 0, 0}, radius)});
  Camera camera = NamedView("back", model.bounds, Projection::kPerspective, kSize, kSize).value();
  const Vec3 pole{1000, 0, -radius};
  camera = CloseUp(camera, MakeFrame(camera, model.Diagonal()).value(), pole, 0.1 * model.Diagonal(), kSize);
  camera.eye = camera.target + (camera.target - camera.eye);
  DirectOptions options;
  options.accuracy.precision = GetParam();
  options.depth_error = true;
  const DirectResult direct = TraceDirect(Scene(model), camera, options).value();
  std::vector<std::uint32_t> pixels(direct.samples.size());
  std::iota(pixels.begin(), pixels.end(), 0u);
  const Oracle oracle(model);
  const Tally tally = JudgePixels(Judge(oracle, camera), direct.samples, pixels);
  for (const Judgement& judgement : tally.list)
    EXPECT_NE(judgement.verdict, Verdict::kWrong) << Describe(judgement, model);
  EXPECT_GT(direct.stats.hits, 100u);
}

// A roof of two patches. Continued beyond its border, each lies above the other. A root in the overlap of
// their leaves is no point of the surface, and the nearer of the two roots is always the wrong one.
TEST_P(DirectBeforeTheOracle, ARoofIsNotContinuedBeyondItsRidge) {
  const Model model = facetless::testing::ModelOf({facetless::testing::Roof()});
  const Oracle oracle(model);
  for (const double window : {1e-4, 1e-7, 1e-9, 1e-11, 1e-13}) {
    // The view is oblique, so that no border runs along rows or columns.
    const Camera camera = WindowOf({0, 0.1, 10}, {0, 0.1, 0}, {1, 0.7, 0}, window);
    const DirectResult direct = Traced(model, camera);
    const Judge judge(oracle, camera);
    for (int column = 0; column < kSize; ++column) {
      const Judgement judgement = judge.Ask(Judge::MakeClaim(direct.samples, column, kSize / 2));
      EXPECT_TRUE(judgement.verdict == Verdict::kRight ||
                  judgement.claim.certificate != Certificate::kCertified)
          << window << ": " << Describe(judgement, model);
      EXPECT_TRUE(judgement.claim.hit);
    }
  }
}

// A sphere and a cylinder of a thousandth of a millimetre that touch, a metre from the origin. Where one is
// in front of the other by less than single precision resolves, `fast` may show the wrong one, but its depth
// must be within the stated bound.
TEST_P(DirectBeforeTheOracle, FacesThatTouchAreAsNearAsIsSaid) {
  using namespace facetless::testing;
  const double radius = 0x1p-10;
  const Model model = ModelOf(
      {Sphere({1000, 0, 0}, radius), Frustum({1000 + 2 * radius, 0, -radius}, radius, radius, 2 * radius)});
  const Oracle oracle(model);
  std::uint64_t certified = 0;
  for (const double window : {1e-3, 1e-4, 1e-5, 4.7841596538733942e-07, 1e-8}) {
    const Vec3 target{1000 + radius, 0, 0};
    const Camera camera =
        WindowOf(target + Vec3{3 * radius, -3 * radius, 3 * radius}, target, {0, 0, 1}, window);
    const DirectResult direct = Traced(model, camera);
    std::vector<std::uint32_t> pixels(direct.samples.size());
    std::iota(pixels.begin(), pixels.end(), 0u);
    const Tally tally = JudgePixels(Judge(oracle, camera), direct.samples, pixels);
    EXPECT_EQ(tally.CertifiedWrong(), 0u) << window;
    for (const Judgement& judgement : tally.list)
      if (judgement.verdict == Verdict::kWrong && judgement.claim.certificate == Certificate::kCertified)
        ADD_FAILURE() << window << ": " << Describe(judgement, model);
    certified += direct.stats.certified;
  }
  EXPECT_GT(certified, 5 * kSize * kSize / 2u);
}

std::string PrecisionName(const ::testing::TestParamInfo<Precision>& info) {
  switch (info.param) {
    case Precision::kFast:
      return "Fast";
    case Precision::kStandard:
      return "Standard";
    case Precision::kCertified:
      return "Certified";
  }
  return "";
}

INSTANTIATE_TEST_SUITE_P(Every, DirectBeforeTheOracle,
                         ::testing::Values(Precision::kFast, Precision::kStandard, Precision::kCertified),
                         PrecisionName);

}  // namespace
}  // namespace facetless::oracle
