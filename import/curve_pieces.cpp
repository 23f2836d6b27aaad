#include "import/curve_pieces.h"

#include <GeomAPI.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>

#include "import/approximate.h"

namespace facetless {
namespace {

// The relative accuracy that an approximation aims at: below any tolerance that a CAD file states, above the
// rounding of the curve's evaluation.
constexpr double kRelativeTolerance = 1e-10;
// A smooth stretch is halved at most this often. A stretch that needs more halvings is not smooth.
constexpr int kMaxHalvings = 10;
// No thread or spring has more turns. The limit prevents a damaged parameter range from filling the memory.
constexpr double kMaxTurns = 4096;

Vec4 Affine(Vec3 p) {
  return {p.x, p.y, p.z, 1};
}

CurvePiece LinePiece(const gp_Lin& line, double first, double last) {
  const Vec3 origin = ToVec3(line.Location().XYZ()), direction = ToVec3(line.Direction().XYZ());
  return {
      first, last, SpanMap::kLinear, {Affine(origin + first * direction), Affine(origin + last * direction)}};
}

// The curve is C + u²/(4F)·X + u·Y. Its blossom at (a, b) replaces u² by ab and u by (a+b)/2.
CurvePiece ParabolaPiece(const gp_Parab& parabola, double first, double last) {
  const Vec3 center = ToVec3(parabola.Location().XYZ());
  const Vec3 x = ToVec3(parabola.XAxis().Direction().XYZ()), y = ToVec3(parabola.YAxis().Direction().XYZ());
  const auto blossom = [&](double a, double b) {
    return Affine(center + (a * b / (4 * parabola.Focal())) * x + (0.5 * (a + b)) * y);
  };
  return {first, last, SpanMap::kLinear, {blossom(first, first), blossom(first, last), blossom(last, last)}};
}

// The curve C + R·cosh(u)·X + r·sinh(u)·Y is one rational quadratic: the formula of an arc with hyperbolic
// functions.
CurvePiece HyperbolaPiece(const gp_Hypr& hyperbola, double first, double last) {
  const Vec3 center = ToVec3(hyperbola.Location().XYZ());
  const Vec3 x = hyperbola.MajorRadius() * ToVec3(hyperbola.XAxis().Direction().XYZ());
  const Vec3 y = hyperbola.MinorRadius() * ToVec3(hyperbola.YAxis().Direction().XYZ());
  const auto point = [&](double u, double weight) {
    const Vec3 p = weight * center + std::cosh(u) * x + std::sinh(u) * y;
    return Vec4{p.x, p.y, p.z, weight};
  };
  const double middle = 0.5 * (first + last), half = 0.5 * (last - first);
  return {first, last, SpanMap::kLinear, {point(first, 1), point(middle, std::cosh(half)), point(last, 1)}};
}

std::vector<CurvePiece> BezierPieces(const Geom_BezierCurve& curve, double first, double last) {
  const int degree = curve.Degree();
  std::vector<double> knots(2 * (degree + 1), 0.0);
  std::fill(knots.begin() + degree + 1, knots.end(), 1.0);
  std::vector<Vec4> poles;
  for (int i = 1; i <= degree + 1; ++i) {
    const double weight = curve.IsRational() ? curve.Weight(i) : 1;
    const Vec3 p = weight * ToVec3(curve.Pole(i).XYZ());
    poles.push_back({p.x, p.y, p.z, weight});
  }
  return BsplinePieces(knots, degree, poles, first, last);
}

std::vector<CurvePiece> BsplineCurvePieces(Handle(Geom_BSplineCurve) curve, double first, double last) {
  // Clamp a periodic curve at its origin. This inserts knots and moves no point.
  const bool periodic = curve->IsPeriodic();
  const double origin = curve->FirstParameter(), period = curve->LastParameter() - origin;
  if (periodic) {
    curve = Handle(Geom_BSplineCurve)::DownCast(curve->Copy());
    curve->SetNotPeriodic();
  }
  const int degree = curve->Degree();
  const TColStd_Array1OfReal& sequence = curve->KnotSequence();
  const std::vector<double> knots(sequence.begin(), sequence.end());
  std::vector<Vec4> poles;
  for (int i = 1; i <= curve->NbPoles(); ++i) {
    const double weight = curve->IsRational() ? curve->Weight(i) : 1;
    const Vec3 p = weight * ToVec3(curve->Pole(i).XYZ());
    poles.push_back({p.x, p.y, p.z, weight});
  }
  if (!periodic) return BsplinePieces(knots, degree, poles, first, last);
  // Take the stretch of each turn, and shift it by whole periods to its place in the range.
  std::vector<CurvePiece> pieces;
  const int first_turn = static_cast<int>(std::floor((first - origin) / period));
  for (int turn = first_turn; origin + turn * period < last; ++turn) {
    const double shift = turn * period;
    const double begin = std::max(first - shift, origin), end = std::min(last - shift, origin + period);
    const double rounding = 4 * std::max(std::fabs(first), std::fabs(last)) * 2.3e-16;
    if (!(end - begin > rounding)) continue;
    for (CurvePiece& piece : BsplinePieces(knots, degree, poles, begin, end)) {
      piece.begin += shift;
      piece.end += shift;
      if (!pieces.empty()) {
        piece.begin = pieces.back().end;
        piece.points.front() = pieces.back().points.back();
      }
      pieces.push_back(std::move(piece));
    }
  }
  if (!pieces.empty()) {
    pieces.front().begin = first;
    pieces.back().end = last;
  }
  return pieces;
}

// Returns the parameters between which the curve is smooth.
std::vector<double> SmoothBreaks(const Handle(Geom_Curve) & curve, double first, double last) {
  GeomAdaptor_Curve adaptor(curve, first, last);
  TColStd_Array1OfReal intervals(1, adaptor.NbIntervals(GeomAbs_CN) + 1);
  adaptor.Intervals(intervals, GeomAbs_CN);
  std::vector<double> breaks{first};
  for (double value : intervals) {
    if (value > breaks.back() && value < last) breaks.push_back(value);
  }
  breaks.push_back(last);
  return breaks;
}

CurvePieces Approximated(const Handle(Geom_Curve) & curve, double first, double last) {
  // The tolerance is relative to the curve's size, which the polygon of a few points gives.
  double size = 0;
  const Vec3 start = ToVec3(curve->Value(first).XYZ());
  for (int i = 1; i <= 8; ++i)
    size = std::fmax(size, Length(ToVec3(curve->Value(first + (last - first) * i / 8).XYZ()) - start));
  CurvePieces result;
  result.approximated = true;
  result.pieces = ApproximateCurve([&](double t) { return ToVec3(curve->Value(t).XYZ()); },
                                   SmoothBreaks(curve, first, last), kRelativeTolerance * size, kMaxHalvings,
                                   &result.deviation);
  return result;
}

Result<CurvePieces> Checked(CurvePieces result) {
  if (result.pieces.empty()) return Error{ErrorCode::kFormatBroken, "a curve has an empty parameter range"};
  for (const CurvePiece& piece : result.pieces) {
    for (const Vec4& p : piece.points) {
      if (!std::isfinite(p.x + p.y + p.z + p.w))
        return Error{ErrorCode::kFormatBroken, "a curve has a number that is not finite"};
      if (!(p.w > 0))
        return Error{
            ErrorCode::kFormatBroken,
            "the weights of a curve differ so much that some are lost in rounding; keep them within 1e12 of "
            "each other"};
    }
  }
  return result;
}

}  // namespace

Handle(Geom_Curve) Untrimmed(Handle(Geom_Curve) curve) {
  while (true) {
    const Handle(Geom_TrimmedCurve) trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve);
    if (trimmed.IsNull()) return curve;
    curve = trimmed->BasisCurve();
  }
}

Result<CurvePieces> PiecesOf(const Handle(Geom_Curve) & trimmed, double first, double last, double max_arc,
                             Parametrization parametrization) {
  if (!std::isfinite(first) || !std::isfinite(last) || !(first < last) || Precision::IsInfinite(first) ||
      Precision::IsInfinite(last))
    return Error{ErrorCode::kFormatBroken, "a curve has an empty or infinite parameter range"};
  const Handle(Geom_Curve) curve = Untrimmed(trimmed);
  if (curve->IsPeriodic() && last - first > kMaxTurns * curve->Period())
    return Error{ErrorCode::kLimitExceeded, "a curve goes around more than 4096 times"};
  if (const auto line = Handle(Geom_Line)::DownCast(curve); !line.IsNull())
    return Checked({{LinePiece(line->Lin(), first, last)}});
  if (const auto circle = Handle(Geom_Circle)::DownCast(curve); !circle.IsNull()) {
    const Vec3 x = circle->Radius() * ToVec3(circle->XAxis().Direction().XYZ());
    const Vec3 y = circle->Radius() * ToVec3(circle->YAxis().Direction().XYZ());
    return Checked({ArcPieces(ToVec3(circle->Location().XYZ()), x, y, first, last, max_arc)});
  }
  if (const auto ellipse = Handle(Geom_Ellipse)::DownCast(curve); !ellipse.IsNull()) {
    const Vec3 x = ellipse->MajorRadius() * ToVec3(ellipse->XAxis().Direction().XYZ());
    const Vec3 y = ellipse->MinorRadius() * ToVec3(ellipse->YAxis().Direction().XYZ());
    return Checked({ArcPieces(ToVec3(ellipse->Location().XYZ()), x, y, first, last, max_arc)});
  }
  if (const auto parabola = Handle(Geom_Parabola)::DownCast(curve); !parabola.IsNull())
    return Checked({{ParabolaPiece(parabola->Parab(), first, last)}});
  if (const auto hyperbola = Handle(Geom_Hyperbola)::DownCast(curve); !hyperbola.IsNull()) {
    if (parametrization == Parametrization::kEndsOnly)
      return Checked({{HyperbolaPiece(hyperbola->Hypr(), first, last)}});
  }
  if (const auto bezier = Handle(Geom_BezierCurve)::DownCast(curve); !bezier.IsNull())
    return Checked({BezierPieces(*bezier, first, last)});
  if (const auto bspline = Handle(Geom_BSplineCurve)::DownCast(curve); !bspline.IsNull())
    return Checked({BsplineCurvePieces(bspline, first, last)});
  return Checked(Approximated(curve, first, last));
}

Result<CurvePieces> PiecesOf(const Handle(Geom2d_Curve) & curve, double first, double last, double max_arc,
                             Parametrization parametrization) {
  // Treat the plane of parameters as the plane z = 0 in space. Parameters stay the same, also of left-handed
  // conics.
  return PiecesOf(GeomAPI::To3d(curve, gp_Pln()), first, last, max_arc, parametrization);
}

Vec4 Transformed(const gp_Trsf& transformation, Vec4 p) {
  const auto row = [&](int r) {
    return transformation.Value(r, 1) * p.x + transformation.Value(r, 2) * p.y +
           transformation.Value(r, 3) * p.z + transformation.Value(r, 4) * p.w;
  };
  return {row(1), row(2), row(3), p.w};
}

void Transform(const gp_Trsf& transformation, std::vector<CurvePiece>& pieces) {
  if (transformation.Form() == gp_Identity) return;
  for (CurvePiece& piece : pieces) {
    for (Vec4& p : piece.points) p = Transformed(transformation, p);
  }
}

}  // namespace facetless
