#include "import/pcurve.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_Plane.hxx>
#include <ShapeFix_Edge.hxx>
#include <TopLoc_Location.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "import/approximate.h"
#include "import/curve_pieces.h"
#include "import/edge_projection.h"
#include "import/surface_patches.h"

namespace facetless {
namespace {

// Arcs of p-curves and edges are at most an eighth of a turn wide. Within one, parameter and angle differ by
// less than 1 % of its width.
constexpr double kMaxArc = std::numbers::pi / 4;
// The number of intervals at whose ends a gap is measured, per stretch on which p-curve, edge and surface are
// smooth. There are nine, because fitted p-curves are exact at halves and quarters, and least accurate in
// between.
constexpr int kGapIntervals = 9;
// The largest number of intervals per piece.
constexpr int kMaxGapIntervals = 9000;
// Below this share of the edge's size, a computed p-curve cannot be improved: this is the noise of projection
// and interpolation.
constexpr double kGapNoise = 1e-9;
// A new p-curve replaces the old one only if its gap is at most this share of the old gap.
constexpr double kWorthwhile = 0.5;
// The limit of halvings when a p-curve is fitted again.
constexpr int kFitDepth = 4;

// The 3D edge in the surface's own frame.
struct SpatialEdge {
  GeomAdaptor_Curve curve;
  gp_Trsf to_surface;
  bool moved = false;
  double first = 0, last = 1;

  void D2(double s, gp_Pnt& point, gp_Vec& d1, gp_Vec& d2) const {
    curve.D2(s, point, d1, d2);
    if (!moved) return;
    point.Transform(to_surface);
    d1.Transform(to_surface);
    d2.Transform(to_surface);
  }
  gp_Pnt Value(double s) const {
    gp_Pnt point = curve.Value(s);
    if (moved) point.Transform(to_surface);
    return point;
  }
  // Returns the length of a polygon through three points, in mm.
  double Size() const {
    const gp_Pnt middle = Value(0.5 * (first + last));
    return Value(first).Distance(middle) + middle.Distance(Value(last));
  }
  // Returns the ends of the edge and the parameters at which it is not smooth.
  std::vector<double> Breaks() const {
    std::vector<double> breaks{first};
    TColStd_Array1OfReal intervals(1, curve.NbIntervals(GeomAbs_C2) + 1);
    curve.Intervals(intervals, GeomAbs_C2);
    for (double value : intervals)
      if (value > breaks.back() && value < last) breaks.push_back(value);
    breaks.push_back(last);
    return breaks;
  }
};

// Returns the distance of `point` to the edge near parameter `s`. Newton's iteration finds the foot of the
// perpendicular and stays within the edge.
double DistanceToEdge(const SpatialEdge& edge, const gp_Pnt& point, double s) {
  double best = INFINITY;
  for (int step = 0; step < 6; ++step) {
    gp_Pnt there;
    gp_Vec d1, d2;
    edge.D2(s, there, d1, d2);
    const gp_Vec offset(point, there);
    const double distance = offset.Magnitude();
    if (!(distance < best)) break;
    best = distance;
    const double slope = d1.SquareMagnitude() + offset.Dot(d2);
    const double change = offset.Dot(d1) / (slope > 0 ? slope : d1.SquareMagnitude());
    if (!std::isfinite(change)) break;
    s = std::clamp(s - change, edge.first, edge.last);
  }
  return best;
}

// Returns how many of the sorted `knots` lie strictly between a and b.
int KnotsBetween(const TColStd_Array1OfReal& knots, double a, double b) {
  return static_cast<int>(std::count_if(knots.begin(), knots.end(), [&](double knot) {
    return knot > std::min(a, b) && knot < std::max(a, b);
  }));
}

// The parameters at which a curve, or a surface in one direction, is not smooth. An exact p-curve does not
// show such places, but the gap changes its slope there.
template <typename Adaptor>
TColStd_Array1OfReal BreaksOf(const Adaptor& adaptor, int count,
                              void (Adaptor::*intervals)(TColStd_Array1OfReal&, GeomAbs_Shape) const) {
  TColStd_Array1OfReal breaks(1, count + 1);
  (adaptor.*intervals)(breaks, GeomAbs_CN);
  return breaks;
}

double MeasureGap(const std::vector<CurvePiece>& pieces, const GeomAdaptor_Surface& surface,
                  const SpatialEdge& edge) {
  const TColStd_Array1OfReal along =
      BreaksOf(edge.curve, edge.curve.NbIntervals(GeomAbs_CN), &GeomAdaptor_Curve::Intervals);
  const TColStd_Array1OfReal in_u =
      BreaksOf(surface, surface.NbUIntervals(GeomAbs_CN), &GeomAdaptor_Surface::UIntervals);
  const TColStd_Array1OfReal in_v =
      BreaksOf(surface, surface.NbVIntervals(GeomAbs_CN), &GeomAdaptor_Surface::VIntervals);
  double gap = 0;
  for (const CurvePiece& piece : pieces) {
    const Vec3 from = Cartesian(piece.points.front()), to = Cartesian(piece.points.back());
    const int stretches = 1 + KnotsBetween(along, piece.begin, piece.end) + KnotsBetween(in_u, from.x, to.x) +
                          KnotsBetween(in_v, from.y, to.y);
    const int intervals = std::min(kGapIntervals * stretches, kMaxGapIntervals);
    for (int i = 0; i <= intervals; ++i) {
      const double t = static_cast<double>(i) / intervals;
      const Vec3 uv = Cartesian(EvaluateBezier(piece.points, t));
      const double distance = DistanceToEdge(edge, surface.Value(uv.x, uv.y),
                                             NativeParameter(piece.begin, piece.end, piece.map, t));
      // A distance that is NaN must not pass for a small one.
      if (!(distance <= gap)) gap = distance;
    }
  }
  return gap;
}

// Returns the parameters of the surface point nearest to `target`, by damped Gauss-Newton iteration from a
// guess.
Vec2 Project(const GeomAdaptor_Surface& surface, const gp_Pnt& target, Vec2 guess) {
  Vec2 best = guess;
  double best_distance = INFINITY;
  Vec2 at = guess;
  for (int step = 0; step < 12; ++step) {
    gp_Pnt there;
    gp_Vec du, dv;
    surface.D1(at.x, at.y, there, du, dv);
    const gp_Vec offset(there, target);
    const double distance = offset.Magnitude();
    if (!(distance < best_distance)) break;
    best = at;
    best_distance = distance;
    // Solve the normal equations. If one direction has collapsed, the iteration ends.
    const double a = du.Dot(du), b = du.Dot(dv), c = dv.Dot(dv), f = offset.Dot(du), g = offset.Dot(dv);
    const double determinant = a * c - b * b;
    if (!(determinant > 1e-14 * a * c)) break;
    at = {best.x + (f * c - g * b) / determinant, best.y + (a * g - b * f) / determinant};
    if (at.x == best.x && at.y == best.y) break;
  }
  return best;
}

// Projects the 3D edge onto the surface, starting from the existing p-curve, and interpolates.
std::vector<CurvePiece> Refitted(const std::vector<CurvePiece>& old, const GeomAdaptor_Surface& surface,
                                 const SpatialEdge& edge, double tolerance) {
  const auto guess = [&](double s) {
    const auto piece =
        std::find_if(old.begin(), old.end() - 1, [&](const CurvePiece& p) { return s <= p.end; });
    const Vec3 uv =
        Cartesian(EvaluateBezier(piece->points, PieceParameter(piece->begin, piece->end, piece->map, s)));
    return Vec2{uv.x, uv.y};
  };
  // Scale the parameters to millimetres, so that the fit's deviation is in millimetres, too.
  const Vec2 middle = guess(0.5 * (edge.first + edge.last));
  gp_Pnt point;
  gp_Vec du, dv;
  surface.D1(middle.x, middle.y, point, du, dv);
  const double scale_u = du.Magnitude(), scale_v = dv.Magnitude();
  if (!(scale_u > 0) || !(scale_v > 0)) return {};
  double deviation = 0;
  std::vector<CurvePiece> pieces = ApproximateCurve(
      [&](double s) {
        const Vec2 uv = Project(surface, edge.Value(s), guess(s));
        return Vec3{uv.x * scale_u, uv.y * scale_v, 0};
      },
      edge.Breaks(), tolerance, kFitDepth, &deviation);
  for (CurvePiece& piece : pieces) {
    for (Vec4& p : piece.points) p = {p.x / scale_u, p.y / scale_v, 0, 1};
  }
  return pieces;
}

// Projects the edge onto a surface that is no plane. The result is empty if that fails.
std::vector<CurvePiece> Projected(const SpatialEdge& edge, const GeomAdaptor_Surface& surface) {
  if (surface.GetType() == GeomAbs_Plane) return {};
  return ProjectEdge(
      surface, [&](double s) { return edge.Value(s); }, edge.Breaks(), kGapNoise * edge.Size());
}

// On a plane every curve is projected exactly by projecting its control points.
std::vector<CurvePiece> PlanarPieces(const Geom_Plane& plane, std::vector<CurvePiece> pieces) {
  const gp_Ax3& axes = plane.Position();
  const Vec3 origin = ToVec3(axes.Location().XYZ()), x = ToVec3(axes.XDirection().XYZ()),
             y = ToVec3(axes.YDirection().XYZ());
  for (CurvePiece& piece : pieces) {
    for (Vec4& p : piece.points) {
      const Vec3 offset = Vec3{p.x, p.y, p.z} - p.w * origin;
      p = {Dot(offset, x), Dot(offset, y), 0, p.w};
    }
  }
  return pieces;
}

struct StoredCurve {
  Handle(Geom2d_Curve) curve;
  double first = 0, last = 1;
  bool stored = false;
};

StoredCurve CurveOn(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  StoredCurve result;
  Standard_Boolean stored = false;
  result.curve = BRep_Tool::CurveOnSurface(edge, face, result.first, result.last, &stored);
  result.stored = stored;
  return result;
}

}  // namespace

Result<Pcurve> MakePcurve(const TopoDS_Edge& edge, const TopoDS_Face& face, bool pcurves_in_file,
                          MissingPcurve missing) {
  TopLoc_Location surface_location, edge_location;
  const Handle(Geom_Surface) surface = Untrimmed(BRep_Tool::Surface(face, surface_location));
  const Handle(Geom_Plane) plane = Handle(Geom_Plane)::DownCast(surface);
  // Transform the 3D curve into the surface's frame.
  double first = 0, last = 1;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, edge_location, first, last);
  const bool spatial = !curve.IsNull() && !BRep_Tool::Degenerated(edge) && first < last;
  std::optional<SpatialEdge> in_space;
  if (spatial) {
    const gp_Trsf to_surface = surface_location.Transformation().Inverted() * edge_location.Transformation();
    in_space = SpatialEdge{GeomAdaptor_Curve(curve, first, last), to_surface,
                           !(surface_location == edge_location), first, last};
  }

  StoredCurve stored = CurveOn(edge, face);
  Pcurve result;
  const GeomAdaptor_Surface adaptor(surface);
  const bool lacks = stored.curve.IsNull() && spatial;
  if (lacks) result.pieces = Projected(*in_space, adaptor);
  if (!result.pieces.empty()) {
    // The projection already has the edge's own parameter.
  } else if (!stored.stored && !plane.IsNull() && spatial) {
    // For planes, p-curves are rarely stored: project the control points.
    Result<CurvePieces> pieces = PiecesOf(curve, first, last, kMaxArc, Parametrization::kEndsOnly);
    if (!pieces.ok()) return pieces.error();
    if (in_space->moved) Transform(in_space->to_surface, pieces.value().pieces);
    result.pieces = PlanarPieces(*plane, std::move(pieces.value().pieces));
  } else {
    if (lacks && missing == MissingPcurve::kByOpenCascade) {
      ShapeFix_Edge().FixAddPCurve(edge, face, BRep_Tool::IsClosed(edge, face));
      stored = CurveOn(edge, face);
    }
    if (stored.curve.IsNull())
      return Error{ErrorCode::kFormatBroken, "an edge has no curve on the surface and none can be computed"};
    Result<CurvePieces> pieces =
        PiecesOf(stored.curve, stored.first, stored.last, kMaxArc, Parametrization::kEndsOnly);
    if (!pieces.ok()) return pieces.error();
    result.pieces = std::move(pieces.value().pieces);
    result.from_file = stored.stored && pcurves_in_file;
    // Convert the p-curve's parameter to the edge's: both have the same range, or a linear map connects them.
    if (spatial && (stored.first != first || stored.last != last)) {
      const double scale = (last - first) / (stored.last - stored.first);
      for (CurvePiece& piece : result.pieces) {
        piece.begin = first + (piece.begin - stored.first) * scale;
        piece.end = first + (piece.end - stored.first) * scale;
      }
      result.pieces.back().end = last;
    }
  }
  if (!spatial) return result;

  // Measure the gap. A computed curve that is not accurate enough is fitted again.
  result.gap_mm = MeasureGap(result.pieces, adaptor, *in_space);
  const double size = in_space->Size();
  if (!lacks && !result.from_file && plane.IsNull() && !(result.gap_mm <= kGapNoise * size)) {
    std::vector<CurvePiece> refitted = Refitted(result.pieces, adaptor, *in_space, kGapNoise * size);
    const double gap = refitted.empty() ? INFINITY : MeasureGap(refitted, adaptor, *in_space);
    if (gap <= kWorthwhile * result.gap_mm) {
      result.pieces = std::move(refitted);
      result.gap_mm = gap;
    }
  }
  if (!std::isfinite(result.gap_mm))
    return Error{ErrorCode::kFormatBroken, "an edge's curve on the surface is not finite"};
  result.gap_mm *= std::fabs(surface_location.Transformation().ScaleFactor());
  return result;
}

}  // namespace facetless
