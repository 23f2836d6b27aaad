// Curves of every kind as Bézier pieces.
#include "import/curve_pieces.h"

#include <gtest/gtest.h>
#include <Geom2d_Circle.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_OffsetCurve.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <gp_Ax22d.hxx>

#include <cmath>
#include <limits>
#include <numbers>

namespace facetless {
namespace {

constexpr double kArc = std::numbers::pi / 4;

// Returns the largest distance to the curve at equal native parameters.
double Deviation(const CurvePieces& pieces, const Handle(Geom_Curve) & curve) {
  double worst = 0;
  for (const CurvePiece& piece : pieces.pieces) {
    for (int i = 0; i <= 16; ++i) {
      const double native = piece.begin + (piece.end - piece.begin) * i / 16;
      const Vec3 p =
          Cartesian(EvaluateBezier(piece.points, PieceParameter(piece.begin, piece.end, piece.map, native)));
      worst = std::fmax(worst, Length(p - ToVec3(curve->Value(native).XYZ())));
    }
  }
  return worst;
}

CurvePieces Pieces(const Handle(Geom_Curve) & curve, double first, double last,
                   Parametrization how = Parametrization::kNative) {
  Result<CurvePieces> result = PiecesOf(curve, first, last, kArc, how);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result.ok() ? std::move(result.value()) : CurvePieces{};
}

TEST(CurvePieces, ConicsAndLinesAreExactInTheirOwnParameter) {
  const gp_Ax2 axes(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 2), gp_Dir(1, -1, 0));
  EXPECT_LE(Deviation(Pieces(new Geom_Line(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 3)), -4, 9),
                      new Geom_Line(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 3))),
            1e-14);
  const Handle(Geom_Curve) circle = new Geom_Circle(axes, 5), ellipse = new Geom_Ellipse(axes, 5, 2),
                           parabola = new Geom_Parabola(axes, 3);
  EXPECT_LE(Deviation(Pieces(circle, -3, 8), circle), 1e-14);
  EXPECT_LE(Deviation(Pieces(ellipse, 0, 6.2), ellipse), 1e-14);
  EXPECT_LE(Deviation(Pieces(parabola, -2, 5), parabola), 1e-14);
}

TEST(CurvePieces, AHyperbolaIsExactInShapeOrInParameter) {
  const gp_Hypr hyperbola(gp_Ax2(), 2, 3);
  const Handle(Geom_Curve) curve = new Geom_Hyperbola(hyperbola);
  const CurvePieces shape = Pieces(curve, -1, 2, Parametrization::kEndsOnly);
  EXPECT_FALSE(shape.approximated);
  for (int i = 0; i <= 20; ++i) {
    const Vec3 p = Cartesian(EvaluateBezier(shape.pieces[0].points, i / 20.0));
    EXPECT_NEAR(p.x * p.x / 4 - p.y * p.y / 9, 1, 1e-13);
  }
  const CurvePieces native = Pieces(curve, -1, 2);
  EXPECT_TRUE(native.approximated);
  EXPECT_LE(Deviation(native, curve), 1e-9);
}

TEST(CurvePieces, PeriodicBsplinesUnroll) {
  TColgp_Array1OfPnt poles(1, 5);
  TColStd_Array1OfReal knots(1, 6);
  TColStd_Array1OfInteger counts(1, 6);
  for (int i = 1; i <= 5; ++i) poles(i) = gp_Pnt(std::cos(i), std::sin(2 * i), i % 3);
  for (int i = 1; i <= 6; ++i) {
    knots(i) = i;
    counts(i) = 1;
  }
  const Handle(Geom_Curve) curve = new Geom_BSplineCurve(poles, knots, counts, 2, true);
  EXPECT_LE(Deviation(Pieces(curve, -3.5, 8.25), curve), 1e-13);
}

TEST(CurvePieces, TrimmedCurvesInEitherSense) {
  const Handle(Geom_Curve) circle = new Geom_Circle(gp_Ax2(), 2);
  const Handle(Geom_Curve) forward = new Geom_TrimmedCurve(circle, 1, 4),
                           backward = new Geom_TrimmedCurve(circle, 1, 4, false);
  EXPECT_LE(Deviation(Pieces(forward, forward->FirstParameter(), forward->LastParameter()), forward), 1e-14);
  EXPECT_LE(Deviation(Pieces(backward, backward->FirstParameter(), backward->LastParameter()), backward),
            1e-14);
}

TEST(CurvePieces, OffsetsAreApproximatedAndMeasured) {
  const Handle(Geom_Curve) curve =
      new Geom_OffsetCurve(new Geom_Ellipse(gp_Ax2(), 5, 2), 0.5, gp_Dir(0, 0, 1));
  const CurvePieces pieces = Pieces(curve, 0, 6);
  EXPECT_TRUE(pieces.approximated);
  EXPECT_LE(Deviation(pieces, curve), 1e-8);
}

TEST(CurvePieces, LeftHandedCirclesInTheParameterPlane) {
  const Handle(Geom2d_Curve) circle = new Geom2d_Circle(gp_Ax22d(gp_Pnt2d(1, 2), gp_Dir2d(0, 1), false), 3);
  Result<CurvePieces> pieces = PiecesOf(circle, 0.5, 5, kArc, Parametrization::kEndsOnly);
  ASSERT_TRUE(pieces.ok());
  for (const CurvePiece& piece : pieces.value().pieces) {
    const Vec4 p = piece.points.front();
    const gp_Pnt2d q = circle->Value(piece.begin);
    EXPECT_NEAR(p.x / p.w, q.X(), 1e-14);
    EXPECT_NEAR(p.y / p.w, q.Y(), 1e-14);
    EXPECT_EQ(p.z, 0);
  }
}

TEST(CurvePieces, RefusesEmptyAndInfiniteRanges) {
  const Handle(Geom_Curve) line = new Geom_Line(gp_Pnt(), gp_Dir(1, 0, 0));
  EXPECT_FALSE(PiecesOf(line, 1, 1, kArc, Parametrization::kNative).ok());
  EXPECT_FALSE(PiecesOf(line, 0, 2e100, kArc, Parametrization::kNative).ok());
  EXPECT_FALSE(PiecesOf(line, NAN, 1, kArc, Parametrization::kNative).ok());
}

}  // namespace
}  // namespace facetless
