// Orders and names of measured points.
#include "render/trade/trade.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/unit/trade/trade_points.h"

namespace facetless {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr ErrorMeasure kP99 = ErrorMeasure::kP99;

template <typename Setting>
std::vector<std::string> Names(const std::vector<Setting>& settings) {
  std::vector<std::string> names;
  for (const Setting& setting : settings) names.push_back(SettingName(setting));
  return names;
}

TEST(SettingNames, AreThoseOfTheOptions) {
  EXPECT_EQ(SettingName(DirectSetting{.precision = Precision::kFast}), "fast");
  EXPECT_EQ(SettingName(DirectSetting{.newton_tolerance = 1e-5}), "standard, tolerance 1e-5");
  EXPECT_EQ(SettingName(MeshSetting{1e-2, 30}), "mesh 1e-2, 30°");
  EXPECT_EQ(ShortSettingName(MeshSetting{0.00025, 12.5}), "0.00025, 12.5°");
  EXPECT_EQ(ShortSettingName(DirectSetting{.newton_tolerance = 1e-10}), "tol 1e-10");
}

TEST(ParetoFront, HoldsWhatNothingBeats) {
  const std::vector<TradePoint> points = {
      MeshPoint(1e-2, 1, 10),
      MeshPoint(1e-3, 0.1, 20),
      MeshPoint(1e-4, 0.01, 50),
      DirectPoint(Precision::kFast, 1e-6, 30),      // faster and more accurate than the finest mesh
      DirectPoint(Precision::kStandard, 1e-9, 40),  // more accurate and slower
      DirectPoint(Precision::kCertified, 1e-9, 60)  // equally accurate, and slower
  };
  EXPECT_THAT(ParetoFront(points, TradeCost::kTime, kP99, 1e-12), ElementsAre(0, 1, 3, 4));
}

TEST(ParetoFront, LooksAtTheCostThatItIsAskedFor) {
  const std::vector<TradePoint> points = {MeshPoint(1e-2, 1, 10, 900),
                                          DirectPoint(Precision::kFast, 0.5, 20, 100)};
  EXPECT_THAT(ParetoFront(points, TradeCost::kTime, kP99, 0), ElementsAre(0, 1));
  EXPECT_THAT(ParetoFront(points, TradeCost::kMemory, kP99, 0), ElementsAre(1));
}

TEST(ParetoFront, TakesErrorsBelowTheFloorForEqual) {
  const std::vector<TradePoint> points = {DirectPoint(Precision::kStandard, 1e-13, 40),
                                          DirectPoint(Precision::kCertified, 0, 50)};
  EXPECT_THAT(ParetoFront(points, TradeCost::kTime, kP99, 1e-12), ElementsAre(0));
  EXPECT_THAT(ParetoFront(points, TradeCost::kTime, kP99, 0), ElementsAre(0, 1));
}

TEST(ParetoFront, HoldsAllOfSeveralEqualPoints) {
  const std::vector<TradePoint> points = {MeshPoint(1e-3, 0.1, 20), MeshPoint(1e-3, 0.1, 20, 1, 12)};
  EXPECT_THAT(ParetoFront(points, TradeCost::kTime, kP99, 0), ElementsAre(0, 1));
}

TEST(ParetoFront, LeavesOutWhatWasNotMeasured) {
  const std::vector<TradePoint> points = {Skipped(MeshPoint(1e-2, 0, 0), "too slow")};
  EXPECT_THAT(ParetoFront(points, TradeCost::kTime, kP99, 0), IsEmpty());
}

RC_GTEST_PROP(ParetoFrontProperty, IsWhatItsDefinitionSays, ()) {
  const auto numbers = *rc::gen::container<std::vector<std::pair<int, int>>>(
      rc::gen::pair(rc::gen::inRange(0, 8), rc::gen::inRange(1, 8)));
  std::vector<TradePoint> points;
  for (const auto& [error, ms] : numbers) points.push_back(MeshPoint(1e-3, error, ms));
  MarkFronts(points, kP99, 1);
  for (const TradePoint& point : points) {
    bool beaten = false;
    for (const TradePoint& other : points) {
      const double error = std::max(1.0, point.deviation_mm.p99),
                   other_error = std::max(1.0, other.deviation_mm.p99);
      beaten = beaten || (other_error <= error && other.total_ms <= point.total_ms &&
                          (other_error < error || other.total_ms < point.total_ms));
    }
    RC_ASSERT(point.on_time_front == !beaten);
  }
}

TEST(TradePoint, TakesTheLargerOfDeviationAndOutlineForItsErrorInPixels) {
  TradePoint point = MeshPoint(1e-3, 0.25, 10);
  point.deviation_px_scale = 2;
  point.silhouette_offset_px = 0.1;
  EXPECT_EQ(point.ErrorPx(kP99), 0.5);
  EXPECT_EQ(point.ErrorPx(ErrorMeasure::kMax), 1.0);
  point.silhouette_offset_px = 0.7;
  EXPECT_EQ(point.ErrorPx(kP99), 0.7);
}

TEST(MeshSettings, GoFromCoarseToFineAndTryNarrowAnglesWhereTheyMatter) {
  EXPECT_THAT(
      Names(MeshSettings({1e-4, 1e-2, 1e-3, 1e-5, 1e-6}, {5, 30, 12})),
      ElementsAre("mesh 1e-2, 30°", "mesh 1e-3, 30°", "mesh 1e-3, 12°", "mesh 1e-4, 30°", "mesh 1e-4, 12°",
                  "mesh 1e-4, 5°", "mesh 1e-5, 30°", "mesh 1e-5, 5°", "mesh 1e-6, 30°"));
  EXPECT_THAT(Names(MeshSettings({1e-3, 1e-3}, {20})), ElementsAre("mesh 1e-3, 20°"))
      << "no setting may occur twice";
}

TEST(DirectSettings, HoldEveryPrecisionAndTolerance) {
  EXPECT_THAT(
      Names(DirectSettings({1e-8, 1e-3})),
      ElementsAre("fast", "standard, tolerance 1e-3", "standard, tolerance 1e-8", "standard", "certified"));
}

TEST(Refines, LooksAtTheDeflectionFirst) {
  const MeshSetting refused = {1e-4, 12};
  EXPECT_TRUE(Refines({1e-5, 30}, refused));
  EXPECT_TRUE(Refines({1e-4, 5}, refused));
  EXPECT_FALSE(Refines({1e-4, 30}, refused));
  EXPECT_FALSE(Refines({1e-3, 5}, refused));
}

}  // namespace
}  // namespace facetless
