#include "render/nurbs/surface_eval.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"
#include "tests/unit/nurbs/trim_models.h"

namespace facetless {
namespace {

constexpr double kPi = 3.14159265358979323846;

void ExpectNear(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(SurfaceEval, SphereInLongitudeAndLatitude) {
  const Model model = trim_models::SphereModel();
  const SurfaceEval surface(model, 0);
  EXPECT_EQ(surface.u_begin(), 0);
  EXPECT_EQ(surface.v_end(), kPi / 2);
  trim_models::Random random(1);
  for (int i = 0; i < 2000; ++i) {
    // Test parameters slightly beyond the grid, too.
    const double u = random.Uniform(-0.05, 2 * kPi + 0.05),
                 v = random.Uniform(-kPi / 2 - 0.05, kPi / 2 + 0.05);
    const double cu = std::cos(u), su = std::sin(u), cv = std::cos(v), sv = std::sin(v);
    const SurfacePoint p = surface.Second(u, v);
    ExpectNear(p.position, {cu * cv, su * cv, sv}, 4e-15);
    ExpectNear(p.du, {-su * cv, cu * cv, 0}, 2e-14);
    ExpectNear(p.dv, {-cu * sv, -su * sv, cv}, 2e-14);
    ExpectNear(p.duu, {-cu * cv, -su * cv, 0}, 1e-13);
    ExpectNear(p.duv, {su * sv, -cu * sv, 0}, 1e-13);
    ExpectNear(p.dvv, {-cu * cv, -su * cv, -sv}, 1e-13);
    ExpectNear(surface.Position(u, v), p.position, 0);
    ExpectNear(surface.First(u, v).du, p.du, 0);
  }
}

TEST(SurfaceEval, PlaneIsTheIdentity) {
  const Model model = trim_models::PlaneModel(-2, 3, 10, 14);
  const SurfaceEval surface(model, 0);
  for (double u : {-3.0, -2.0, 0.0, 3.0})
    for (double v : {10.0, 11.5, 15.0}) {
      const SurfacePoint p = surface.Second(u, v);
      ExpectNear(p.position, {u, v, 0}, 1e-14);
      ExpectNear(p.du, {1, 0, 0}, 1e-15);
      ExpectNear(p.dv, {0, 1, 0}, 1e-15);
      ExpectNear(p.duu, {0, 0, 0}, 0);
      ExpectNear(p.duv, {0, 0, 0}, 1e-15);
    }
}

TEST(SurfaceEval, DegreesWithNoSecondDerivative) {
  const Model model = trim_models::HalfCylinderModel(3, 5);
  const SurfaceEval surface(model, 0);
  EXPECT_DOUBLE_EQ(surface.magnitude(), 5);
  const SurfacePoint p = surface.Second(1, 2);
  ExpectNear(p.position, {3 * std::cos(1), 3 * std::sin(1), 2}, 1e-14);
  ExpectNear(p.dvv, {0, 0, 0}, 1e-15);
  ExpectNear(p.duu, {-3 * std::cos(1), -3 * std::sin(1), 0}, 1e-13);
}

TEST(SurfaceEval, DerivativesOfAHighDegreeMatchDifferences) {
  // One rational patch of bidegree 7 × 4 with random points.
  SurfaceGrid grid{SurfaceKind::kBspline, 7, 4, {{2, 5}}, {{0.2, 1.7, SpanMap::kHalfAngle}}, {}};
  trim_models::Random random(5);
  for (int i = 0; i < 8 * 5; ++i) {
    const double w = random.Uniform(0.5, 2);
    grid.points.push_back(
        {w * random.Uniform(-1, 1), w * random.Uniform(-1, 1), w * random.Uniform(-1, 1), w});
  }
  const Model model = testing::ModelOf({grid});
  const SurfaceEval surface(model, 0);
  const double h = 1e-5;
  for (double u = 2.1; u < 5; u += 0.4)
    for (double v = 0.3; v < 1.7; v += 0.3) {
      const SurfacePoint p = surface.Second(u, v), u1 = surface.First(u + h, v), u0 = surface.First(u - h, v),
                         v1 = surface.First(u, v + h), v0 = surface.First(u, v - h);
      const double half = 0.5 / h;
      ExpectNear(p.du, half * (u1.position - u0.position), 1e-7);
      ExpectNear(p.dv, half * (v1.position - v0.position), 1e-7);
      ExpectNear(p.duu, half * (u1.du - u0.du), 1e-6);
      ExpectNear(p.duv, half * (v1.du - v0.du), 1e-6);
      ExpectNear(p.dvv, half * (v1.dv - v0.dv), 1e-6);
    }
}

}  // namespace
}  // namespace facetless
