// Every pair of degrees that a file may have, 1 … 25 by 1 … 25, each once. It is rendered in every precision
// and with every instruction set, and judged by the oracle and by the independent check of certificates.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/kernels/dispatch.h"
#include "render/nurbs/bezier.h"
#include "render/trace/direct.h"
#include "render/trace/tile_tracer.h"
#include "tests/verify/oracle/aim.h"
#include "tests/verify/oracle/judge.h"
#include "tests/verify/oracle/random_models.h"

namespace facetless::oracle {
namespace {

constexpr int kSize = 19;
constexpr std::size_t kJudged = 4;  // samples of each picture: the oracle is slow for high degrees
// A patch of the highest degrees has 676 control points. If a picture needs more memory than this, leaves
// have exploded.
constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;

SurfaceRecipe RecipeOf(int degree_u, int degree_v) {
  SurfaceRecipe recipe;
  recipe.degree_u = degree_u;
  recipe.degree_v = degree_v;
  recipe.seed = static_cast<std::uint64_t>(100 * degree_u + degree_v);
  Random random(recipe.seed);
  recipe.bump = random.Uniform(0, 0.4);
  recipe.weight_spread = random.Below(3) == 0 ? 1 : random.Uniform(1, 5);
  return recipe;
}

Camera CameraOf(const Model& model, Random& random) {
  const std::string view = ViewNames()[random.Below(static_cast<std::uint32_t>(ViewNames().size()))];
  const Projection projection = random.Below(2) == 0 ? Projection::kPerspective : Projection::kOrthographic;
  return NamedView(view, model.bounds, projection, kSize, kSize).value();
}

// Returns all depths and leaves of one view.
std::vector<double> Answers(const TraceShared& shared, TileKernel kernel) {
  std::vector<double> answers;
  TileTracer tracer(shared, kernel, /*certify=*/true);
  for (int tile = 0; tile < shared.view.tiles->tiles_x() * shared.view.tiles->tiles_y(); ++tile) {
    tracer.Trace(tile, nullptr);
    for (int i = 0; i < tracer.rows() && !tracer.empty(); ++i) {
      for (int j = 0; j < tracer.columns(); ++j) {
        const int k = i * kTileSize + j;
        answers.push_back(tracer.depth[k]);
        answers.push_back(tracer.leaf[k]);
        answers.push_back(tracer.doubt[k]);
      }
    }
  }
  return answers;
}

class EveryPairOfDegrees : public ::testing::TestWithParam<int> {};

TEST_P(EveryPairOfDegrees, IsRenderedAsTheOracleSays) {
  const int degree_u = GetParam();
  std::uint64_t certified = 0, samples = 0;
  for (int degree_v = 1; degree_v <= kMaxDegree; ++degree_v) {
    SCOPED_TRACE(std::to_string(degree_u) + "×" + std::to_string(degree_v));
    const SurfaceRecipe recipe = RecipeOf(degree_u, degree_v);
    const Model model = RandomSurface(recipe);
    const Scene scene(model);
    Random random(recipe.seed);
    const Camera camera = CameraOf(model, random);
    const Oracle oracle(model);
    for (const Precision precision : {Precision::kFast, Precision::kStandard, Precision::kCertified}) {
      DirectOptions options;
      options.accuracy.precision = precision;
      options.accuracy.check = CheckLevel::kAll;
      options.depth_error = true;
      options.accuracy.max_bytes = kMostBytes;
      const Result<DirectResult> direct = TraceDirect(scene, camera, options);
      ASSERT_TRUE(direct.ok()) << direct.error().message;
      const DirectStats& stats = direct.value().stats;
      EXPECT_EQ(stats.check.roots_contradicted, 0u);
      EXPECT_EQ(stats.check.rays_contradicted, 0u);
      certified += stats.certified;
      samples += stats.rays;
      const std::size_t judged = degree_u * degree_v > 150 ? kJudged / 2 : kJudged;
      std::vector<std::uint32_t> pixels = RandomPixels(direct.value().samples, judged, random);
      std::erase_if(pixels, [&](std::uint32_t pixel) {
        return direct.value().samples.certificate[pixel] != Certificate::kCertified;
      });
      const Tally tally = JudgePixels(Judge(oracle, camera), direct.value().samples, pixels);
      for (const Judgement& judgement : tally.list)
        EXPECT_NE(judgement.verdict, Verdict::kWrong) << Describe(judgement, model);
    }

    // All instruction sets must give the same.
    for (const Precision precision : {Precision::kFast, Precision::kStandard}) {
      DirectOptions options;
      options.accuracy.precision = precision;
      const CameraFrame frame = MakeFrame(camera, model.Diagonal()).value();
      const PreparedView view = PrepareView(scene.data(), camera, frame, options).value();
      const TraceShared shared(scene.data(), view, camera, frame);
      std::vector<double> expected;
      for (const Kernels& kernels : AvailableKernels()) {
        const std::vector<double> answers =
            Answers(shared, precision == Precision::kFast ? kernels.trace_tile_float : kernels.trace_tile);
        if (expected.empty()) expected = answers;
        EXPECT_EQ(answers, expected) << kernels.isa;
      }
    }
  }
  EXPECT_GT(certified, samples * 3 / 4);
}

INSTANTIATE_TEST_SUITE_P(DegreeU, EveryPairOfDegrees, ::testing::Range(1, kMaxDegree + 1));

}  // namespace
}  // namespace facetless::oracle
