#include "render/nurbs/angle_map.h"
#include "render/base/trigonometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/unit/nurbs/trim_models.h"

namespace facetless {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Distance in units in the last place of `expected`.
double Ulps(double value, double expected) {
  const double size = std::fabs(expected);
  return std::fabs(value - expected) / (std::nextafter(size, INFINITY) - size);
}

TEST(AngleMap, TangentAndArctangentAgreeWithTheLibrary) {
  trim_models::Random random(1);
  double worst_tan = 0, worst_atan = 0;
  for (int i = 0; i < 200000; ++i) {
    const double x = random.Uniform(-1.5, 1.5) * std::exp2(-random.Integer(0, 30));
    worst_tan = std::max(worst_tan, Ulps(PolyTan(x), std::tan(x)));
    const double y = random.Uniform(-1, 1) * std::exp2(random.Integer(-30, 30));
    worst_atan = std::max(worst_atan, Ulps(PolyAtan(y), std::atan(y)));
  }
  EXPECT_LE(worst_tan, 4);
  EXPECT_LE(worst_atan, 4);
  EXPECT_EQ(PolyTan(0), 0);
  EXPECT_EQ(PolyAtan(0), 0);
  EXPECT_EQ(PolyAtan(INFINITY), kPi / 2);
}

TEST(AngleMap, EndsMapToEndsExactly) {
  trim_models::Random random(2);
  for (int i = 0; i < 10000; ++i) {
    const double begin = random.Uniform(-7, 7), end = begin + random.Uniform(1e-3, 3);
    for (SpanMap map : {SpanMap::kLinear, SpanMap::kHalfAngle}) {
      const Span span{begin, end, map};
      EXPECT_EQ(BezierToNative(span, 0), begin);
      EXPECT_EQ(BezierToNative(span, 1), end);
      EXPECT_EQ(NativeToBezier(span, begin), 0);
      EXPECT_EQ(NativeToBezier(span, end), 1);
    }
  }
}

TEST(AngleMap, FollowsItsDefinition) {
  trim_models::Random random(3);
  for (int i = 0; i < 100000; ++i) {
    const double begin = random.Uniform(-7, 7), end = begin + random.Uniform(1e-3, 3),
                 t = random.Uniform(0, 1);
    const Span span{begin, end, SpanMap::kHalfAngle};
    const double half = 0.5 * (end - begin), middle = 0.5 * (begin + end);
    const double expected = middle + 2 * std::atan((2 * t - 1) * std::tan(0.5 * half));
    EXPECT_NEAR(BezierToNative(span, t), expected,
                8 * kEpsilon * std::max({1.0, std::fabs(begin), std::fabs(end)}));
  }
}

TEST(AngleMap, RoundTrips) {
  trim_models::Random random(4);
  for (int i = 0; i < 100000; ++i) {
    const double begin = random.Uniform(-7, 7), end = begin + random.Uniform(1e-2, 3);
    const double native = random.Uniform(begin - 0.01, end + 0.01);
    const double size = std::max({1.0, std::fabs(begin), std::fabs(end)});
    for (SpanMap map : {SpanMap::kLinear, SpanMap::kHalfAngle}) {
      const SpanParameter parameter{Span{begin, end, map}};
      EXPECT_NEAR(parameter.ToNative(parameter.ToBezier(native)), native, 16 * kEpsilon * size);
    }
  }
}

TEST(AngleMap, RatesAreTheDerivatives) {
  for (SpanMap map : {SpanMap::kLinear, SpanMap::kHalfAngle}) {
    const SpanParameter parameter{Span{0.5, 2.5, map}};
    for (double native = 0.6; native < 2.5; native += 0.1) {
      const double h = 1e-4, t = parameter.ToBezier(native);
      const double next = parameter.ToBezier(native + h), previous = parameter.ToBezier(native - h);
      EXPECT_NEAR(parameter.Rate(t), (next - previous) / (2 * h), 1e-7);
      EXPECT_NEAR(parameter.RateOfRate(t), (next - 2 * t + previous) / (h * h), 1e-6);
    }
  }
}

}  // namespace
}  // namespace facetless
