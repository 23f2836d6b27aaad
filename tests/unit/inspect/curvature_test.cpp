// Curvature from the ray to the number, compared with closed forms: sphere, torus, cylinder, cone, under
// placements that turn, scale and mirror. A rational free-form patch is compared with differences in extended
// precision.
#include "render/inspect/curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/shapes.h"
#include "tests/unit/inspect/traced.h"

namespace facetless {
namespace {

using std::numbers::pi;
using testing::Frustum;
using testing::ModelOf;
using testing::Sphere;
using testing::Torus;
using testing::Traced;

constexpr double kRelative = 1e-9;
// Near a pole digits are lost, because second derivatives cancel to the square of the distance.
constexpr double kAwayFromPole = 0.1;

// A placement: turned about the x axis by `angle`, scaled, moved; mirrored in x if requested.
Placement Turned(double angle, double scale, bool mirrored) {
  Placement placement;
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  const double m[3][4] = {{mirrored ? -scale : scale, 0, 0, 5}, {0, c, -s, -3}, {0, s, c, 8}};
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 4; ++k) placement.m[r][k] = m[r][k];
  return placement;
}

Model PlacedModel(const testing::PatchGrid& grid, const Placement& placement) {
  Model model = ModelOf({grid});
  testing::Place(&model, placement);
  Box3 bounds;
  for (int i = 0; i < 8; ++i)
    bounds.Add(placement.Point({i & 1 ? model.bounds.high.x : model.bounds.low.x,
                                i & 2 ? model.bounds.high.y : model.bounds.low.y,
                                i & 4 ? model.bounds.high.z : model.bounds.low.z}));
  model.bounds = bounds;
  return model;
}

// Compares every hit's number with `expected(u, v)`, and skips hits for which that is NaN. `absolute` is the
// tolerance for zero.
template <typename Expected>
void ExpectValues(const Traced& traced, const std::string& shade, double absolute, const Expected& expected) {
  const PerSample<double> values = traced.Values(shade);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < traced.size(); ++i) {
    if (!traced.Hit(i)) {
      EXPECT_EQ(values[i], INFINITY);
      continue;
    }
    const auto [u, v] = traced.result.samples.uv[i];
    const double right = expected(u, v);
    if (std::isnan(right)) continue;
    ++compared;
    ASSERT_NEAR(values[i], right, std::max(absolute, kRelative * std::fabs(right)))
        << shade << " at " << u << ", " << v;
  }
  EXPECT_GT(compared, traced.size() / 20) << shade;
}

TEST(Curvature, OfASphereIsThatOfItsRadius) {
  constexpr double kRadius = 7.5;
  for (const bool mirrored : {false, true}) {
    for (const double scale : {1.0, 2.5}) {
      const Traced traced(PlacedModel(Sphere({3, -2, 5}, kRadius), Turned(0.7, scale, mirrored)));
      const double r = scale * kRadius;
      const auto away = [&](double number) {
        return [number](double, double v) { return std::fabs(v) < pi / 2 - kAwayFromPole ? number : NAN; };
      };
      ExpectValues(traced, "curvature:kind=mean", 0, away(1 / r));
      ExpectValues(traced, "curvature:kind=gaussian", 0, away(1 / (r * r)));
      ExpectValues(traced, "curvature:kind=max", 0, away(1 / r));
      ExpectValues(traced, "curvature:kind=min", 0, away(1 / r));
    }
  }
}

TEST(Curvature, OfATorusIsThatOfItsTubeAndOfItsParallel) {
  constexpr double kMajor = 20, kMinor = 6;
  const Traced traced(PlacedModel(Torus({1, 2, 3}, kMajor, kMinor), Turned(-0.4, 0.5, false)));
  const auto parallel = [](double v) { return 2 * std::cos(v) / (kMajor + kMinor * std::cos(v)); };
  const auto tube = 2 / kMinor;
  ExpectValues(traced, "curvature:kind=max", 0, [&](double, double) { return tube; });
  ExpectValues(traced, "curvature:kind=min", 1e-12, [&](double, double v) { return parallel(v); });
  ExpectValues(traced, "curvature:kind=mean", 1e-12,
               [&](double, double v) { return (tube + parallel(v)) / 2; });
  ExpectValues(traced, "curvature:kind=gaussian", 1e-12,
               [&](double, double v) { return tube * parallel(v); });
}

TEST(Curvature, OfACylinderVanishesAlongIt) {
  constexpr double kRadius = 4;
  const Traced traced(PlacedModel(Frustum({0, 0, 0}, kRadius, kRadius, 15), Turned(0.3, 1, false)));
  // Seen from inside, the same surface is concave. An open cylinder shows both sides, but has only one
  // outside.
  ExpectValues(traced, "curvature:kind=mean", 0, [](double, double) { return 1 / (2 * kRadius); });
  ExpectValues(traced, "curvature:kind=gaussian", 1e-14, [](double, double) { return 0.0; });
  ExpectValues(traced, "curvature:kind=min", 1e-14, [](double, double) { return 0.0; });
}

TEST(Curvature, OfAReversedFaceHasTheOtherSign) {
  Model model = ModelOf({Sphere({0, 0, 0}, 3)});
  model.faces[0].reversed = true;
  const Traced traced(std::move(model));
  ExpectValues(traced, "curvature:kind=max", 0,
               [](double, double v) { return std::fabs(v) < pi / 2 - kAwayFromPole ? -1.0 / 3 : NAN; });
  ExpectValues(traced, "curvature:kind=gaussian", 0,
               [](double, double v) { return std::fabs(v) < pi / 2 - kAwayFromPole ? 1.0 / 9 : NAN; });
}

TEST(Curvature, HasNoNumberAtAPole) {
  const Model model = ModelOf({Sphere({0, 0, 0}, 3), Frustum({9, 0, 0}, 3, 0, 4)});
  const SurfaceEval sphere(model, 0), cone(model, 1);
  EXPECT_FALSE(CurvatureAt(sphere.Second(1, pi / 2), 1, 2 * pi, pi));
  EXPECT_FALSE(CurvatureAt(cone.Second(1, 4), 1, 2 * pi, 4));
  EXPECT_TRUE(CurvatureAt(sphere.Second(1, pi / 2 - 1e-3), 1, 2 * pi, pi));
  // The number of pixels is odd, so from above the middle one looks at the pole. Its value must be a number
  // or missing.
  const Traced traced(ModelOf({Sphere({0, 0, 0}, 3)}), "top", Projection::kOrthographic, 33);
  for (const double value : traced.Values("curvature")) EXPECT_FALSE(std::isnan(value));
}

TEST(Curvature, OfAFreeFormPatchIsThatOfItsDifferences) {
  // A rational bicubic patch with random points and weights.
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 engine(kSeed);
  const auto number = [&] { return double(engine() >> 11) * 0x1p-52 - 1; };
  testing::PatchGrid grid{SurfaceKind::kBspline, 3, 3, {Span{}}, {Span{}}, {}};
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < 4; ++l) {
      const double w = 1 + 0.5 * number();
      grid.points.push_back({w * (k + 0.2 * number()), w * (l + 0.2 * number()), w * number(), w});
    }
  const Model model = ModelOf({grid});
  const SurfaceEval surface(model, 0);

  // Compute the same from positions in extended precision: fourth-order differences, then fundamental forms.
  using Real = long double;
  struct P {
    Real x, y, z;
  };
  const auto at = [&](Real u, Real v) {
    Real h[4] = {};
    const auto basis = [](int i, Real t) {
      return (i == 0 || i == 3 ? 1 : 3) * std::pow(t, Real(i)) * std::pow(1 - t, Real(3 - i));
    };
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) {
        const Vec4& p = grid.points[static_cast<std::size_t>(4 * k + l)];
        const Real b = basis(k, u) * basis(l, v);
        h[0] += b * p.x;
        h[1] += b * p.y;
        h[2] += b * p.z;
        h[3] += b * p.w;
      }
    return P{h[0] / h[3], h[1] / h[3], h[2] / h[3]};
  };
  const auto combine = [](std::initializer_list<std::pair<Real, P>> terms) {
    P sum{0, 0, 0};
    for (const auto& [f, p] : terms) sum.x += f * p.x, sum.y += f * p.y, sum.z += f * p.z;
    return sum;
  };
  const auto dot = [](P a, P b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
  const Real d = 1e-3L;
  for (int n = 0; n < 20; ++n) {
    const Real u = 0.5L + 0.4L * number(), v = 0.5L + 0.4L * number();
    const auto first = [&](Real du, Real dv) {
      return combine({{8 / (12 * d), at(u + du, v + dv)},
                      {-8 / (12 * d), at(u - du, v - dv)},
                      {-1 / (12 * d), at(u + 2 * du, v + 2 * dv)},
                      {1 / (12 * d), at(u - 2 * du, v - 2 * dv)}});
    };
    const auto second = [&](Real du, Real dv) {
      const Real q = 1 / (12 * d * d);
      return combine({{16 * q, at(u + du, v + dv)},
                      {16 * q, at(u - du, v - dv)},
                      {-30 * q, at(u, v)},
                      {-q, at(u + 2 * du, v + 2 * dv)},
                      {-q, at(u - 2 * du, v - 2 * dv)}});
    };
    const P su = first(d, 0), sv = first(0, d), suu = second(d, 0), svv = second(0, d), both = second(d, d);
    const P suv = combine({{0.5L, both}, {-0.5L, suu}, {-0.5L, svv}});
    P normal{su.y * sv.z - su.z * sv.y, su.z * sv.x - su.x * sv.z, su.x * sv.y - su.y * sv.x};
    const Real length = std::sqrt(dot(normal, normal));
    const Real e = dot(su, su), f = dot(su, sv), g = dot(sv, sv);
    const Real l = -dot(suu, normal) / length, m = -dot(suv, normal) / length,
               nn = -dot(svv, normal) / length;
    const Real gaussian = (l * nn - m * m) / (e * g - f * f),
               mean = (e * nn - 2 * f * m + g * l) / (2 * (e * g - f * f));
    const std::optional<Curvature> curvature = CurvatureAt(surface.Second(double(u), double(v)), 1, 1, 1);
    ASSERT_TRUE(curvature);
    // The error of the differences is the fourth power of their step.
    EXPECT_NEAR(curvature->mean(), double(mean), 1e-8 * (1 + std::fabs(double(mean))));
    EXPECT_NEAR(curvature->gaussian(), double(gaussian), 1e-8 * (1 + std::fabs(double(gaussian))));
    EXPECT_GE(curvature->max, curvature->min);
  }
}

TEST(Curvature, NormalCurvatureRunsBetweenThePrincipalOnes) {
  const Model model = ModelOf({Torus({0, 0, 0}, 20, 6)});
  const SurfacePoint point = SurfaceEval(model, 0).Second(0.3, 0.8);
  const std::optional<Curvature> curvature = CurvatureAt(point, 1, 2 * pi, 2 * pi);
  const std::optional<TangentFrame> frame = FrameAt(point, 1, 2 * pi, 2 * pi);
  ASSERT_TRUE(curvature && frame);
  const Vec3 along = curvature->max_direction, across = Cross(frame->normal, along);
  EXPECT_NEAR(NormalCurvature(point, *frame, along), curvature->max, 1e-13);
  EXPECT_NEAR(NormalCurvature(point, *frame, across), curvature->min, 1e-13);
  // Euler's formula: cos² times one curvature plus sin² times the other.
  EXPECT_NEAR(NormalCurvature(point, *frame, Normalized(along + across)), curvature->mean(), 1e-13);
}

}  // namespace
}  // namespace facetless
