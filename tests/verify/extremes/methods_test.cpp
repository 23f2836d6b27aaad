// What is said of methods at the extremes (docs/method-extremes.md), shown or refuted on a few rows of the catalogue.
#include "tests/verify/extremes/methods.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace facetless::extremes {
namespace {

constexpr const char* kClipping = "bezier-clipping";
constexpr const char* kRobust = "robust-clipping";
constexpr const char* kCoherent = "coherent-newton";
constexpr const char* kNewton = "newton-cramer";

const Extreme& RowOf(const std::string& input) {
  for (const Extreme& extreme : Catalogue())
    if (extreme.input.rfind(input, 0) == 0) return extreme;
  throw std::runtime_error("there is no row " + input);
}

// The outcomes of a row by method. No method may give samples that are not numbers.
std::map<std::string, MethodOutcome> Measured(const std::string& input,
                                              const std::vector<std::string>& methods) {
  const MethodMeasurement measured = MeasureMethods(RowOf(input), {.size = 17, .methods = methods});
  EXPECT_FALSE(measured.error) << input;
  std::map<std::string, MethodOutcome> outcomes;
  for (const MethodOutcome& outcome : measured.outcomes) {
    EXPECT_FALSE(outcome.error) << input << ": " << outcome.method;
    EXPECT_EQ(outcome.not_numbers, 0u) << input << ": " << outcome.method;
    outcomes[outcome.method] = outcome;
  }
  EXPECT_EQ(outcomes.size(), methods.size());
  return outcomes;
}

const std::vector<std::string> kClippers = {kClipping, kRobust, kCoherent};

TEST(MethodExtremes, ClippingLosesRootsBesideACollapsedSide) {
  for (const char* input : {"bicubic patch, one side collapsed", "bicubic patch, two opposite sides"}) {
    auto outcomes = Measured(input, kClippers);
    EXPECT_GT(outcomes[kClipping].lost, 0u) << input;
    EXPECT_GT(outcomes[kCoherent].lost, 0u) << input;
    EXPECT_EQ(outcomes[kRobust].wrong(), 0u) << input;
  }
}

TEST(MethodExtremes, ClippingLosesRootsOfASurfaceThatCrossesItself) {
  auto outcomes = Measured("a surface that crosses itself", kClippers);
  EXPECT_GT(outcomes[kClipping].lost, 0u);
  EXPECT_EQ(outcomes[kRobust].wrong(), 0u);
}

TEST(MethodExtremes, SteepWeightsMakeClippingImpreciseButLoseNothing) {
  auto outcomes = Measured("bicubic, one corner's weight of 1e-12", {kClipping, kRobust});
  EXPECT_GT(outcomes[kClipping].imprecise, outcomes[kRobust].imprecise);
  for (const char* method : {kClipping, kRobust})
    EXPECT_EQ(outcomes[method].lost + outcomes[method].invented, 0u) << method;
}

TEST(MethodExtremes, ClippingFindsThePoleOfASphere) {
  // It is often said to fail there: the row and column of the pole have no extent.
  auto outcomes = Measured("sphere of 1 mm, rays along the axis", kClippers);
  for (const std::string& method : kClippers) EXPECT_EQ(outcomes[method].wrong(), 0u) << method;
}

TEST(MethodExtremes, DistanceFromTheOriginAndHighDegreesDoNotMatterToClipping) {
  for (const char* input :
       {"1 mm, 1e7 mm from the origin by a placement", "degree 25 × 1, weights 1 to 1e6"}) {
    auto outcomes = Measured(input, kClippers);
    for (const std::string& method : kClippers) EXPECT_EQ(outcomes[method].wrong(), 0u) << input << method;
  }
}

TEST(MethodExtremes, NewtonFromTheMapLosesRootsAtSilhouettes) {
  auto outcomes = Measured("1 mm, 1e7 mm from the origin by a placement", {kNewton, kRobust});
  EXPECT_GT(outcomes[kNewton].lost, 0u);
  EXPECT_EQ(outcomes[kRobust].lost, 0u);
}

TEST(MethodExtremes, AModelThatIsNotValidIsRefusedBeforeAnyMethod) {
  const MethodMeasurement measured = MeasureMethods(RowOf("one inner weight of 0"), {});
  ASSERT_TRUE(measured.error);
  EXPECT_EQ(measured.error->code, ErrorCode::kFormatBroken);
  EXPECT_TRUE(measured.outcomes.empty());
}

TEST(MethodExtremes, AllSolversAreInTheTable) {
  const std::vector<std::string> names = MethodNames();
  for (const char* name : {"fast", kNewton, kClipping, kRobust, kCoherent})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
}

}  // namespace
}  // namespace facetless::extremes
