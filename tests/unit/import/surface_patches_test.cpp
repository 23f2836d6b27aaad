// Surfaces as patches, compared with closed forms in native parameters.
#include "import/surface_patches.h"

#include <gtest/gtest.h>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "import/bezier_pieces.h"
#include "import/curve_pieces.h"

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kUlp = std::numeric_limits<double>::epsilon();

// A frame in a general position; left-handed if requested.
gp_Ax3 SomeFrame(bool left_handed = false) {
  gp_Ax3 axes(gp_Pnt(1, 2, 3), gp_Dir(1, 2, -2), gp_Dir(2, 1, 2));
  if (left_handed) axes.YReverse();
  return axes;
}

PatchGrid Grid(const Handle(Geom_Surface) & surface, const ParameterBox& box, bool whole = false) {
  Result<PatchGrid> grid = PatchesOf(surface, box, whole, gp_Trsf());
  EXPECT_TRUE(grid.ok()) << grid.error().message;
  return grid.ok() ? std::move(grid.value()) : PatchGrid{};
}

// Returns the largest distance to the surface at random parameters of the box.
double Deviation(const PatchGrid& grid, const Handle(Geom_Surface) & surface, const ParameterBox& box) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(box.u0, box.u1), v(box.v0, box.v1);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    const double s = u(random), t = v(random);
    worst = std::fmax(worst, Length(Cartesian(Evaluate(grid, s, t)) - ToVec3(surface->Value(s, t).XYZ())));
  }
  return worst;
}

void ExpectExact(const Handle(Geom_Surface) & surface, const ParameterBox& box, SurfaceKind kind) {
  const PatchGrid grid = Grid(surface, box);
  EXPECT_EQ(grid.kind, kind);
  EXPECT_FALSE(grid.approximated);
  EXPECT_LE(Deviation(grid, surface, box), 64 * kUlp * grid.size) << SurfaceKindName(kind);
  // The grid must cover the box without gaps.
  EXPECT_LE(grid.u_spans.front().begin, box.u0);
  EXPECT_GE(grid.u_spans.back().end, box.u1);
  EXPECT_LE(grid.v_spans.front().begin, box.v0);
  EXPECT_GE(grid.v_spans.back().end, box.v1);
  for (std::size_t i = 1; i < grid.u_spans.size(); ++i)
    EXPECT_EQ(grid.u_spans[i].begin, grid.u_spans[i - 1].end);
  for (std::size_t i = 1; i < grid.v_spans.size(); ++i)
    EXPECT_EQ(grid.v_spans[i].begin, grid.v_spans[i - 1].end);
}

TEST(SurfacePatches, QuadricsAreExactInTheirAngles) {
  for (const bool left_handed : {false, true}) {
    const gp_Ax3 axes = SomeFrame(left_handed);
    ExpectExact(new Geom_Plane(axes), {-3, 8, 2, 2.5}, SurfaceKind::kPlane);
    ExpectExact(new Geom_CylindricalSurface(axes, 2.5), {-1, 5.9, -7, 3}, SurfaceKind::kCylinder);
    ExpectExact(new Geom_ConicalSurface(axes, 0.4, 1.5), {0, 2 * kPi, 1, 9}, SurfaceKind::kCone);
    ExpectExact(new Geom_ConicalSurface(axes, -0.4, 1.5), {3, 9, -1, 2}, SurfaceKind::kCone);
    ExpectExact(new Geom_SphericalSurface(axes, 4), {0, 2 * kPi, -kPi / 2, kPi / 2}, SurfaceKind::kSphere);
    ExpectExact(new Geom_ToroidalSurface(axes, 5, 1), {-4, 4, 0, 2 * kPi}, SurfaceKind::kTorus);
    ExpectExact(new Geom_ToroidalSurface(axes, 1, 2), {0, 1, 5, 7}, SurfaceKind::kTorus);
  }
}

TEST(SurfacePatches, EverySpherePointHasTheRadius) {
  const PatchGrid grid = Grid(new Geom_SphericalSurface(gp_Ax3(), 3), {0, 2 * kPi, -kPi / 2, kPi / 2});
  for (int i = 0; i <= 100; ++i) {
    for (int j = 0; j <= 100; ++j) {
      const Vec3 p = Cartesian(Evaluate(grid, 2 * kPi * i / 100, -kPi / 2 + kPi * j / 100));
      EXPECT_LE(std::fabs(Length(p) - 3), 3 * 6 * kUlp);
    }
  }
}

TEST(SurfacePatches, PolesAreSinglePointsAndNothingLiesBeyondThem) {
  const PatchGrid sphere = Grid(new Geom_SphericalSurface(gp_Ax3(), 3), {0, 1, -kPi / 2, kPi / 2});
  EXPECT_EQ(sphere.v_spans.front().begin, -kPi / 2);
  EXPECT_EQ(sphere.v_spans.back().end, kPi / 2);
  EXPECT_FALSE(sphere.extendable_v);
  EXPECT_TRUE(sphere.extendable_u);
  const Vec3 a = Cartesian(Evaluate(sphere, 0, kPi / 2)), b = Cartesian(Evaluate(sphere, 1, kPi / 2));
  EXPECT_EQ(a.x, 0);
  EXPECT_EQ(b.x, 0);
  EXPECT_DOUBLE_EQ(a.z, b.z);
  // The cone is used up to its apex.
  const double apex = -2 / std::sin(0.5);
  const PatchGrid cone = Grid(new Geom_ConicalSurface(gp_Ax3(), 0.5, 2), {0, 6, apex, 3});
  EXPECT_EQ(cone.v_spans.front().begin, apex);
  EXPECT_EQ(Cartesian(Evaluate(cone, 2, apex)).x, 0);
  EXPECT_FALSE(cone.extendable_v);
  // A cone that ends before its apex is extended a little.
  EXPECT_TRUE(Grid(new Geom_ConicalSurface(gp_Ax3(), 0.5, 2), {0, 6, 0, 3}).extendable_v);
}

TEST(SurfacePatches, ABoxBeyondOnePeriodIsCoveredWithoutWrapping) {
  ExpectExact(new Geom_CylindricalSurface(gp_Ax3(), 1), {-9, 7, 0, 1}, SurfaceKind::kCylinder);
  ExpectExact(new Geom_ToroidalSurface(gp_Ax3(), 3, 1), {10, 16, -8, -2}, SurfaceKind::kTorus);
}

Handle(Geom_BSplineCurve) SomeBspline(bool rational) {
  TColgp_Array1OfPnt poles(1, 6);
  TColStd_Array1OfReal weights(1, 6), knots(1, 4);
  TColStd_Array1OfInteger multiplicities(1, 4);
  for (int i = 1; i <= 6; ++i) {
    poles(i) = gp_Pnt(3 + std::sin(i), 0.3 * i, 2.0 * i);
    weights(i) = rational ? 1 + 0.3 * (i % 3) : 1;
  }
  const double values[] = {-1, 0.25, 0.5, 4};
  const int counts[] = {4, 1, 1, 4};
  for (int i = 1; i <= 4; ++i) {
    knots(i) = values[i - 1];
    multiplicities(i) = counts[i - 1];
  }
  return new Geom_BSplineCurve(poles, weights, knots, multiplicities, 3);
}

TEST(SurfacePatches, ExtrusionsAndRevolutionsKeepTheProfilesParameter) {
  const gp_Dir direction(0.2, 0.1, 1);
  const gp_Ax1 axis(gp_Pnt(-4, -3, -2), gp_Dir(0, 0.1, 1));
  const gp_Ax2 axes(gp_Pnt(5, 1, 2), gp_Dir(1, -2, 0.3));
  struct Profile {
    Handle(Geom_Curve) curve;
    double first, last;
  };
  const Profile profiles[] = {{new Geom_Line(gp_Pnt(3, 1, 0), gp_Dir(0.3, 0.2, 1)), -2, 9},
                              {new Geom_Circle(axes, 1.5), 0.3, 6},
                              {new Geom_Ellipse(axes, 1.5, 0.4), -2, 2},
                              {new Geom_Parabola(axes, 0.7), -1, 2},
                              {SomeBspline(false), -1, 4},
                              {SomeBspline(true), -0.9, 3.3},
                              {new Geom_TrimmedCurve(SomeBspline(true), 0, 3), 0, 3}};
  for (const Profile& profile : profiles) {
    ExpectExact(new Geom_SurfaceOfLinearExtrusion(profile.curve, direction),
                {profile.first, profile.last, -3, 5}, SurfaceKind::kExtrusion);
    ExpectExact(new Geom_SurfaceOfRevolution(profile.curve, axis), {-1, 5, profile.first, profile.last},
                SurfaceKind::kRevolution);
  }
}

TEST(SurfacePatches, ARevolutionOfAHyperbolaIsApproximatedAndMeasured) {
  const gp_Ax2 axes(gp_Pnt(0, 0, 0), gp_Dir(0, 1, 0), gp_Dir(1, 0, 0));
  const Handle(Geom_Surface) surface =
      new Geom_SurfaceOfRevolution(new Geom_Hyperbola(axes, 2, 1), gp_Ax1(gp_Pnt(), gp_Dir(0, 0, 1)));
  const ParameterBox box{0, 6, -2, 2};
  const PatchGrid grid = Grid(surface, box);
  EXPECT_TRUE(grid.approximated);
  EXPECT_LE(grid.deviation, 1e-9);
  EXPECT_LE(Deviation(grid, surface, box), 2 * grid.deviation + 64 * kUlp * grid.size);
}

Handle(Geom_BSplineSurface) SomeSurface(bool rational) {
  TColgp_Array2OfPnt poles(1, 5, 1, 4);
  TColStd_Array2OfReal weights(1, 5, 1, 4);
  for (int i = 1; i <= 5; ++i) {
    for (int j = 1; j <= 4; ++j) {
      poles(i, j) = gp_Pnt(2 * i, 3 * j, std::sin(i * j));
      weights(i, j) = rational ? 0.5 + 0.25 * ((i + j) % 4) : 1;
    }
  }
  TColStd_Array1OfReal u_knots(1, 3), v_knots(1, 2);
  TColStd_Array1OfInteger u_counts(1, 3), v_counts(1, 2);
  u_knots(1) = 0;
  u_knots(2) = 3;
  u_knots(3) = 4;
  u_counts(1) = 4;
  u_counts(2) = 1;
  u_counts(3) = 4;
  v_knots(1) = 10;
  v_knots(2) = 20;
  v_counts(1) = 4;
  v_counts(2) = 4;
  return new Geom_BSplineSurface(poles, weights, u_knots, v_knots, u_counts, v_counts, 3, 3);
}

TEST(SurfacePatches, BsplinesAreExactAndKeepOnlyTheSpansInReach) {
  for (const bool rational : {false, true}) {
    const Handle(Geom_BSplineSurface) surface = SomeSurface(rational);
    ExpectExact(surface, {0, 4, 10, 20}, SurfaceKind::kBspline);
    ExpectExact(surface, {3.2, 3.9, 12, 13}, SurfaceKind::kBspline);
    const PatchGrid grid = Grid(surface, {3.2, 3.9, 12, 13});
    EXPECT_EQ(grid.rational, rational);
    EXPECT_EQ(grid.u_spans.size(), 1u);
    EXPECT_TRUE(grid.extendable_u);
    EXPECT_TRUE(grid.extendable_v);
    EXPECT_FALSE(Grid(surface, {0, 4, 12, 13}).extendable_u);
  }
}

TEST(SurfacePatches, LoopsThatLeaveTheSurfaceALittleAreFollowed) {
  const PatchGrid grid = Grid(SomeSurface(false), {-0.01, 4, 10, 20});
  EXPECT_EQ(grid.u_spans.front().begin, -0.01);
  EXPECT_LE(Deviation(grid, SomeSurface(false), {-0.01, 4, 10, 20}), 1e-13);
}

TEST(SurfacePatches, PeriodicBsplinesGoOnThroughTheirSeam) {
  Handle(Geom_BSplineSurface) surface;
  TColgp_Array2OfPnt poles(1, 6, 1, 3);
  for (int i = 1; i <= 6; ++i) {
    for (int j = 1; j <= 3; ++j)
      poles(i, j) = gp_Pnt((3 + j) * std::cos(i), (3 + 0.1 * j) * std::sin(i), 2 * j);
  }
  TColStd_Array1OfReal u_knots(1, 7), v_knots(1, 2);
  TColStd_Array1OfInteger u_counts(1, 7), v_counts(1, 2);
  for (int i = 1; i <= 7; ++i) {
    u_knots(i) = 0.5 + i * i * 0.1;
    u_counts(i) = 1;
  }
  v_knots(1) = 0;
  v_knots(2) = 1;
  v_counts(1) = v_counts(2) = 3;
  surface = new Geom_BSplineSurface(poles, u_knots, v_knots, u_counts, v_counts, 3, 2, true, false);
  const double first = u_knots(1), period = u_knots(7) - first;
  const ParameterBox box{first - 0.7 * period, first + 1.3 * period, 0.1, 0.8};
  const PatchGrid grid = Grid(surface, box);
  EXPECT_DOUBLE_EQ(grid.period_u, period);
  EXPECT_TRUE(grid.extendable_u);
  EXPECT_LE(Deviation(grid, surface, box), 1e-13);
}

TEST(SurfacePatches, UnclampedKnotsAreNoSpecialCase) {
  TColgp_Array2OfPnt poles(1, 5, 1, 2);
  for (int i = 1; i <= 5; ++i) {
    for (int j = 1; j <= 2; ++j) poles(i, j) = gp_Pnt(i, j, i * i);
  }
  TColStd_Array1OfReal u_knots(1, 9), v_knots(1, 2);
  TColStd_Array1OfInteger u_counts(1, 9), v_counts(1, 2);
  for (int i = 1; i <= 9; ++i) {
    u_knots(i) = i;
    u_counts(i) = 1;
  }
  v_knots(1) = 0;
  v_knots(2) = 1;
  v_counts(1) = v_counts(2) = 2;
  const Handle(Geom_BSplineSurface) surface =
      new Geom_BSplineSurface(poles, u_knots, v_knots, u_counts, v_counts, 3, 1);
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  EXPECT_EQ(u0, 4);
  ExpectExact(surface, {u0, u1, v0, v1}, SurfaceKind::kBspline);
}

TEST(SurfacePatches, TrimmedSurfacesAreStripped) {
  const Handle(Geom_Surface) surface =
      new Geom_RectangularTrimmedSurface(new Geom_CylindricalSurface(SomeFrame(), 2), 0.5, 2.0, -1.0, 4.0);
  ExpectExact(surface, {0.5, 2, -1, 4}, SurfaceKind::kCylinder);
}

TEST(SurfacePatches, BezierSurfaces) {
  TColgp_Array2OfPnt poles(1, 3, 1, 4);
  for (int i = 1; i <= 3; ++i) {
    for (int j = 1; j <= 4; ++j) poles(i, j) = gp_Pnt(i, j, i * j);
  }
  ExpectExact(new Geom_BezierSurface(poles), {0, 1, 0.25, 0.5}, SurfaceKind::kBezier);
}

TEST(SurfacePatches, OffsetsAreApproximatedAndMeasured) {
  const Handle(Geom_Surface) surface = new Geom_OffsetSurface(SomeSurface(false), 0.35);
  const ParameterBox box{0.5, 3.5, 11, 19};
  const PatchGrid grid = Grid(surface, box);
  EXPECT_EQ(grid.kind, SurfaceKind::kOffset);
  EXPECT_TRUE(grid.approximated);
  EXPECT_GT(grid.deviation, 0);
  EXPECT_LE(grid.deviation, 1e-7);
  EXPECT_LE(Deviation(grid, surface, box), 4 * grid.deviation);
}

TEST(SurfacePatches, PlacementMovesThePointsAndKeepsTheParameters) {
  gp_Trsf placement;
  placement.SetRotation(gp_Ax1(gp_Pnt(1, 0, 0), gp_Dir(1, 1, 0)), 0.7);
  const Handle(Geom_Surface) surface = new Geom_CylindricalSurface(SomeFrame(), 2);
  Result<PatchGrid> grid = PatchesOf(surface, {0, 3, 0, 1}, false, placement);
  ASSERT_TRUE(grid.ok());
  const Vec3 p = Cartesian(Evaluate(grid.value(), 1.25, 0.5));
  EXPECT_LE(Length(p - ToVec3(surface->Value(1.25, 0.5).Transformed(placement).XYZ())), 1e-14);
}

TEST(SurfacePatches, RefusesWhatHasNoBoundsOrNoArea) {
  EXPECT_FALSE(PatchesOf(new Geom_Plane(gp_Ax3()), {-INFINITY, 1, 0, 1}, true, gp_Trsf()).ok());
  EXPECT_FALSE(PatchesOf(new Geom_Plane(gp_Ax3()), {1, 1, 0, 1}, false, gp_Trsf()).ok());
  EXPECT_FALSE(PatchesOf(new Geom_Plane(gp_Ax3()), {NAN, 1, 0, 1}, false, gp_Trsf()).ok());
}

}  // namespace
}  // namespace facetless
