// The answers that measured points give: each number and each sentence.
#include "render/trade/trade_answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/trade/trade_points.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;

const TradeQuestionContext kContext = {"iso", ErrorMeasure::kP99, 1e-12, 1};

// The error falls with the deflection, and the time grows with its inverse. Both are powers, so that
// interpolation is exact.
std::vector<TradePoint> PowerLaw() {
  return {DirectPoint(Precision::kStandard, 0, 100, 50'000'000), MeshPoint(1e-2, 1, 10, 20'000'000),
          MeshPoint(1e-3, 0.1, 40, 30'000'000), MeshPoint(1e-4, 0.01, 160, 40'000'000),
          MeshPoint(1e-5, 0.001, 640, 45'000'000)};
}

TEST(LimitAnswer, IsTheCheapestMeshThatKeepsTheLimit) {
  const LimitAnswer answer = AnswerLimit(PowerLaw(), false, 0.05, kContext);
  EXPECT_EQ(answer.mesh, 3u);
  EXPECT_EQ(answer.direct, 0u);
  ASSERT_TRUE(answer.deflection.has_value());
  EXPECT_NEAR(*answer.deflection, 5e-4, 1e-12);
  EXPECT_EQ(answer.sentence,
            "View iso, error up to 0.05 mm (0.05 px): mesh 1e-4, 30° keeps it for 160 ms and 40 MB (0.01 mm "
            "in 99 % of the "
            "pixels, 0.02 mm at most); by interpolation a deflection of about 5e-4 would do. Direct, "
            "standard, keeps it "
            "for 100 ms and 50 MB.");
}

TEST(LimitAnswer, TakesALimitThatIsJustReached) {
  EXPECT_EQ(AnswerLimit(PowerLaw(), false, 0.1, kContext).mesh, 2u);
}

TEST(LimitAnswer, PrefersACheaperSettingToACoarserOne) {
  std::vector<TradePoint> points = PowerLaw();
  points.push_back(MeshPoint(1e-3, 0.02, 50, 30'000'000, 12));
  EXPECT_EQ(AnswerLimit(points, false, 0.05, kContext).mesh, 5u);
}

TEST(LimitAnswer, InterpolatesBetweenMeshesOfOneAngleOnly) {
  std::vector<TradePoint> points = PowerLaw();
  points.push_back(MeshPoint(1e-3, 0.02, 50, 30'000'000, 12));
  const LimitAnswer answer = AnswerLimit(points, false, 0.05, kContext);
  EXPECT_EQ(answer.angular_deg, 12);
  EXPECT_FALSE(answer.deflection.has_value()) << "there is only one mesh of 12°";
  EXPECT_THAT(answer.sentence, Not(HasSubstr("interpolation")));
}

TEST(LimitAnswer, DoesNotExtrapolate) {
  const LimitAnswer coarse = AnswerLimit(PowerLaw(), false, 5, kContext);
  EXPECT_EQ(coarse.mesh, 1u);
  EXPECT_FALSE(coarse.deflection.has_value());
  std::vector<TradePoint> points = PowerLaw();
  points.push_back(Skipped(MeshPoint(1e-6, 0, 0), "meshing takes longer than 60 s (--budget-seconds)"));
  const LimitAnswer fine = AnswerLimit(points, false, 1e-4, kContext);
  EXPECT_FALSE(fine.mesh.has_value());
  EXPECT_THAT(
      fine.sentence,
      HasSubstr(
          "no mesh that was measured keeps it; mesh 1e-5, 30° comes to 0.001 mm; mesh 1e-6, 30° was not "
          "measured: meshing takes longer than 60 s (--budget-seconds)."));
}

TEST(LimitAnswer, CountsTheOutlineInPixels) {
  std::vector<TradePoint> points = PowerLaw();
  for (TradePoint& point : points) point.deviation_px_scale = 10;
  EXPECT_EQ(AnswerLimit(points, true, 0.5, kContext).mesh, 3u);
  points[3].silhouette_offset_px = 0.6;
  EXPECT_EQ(AnswerLimit(points, true, 0.5, kContext).mesh, 4u);
  EXPECT_THAT(AnswerLimit(points, true, 0.5, kContext).sentence, HasSubstr("error up to 0.5 px (0.5 mm)"));
}

TEST(LimitAnswer, SaysWhenNothingWasMeasured) {
  const LimitAnswer answer =
      AnswerLimit({Skipped(MeshPoint(1e-2, 0, 0), "the importer was killed by SIGSEGV")}, false, 1, kContext);
  EXPECT_THAT(answer.sentence,
              HasSubstr("no mesh was measured; mesh 1e-2, 30° was not measured: the importer was killed"));
  EXPECT_THAT(answer.sentence, HasSubstr("No direct setting that was measured keeps it."));
}

TEST(LimitAnswer, IsNeverAnErrorThatIsNoNumber) {
  std::vector<TradePoint> points = PowerLaw();
  for (TradePoint& point : points) point.deviation_mm.p99 = NAN;
  EXPECT_FALSE(AnswerLimit(points, false, 1, kContext).mesh.has_value());
}

TEST(Crossover, LiesWhereTheInterpolatedCostsMeet) {
  const CrossoverAnswer answer = AnswerCrossover(PowerLaw(), TradeCost::kTime, kContext);
  EXPECT_EQ(answer.kind, Crossover::kAt);
  EXPECT_EQ(answer.coarser, 2u);
  EXPECT_EQ(answer.finer, 3u);
  // The time is 40·4^k for an error of 0.1·10^−k.
  ASSERT_TRUE(answer.error_mm.has_value());
  EXPECT_NEAR(*answer.error_mm, 0.1 * std::pow(10, -std::log(2.5) / std::log(4)), 1e-9);
  EXPECT_EQ(answer.sentence,
            "Time, view iso: direct is cheaper from an accuracy of about 0.022 mm on (0.022 px), "
            "interpolated between mesh "
            "1e-3, 30°, 40 ms, and mesh 1e-4, 30°, 160 ms.");
}

TEST(Crossover, SaysWhereTheMeasuredRangeEnds) {
  std::vector<TradePoint> points = PowerLaw();
  points.push_back(Skipped(MeshPoint(1e-6, 0, 0), "too slow"));
  const CrossoverAnswer mesh = AnswerCrossover(points, TradeCost::kMemory, kContext);
  EXPECT_EQ(mesh.kind, Crossover::kAlwaysMesh);
  EXPECT_EQ(mesh.finest_mm, 0.001);
  EXPECT_EQ(mesh.sentence,
            "Memory, view iso: the mesh is smaller at every accuracy that was measured, down to 0.001 mm "
            "(mesh 1e-5, 30°, "
            "45 MB); mesh 1e-6, 30° was not measured: too slow.");
  points[0].total_ms = 5;
  const CrossoverAnswer direct = AnswerCrossover(points, TradeCost::kTime, kContext);
  EXPECT_EQ(direct.kind, Crossover::kAlwaysDirect);
  EXPECT_EQ(direct.sentence,
            "Time, view iso: direct is cheaper than every mesh that was measured, from 1 mm (mesh 1e-2, 30°, "
            "10 ms) on; "
            "coarser meshes were not measured.");
}

TEST(Crossover, UsesTheCheapestDirectSettingThatIsAccurateEnough) {
  std::vector<TradePoint> points = PowerLaw();
  // This point is cheap, but accurate enough only for limits above 0.05 mm.
  points.push_back(DirectPoint(Precision::kFast, 0.05, 20, 1));
  const CrossoverAnswer answer = AnswerCrossover(points, TradeCost::kTime, kContext);
  EXPECT_EQ(answer.finer, 3u);
  EXPECT_NEAR(*answer.error_mm, 0.1 * std::pow(10, -std::log(2.5) / std::log(4)), 1e-9)
      << "between there and 0.05 mm the mesh is the cheaper one";
}

TEST(Crossover, KnowsAMeshThatIsExact) {
  const CrossoverAnswer answer = AnswerCrossover(
      {DirectPoint(Precision::kStandard, 0, 100), MeshPoint(1e-2, 1e-15, 10), MeshPoint(1e-3, 1e-15, 11)},
      TradeCost::kTime, kContext);
  EXPECT_EQ(answer.kind, Crossover::kAlwaysMesh);
  EXPECT_EQ(
      answer.sentence,
      "Time, view iso: the mesh is cheaper (mesh 1e-2, 30°, 10 ms), and exact: what is seen here is flat.");
}

TEST(Crossover, IsUnknownWithoutAMeshOrWithoutADirectPoint) {
  EXPECT_EQ(AnswerCrossover({DirectPoint(Precision::kStandard, 0, 1)}, TradeCost::kTime, kContext).kind,
            Crossover::kUnknown);
  EXPECT_EQ(AnswerCrossover({MeshPoint(1e-2, 1, 1)}, TradeCost::kTime, kContext).kind, Crossover::kUnknown);
}

// Two methods on the plot of PowerLaw: one that is cheap and coarse, and one that the direct tracer beats.
TEST(MethodSentences, SayWhetherAMethodIsEverTheCheapest) {
  static const Method kQuick{.name = "quick", .title = "Quick", .help = "It is quick."},
      kSlow{.name = "slow", .title = "Slow", .help = "It is slow."};
  std::vector<TradePoint> points = PowerLaw();
  points.push_back(PointOf(MethodChoice{&kQuick}, 0.5, 5));
  points.push_back(PointOf(MethodChoice{&kSlow}, 1e-9, 400));
  points.back().silhouette.pixels = 12;
  points.push_back(Skipped(PointOf(MethodChoice{&kSlow}, 0, 1), "it takes no such surface"));
  MarkFronts(points, kContext.measure, kContext.floor_mm);
  EXPECT_THAT(MethodSentences(points, kContext),
              testing::ElementsAre(
                  "View iso: Quick is the cheapest for an error of 0.5 mm, at 5 ms.",
                  "View iso: Slow is never the cheapest here: standard takes 100 ms instead of 400 ms, and "
                  "its error is "
                  "no larger; at 12 pixels only one of it and the certified image shows a surface."));
  EXPECT_TRUE(MethodSentences(PowerLaw(), kContext).empty());
}

TEST(NextView, LeavesOutWhatIsPaidOnce) {
  std::vector<TradePoint> points = PowerLaw();
  points[3].model_ms = 150;
  points[0].model_ms = 30;
  EXPECT_EQ(
      NextViewSentence(points, {AnswerLimit(points, false, 0.05, kContext)}),
      "A further view of the same model, with all that lasts at hand: 10 ms on mesh 1e-4, 30°, 70 ms direct, "
      "standard.");
  EXPECT_EQ(NextViewSentence(points, {}), "");
}

}  // namespace
}  // namespace facetless
