// The projection of edges: a curve that lies on a surface must be projected to the parameter curve from which
// it was made, for every parametrisation, around seams and through poles.
#include "import/edge_projection.h"

#include <gtest/gtest.h>
#include <GeomConvert.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>

#include <cmath>
#include <numbers>
#include <random>

namespace facetless {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

struct Case {
  const char* name;
  Handle(Geom_Surface) surface;
  double u0, u1, v0, v1;  // range of the parameters of the curves
};

gp_Ax3 Placed(std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  return {gp_Pnt(50 * any(random), 50 * any(random), 50 * any(random)),
          gp_Dir(any(random), any(random), 1.5 + any(random))};
}

std::vector<Case> Cases(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0.2, 0.8);
  std::vector<Case> cases = {
      {"cylinder", new Geom_CylindricalSurface(Placed(random), 1 + 9 * share(random)), -5, 5, -20, 20},
      {"cone", new Geom_ConicalSurface(Placed(random), share(random), 5), -5, 5, 1, 20},
      {"sphere", new Geom_SphericalSurface(Placed(random), 10), -5, 5, -1.5, 1.5},
      {"torus", new Geom_ToroidalSurface(Placed(random), 10, 1 + 7 * share(random)), -5, 5, -5, 5}};
  // A rational B-spline patch of a sphere, whose parameters are not angles.
  const Handle(Geom_Surface) patch =
      new Geom_RectangularTrimmedSurface(new Geom_SphericalSurface(Placed(random), 10), 0.1, 1.9, -1.2, 1.2);
  cases.push_back({"spline", GeomConvert::SurfaceToBSplineSurface(patch), 0.1, 1.9, -1.2, 1.2});
  return cases;
}

class ProjectedEdges : public ::testing::TestWithParam<int> {};

TEST_P(ProjectedEdges, AreTheCurvesThatTheyWereMadeOf) {
  std::mt19937_64 random(20261130 + static_cast<std::uint64_t>(GetParam()));
  for (const Case& one : Cases(random)) {
    SCOPED_TRACE(one.name);
    const GeomAdaptor_Surface surface(one.surface);
    std::uniform_real_distribution<double> u(one.u0, one.u1), v(one.v0, one.v1);
    // A cubic in the parameter plane, as a curve in space.
    const Vec2 points[] = {
        {u(random), v(random)}, {u(random), v(random)}, {u(random), v(random)}, {u(random), v(random)}};
    const auto uv = [&](double s) {
      const double r = 1 - s;
      return r * r * r * points[0] + 3 * r * r * s * points[1] + 3 * r * s * s * points[2] +
             s * s * s * points[3];
    };
    const auto edge = [&](double s) { return surface.Value(uv(s).x, uv(s).y); };
    const std::vector<CurvePiece> pieces = ProjectEdge(surface, edge, {0, 0.5, 1}, 1e-8);
    ASSERT_FALSE(pieces.empty());
    EXPECT_EQ(pieces.front().begin, 0);
    EXPECT_EQ(pieces.back().end, 1);
    for (const CurvePiece& piece : pieces)
      for (int i = 0; i <= 10; ++i) {
        const double s = piece.begin + (piece.end - piece.begin) * i / 10;
        const Vec3 at = Cartesian(EvaluateBezier(piece.points, i / 10.0));
        EXPECT_LT(surface.Value(at.x, at.y).Distance(edge(s)), 1e-7) << s;
      }
    // The curve must be continuous: it must not jump by a period.
    const Vec3 first = Cartesian(pieces.front().points.front()),
               last = Cartesian(pieces.back().points.back());
    EXPECT_NEAR(last.x - first.x, points[3].x - points[0].x, 1e-6);
    EXPECT_NEAR(last.y - first.y, points[3].y - points[0].y, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ProjectedEdges, ::testing::Range(0, 40));

TEST(ProjectEdge, ALineOfParametersIsOnePieceOfDegreeOne) {
  const GeomAdaptor_Surface cylinder(new Geom_CylindricalSurface(gp_Ax3(), 3));
  for (const auto& [from, to] :
       {std::pair{Vec2{0, 1}, Vec2{kTurn, 1}}, {Vec2{2, -1}, Vec2{2, 9}}, {Vec2{6, 0}, Vec2{7, 5}}}) {
    const auto edge = [&, a = from, b = to](double s) {
      return cylinder.Value(a.x + s * (b.x - a.x), a.y + s * (b.y - a.y));
    };
    const std::vector<CurvePiece> pieces = ProjectEdge(cylinder, edge, {0, 1}, 1e-9);
    ASSERT_EQ(pieces.size(), 1u);
    EXPECT_EQ(pieces.front().degree(), 1);
  }
}

TEST(ProjectEdge, AMeridianKeepsItsAngleIntoThePole) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-3, 3);
  const GeomAdaptor_Surface sphere(new Geom_SphericalSurface(gp_Ax3(), 10));
  for (int i = 0; i < 20; ++i) {
    const double angle = any(random);
    const auto edge = [&](double s) { return sphere.Value(angle, std::numbers::pi * (s - 0.5)); };
    const std::vector<CurvePiece> pieces = ProjectEdge(sphere, edge, {0, 1}, 1e-9);
    ASSERT_EQ(pieces.size(), 1u);
    const Vec3 from = Cartesian(pieces.front().points.front()), to = Cartesian(pieces.front().points.back());
    EXPECT_NEAR(to.x, from.x, 1e-9);
    EXPECT_NEAR(to.y - from.y, std::numbers::pi, 1e-9);
  }
}

TEST(ProjectEdge, GivesUpWhereASeamHasTwoParameters) {
  // The surface is closed but not periodic: a point of the seam has two parameters, and the edge alone does
  // not determine which one is meant.
  Handle(Geom_BSplineSurface) closed = GeomConvert::SurfaceToBSplineSurface(
      new Geom_RectangularTrimmedSurface(new Geom_CylindricalSurface(gp_Ax3(), 3), 0.0, kTurn, 0.0, 5.0));
  closed->SetUNotPeriodic();
  const GeomAdaptor_Surface surface(closed);
  ASSERT_TRUE(surface.IsUClosed());
  EXPECT_TRUE(ProjectEdge(
                  surface, [&](double s) { return surface.Value(0, 5 * s); }, {0, 1}, 1e-9)
                  .empty());
}

}  // namespace
}  // namespace facetless
