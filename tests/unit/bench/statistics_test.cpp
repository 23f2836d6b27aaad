#include "bench/statistics.h"

#include <gtest/gtest.h>

#include <string>

namespace facetless {
namespace {

TEST(Statistics, TheMedianIsTheMiddleOfTheSorted) {
  EXPECT_EQ(Median({3}), 3);
  EXPECT_EQ(Median({9, 1, 5}), 5);
  EXPECT_EQ(Median({8, 1, 2, 4}), 3);
}

TEST(Statistics, TheMedianRatioIsThatOfTheTurns) {
  // The second turn was disturbed on both sides.
  EXPECT_EQ(MedianRatio({2, 30, 4}, {1, 10, 2}), 2);
}

TEST(Statistics, TheGeometricMeanOfRatiosIsTheRatioOfMeans) {
  const double values[] = {0.5, 2, 8};
  EXPECT_NEAR(GeometricMean(values), 2, 1e-12);
  EXPECT_EQ(GeometricMean({}), 0);
}

TEST(Statistics, GrowthIsThePower) {
  const double x[] = {1, 10, 1000}, linear[] = {3, 30, 3000}, square[] = {1, 100, 1e6};
  EXPECT_NEAR(GrowthExponent(x, linear), 1, 1e-12);
  EXPECT_NEAR(GrowthExponent(x, square), 2, 1e-12);
}

TEST(Statistics, CompetitorsTakeTurns) {
  std::string order;
  const auto times = TakeTurns(3, {[&] { order += 'A'; }, [&] { order += 'B'; }});
  EXPECT_EQ(order, "ABABAB");
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[1].size(), 3u);
}

}  // namespace
}  // namespace facetless
