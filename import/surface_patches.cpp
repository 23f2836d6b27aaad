#include "import/surface_patches.h"

#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "import/approximate.h"
#include "import/bezier_pieces.h"
#include "import/curve_pieces.h"

namespace facetless {
namespace {

// Where the surface continues, the grid extends beyond the loops by this share of their range. This leaves
// room for Newton's iterates and for hits at the border.
constexpr double kMargin = 1.0 / 64;
// Arcs of surfaces are at most a quarter turn wide, so that the weights stay above 0.7.
constexpr double kMaxArc = std::numbers::pi / 2;
// The accuracy that an approximation aims at, relative to the surface's size.
constexpr double kRelativeTolerance = 1e-10;
// No thread has more turns. The limit prevents a damaged loop from filling the memory.
constexpr double kMaxTurns = 4096;
// The lattice at which a grid is checked has at most this many points per direction.
constexpr int kMaxChecks = 48;

// The range of a surface in one direction.
struct Extent {
  double low = -INFINITY, high = INFINITY;
  double period = 0;
  bool pole = false;  // the ends may be poles, beyond which the surface would fold back
};

struct Reach {
  double low, high;
  bool extendable;
};

// Widens [low, high] by the margin, within the surface's extent.
Reach Widened(double low, double high, const Extent& extent, bool whole) {
  if (whole) return {low, high, extent.period > 0};
  const double margin = kMargin * (high - low);
  double begin = std::max(extent.low, low - margin), end = std::min(extent.high, high + margin);
  // Loops in files may leave the surface slightly. The grid follows them, since the polynomials of the end
  // spans continue.
  if (!extent.pole) {
    begin = std::max(std::min(begin, low), extent.low - margin);
    end = std::min(std::max(end, high), extent.high + margin);
  }
  return {begin, end, begin <= low - 0.5 * margin && end >= high + 0.5 * margin};
}

std::vector<Span> SpansOf(const std::vector<CurvePiece>& pieces) {
  std::vector<Span> spans;
  for (const CurvePiece& piece : pieces) spans.push_back({piece.begin, piece.end, piece.map});
  return spans;
}

int MaxDegree(const std::vector<CurvePiece>& pieces) {
  int degree = 1;
  for (const CurvePiece& piece : pieces) degree = std::max(degree, piece.degree());
  return degree;
}

// Fills the grid's points with combine(piece point along u, piece point along v).
template <typename Combine>
void FillProduct(PatchGrid& grid, std::vector<CurvePiece> along_u, std::vector<CurvePiece> along_v,
                 Combine combine) {
  grid.u_spans = SpansOf(along_u);
  grid.v_spans = SpansOf(along_v);
  grid.degree_u = MaxDegree(along_u);
  grid.degree_v = MaxDegree(along_v);
  ElevateDegree(along_u, grid.degree_u);
  ElevateDegree(along_v, grid.degree_v);
  for (const CurvePiece& u : along_u) {
    for (const CurvePiece& v : along_v) {
      for (const Vec4& p : u.points) {
        for (const Vec4& q : v.points) grid.points.push_back(combine(p, q));
      }
    }
  }
}

// The parameter of a line as a piece, with points (t, 0, 0, 1).
std::vector<CurvePiece> ParameterPiece(const Reach& reach) {
  return {{reach.low, reach.high, SpanMap::kLinear, {{reach.low, 0, 0, 1}, {reach.high, 0, 0, 1}}}};
}

// Angles as arcs of the unit circle, with points (cos, sin, 0, 1) in homogeneous form.
std::vector<CurvePiece> AnglePieces(const Reach& reach) {
  return ArcPieces({}, {1, 0, 0}, {0, 1, 0}, reach.low, reach.high, kMaxArc);
}

struct Frame {
  Vec3 origin, x, y, z;
};
Frame FrameOf(const gp_Ax3& axes) {
  return {ToVec3(axes.Location().XYZ()), ToVec3(axes.XDirection().XYZ()), ToVec3(axes.YDirection().XYZ()),
          ToVec3(axes.Direction().XYZ())};
}

Vec4 Homogeneous(Vec3 weighted, double weight) {
  return {weighted.x, weighted.y, weighted.z, weight};
}

// Rotates a profile (r, h, ·, w) in the half-plane of X and Z about the axis: r points outwards, h along the
// axis.
void FillTurned(PatchGrid& grid, const Frame& frame, std::vector<CurvePiece> angles,
                std::vector<CurvePiece> profile) {
  FillProduct(grid, std::move(angles), std::move(profile), [&](const Vec4& arc, const Vec4& p) {
    return Homogeneous((arc.w * p.w) * frame.origin + (p.x * arc.x) * frame.x + (p.x * arc.y) * frame.y +
                           (arc.w * p.y) * frame.z,
                       arc.w * p.w);
  });
}

PatchGrid PlanePatches(const gp_Pln& plane, const ParameterBox& box, bool whole) {
  PatchGrid grid;
  grid.kind = SurfaceKind::kPlane;
  const Frame frame = FrameOf(plane.Position());
  const Reach u = Widened(box.u0, box.u1, {}, whole), v = Widened(box.v0, box.v1, {}, whole);
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  FillProduct(grid, ParameterPiece(u), ParameterPiece(v), [&](const Vec4& p, const Vec4& q) {
    return Homogeneous(frame.origin + p.x * frame.x + q.x * frame.y, 1);
  });
  return grid;
}

// Cylinder and cone: the profile is a line. A cone ends at its apex.
PatchGrid ConePatches(SurfaceKind kind, const gp_Ax3& axes, double radius, double half_angle,
                      const ParameterBox& box, bool whole) {
  PatchGrid grid;
  grid.kind = kind;
  grid.period_u = 2 * std::numbers::pi;
  const double outwards = std::sin(half_angle), along = std::cos(half_angle);
  Extent extent;
  extent.pole = true;
  if (kind == SurfaceKind::kCone) {
    const double apex = -radius / outwards;
    (apex < 0.5 * (box.v0 + box.v1) ? extent.low : extent.high) = apex;
  }
  const Reach u = Widened(box.u0, box.u1, {-INFINITY, INFINITY, grid.period_u}, whole);
  const Reach v = Widened(box.v0, box.v1, extent, whole);
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  const auto profile_point = [&](double t) {
    const bool apex = t == extent.low || t == extent.high;
    return kind == SurfaceKind::kCone ? Vec4{apex ? 0 : radius + t * outwards, t * along, 0, 1}
                                      : Vec4{radius, t, 0, 1};
  };
  FillTurned(grid, FrameOf(axes), AnglePieces(u),
             {{v.low, v.high, SpanMap::kLinear, {profile_point(v.low), profile_point(v.high)}}});
  return grid;
}

// Returns whether the circle that is a torus's profile meets the axis at the angle v.
bool IsTorusPole(double v, double major, double minor) {
  constexpr double kRounding = 1e-12;
  return minor > major && std::fabs(major + minor * std::cos(v)) <= kRounding * minor;
}

// Sphere (major = 0) and torus: the profile is an arc.
PatchGrid TorusPatches(SurfaceKind kind, const gp_Ax3& axes, double major, double minor,
                       const ParameterBox& box, bool whole) {
  PatchGrid grid;
  grid.kind = kind;
  grid.period_u = 2 * std::numbers::pi;
  Extent extent;
  if (kind == SurfaceKind::kSphere) {
    extent = {-0.5 * std::numbers::pi, 0.5 * std::numbers::pi, 0, true};
  } else {
    extent.period = grid.period_v = 2 * std::numbers::pi;
    // A torus that meets its axis consists of a lemon inside an apple. A face on one of them ends at the
    // poles where the two meet.
    const bool low = IsTorusPole(box.v0, major, minor), high = IsTorusPole(box.v1, major, minor);
    if (low || high) {
      extent = {low ? box.v0 : -INFINITY, high ? box.v1 : INFINITY, 0, true};
      grid.period_v = 0;
    }
  }
  const Reach u = Widened(box.u0, box.u1, {-INFINITY, INFINITY, grid.period_u}, whole);
  const Reach v = Widened(box.v0, box.v1, extent, whole);
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  std::vector<CurvePiece> profile =
      ArcPieces({major, 0, 0}, {minor, 0, 0}, {0, minor, 0}, v.low, v.high, kMaxArc);
  // At a pole the radius is zero, but the cosine of a rounded right angle is not.
  if (extent.pole) {
    if (v.low == extent.low) profile.front().points.front().x = 0;
    if (v.high == extent.high) profile.back().points.back().x = 0;
  }
  FillTurned(grid, FrameOf(axes), AnglePieces(u), std::move(profile));
  return grid;
}

// Returns the parameter range to which a basis curve continues.
Extent ExtentOf(const Handle(Geom_Curve) & curve) {
  if (curve->IsPeriodic()) return {-INFINITY, INFINITY, curve->Period()};
  Extent extent;
  if (!Precision::IsInfinite(curve->FirstParameter())) extent.low = curve->FirstParameter();
  if (!Precision::IsInfinite(curve->LastParameter())) extent.high = curve->LastParameter();
  return extent;
}

Result<PatchGrid> ExtrusionPatches(const Geom_SurfaceOfLinearExtrusion& surface, const ParameterBox& box,
                                   bool whole) {
  PatchGrid grid;
  grid.kind = SurfaceKind::kExtrusion;
  const Handle(Geom_Curve) basis = Untrimmed(surface.BasisCurve());
  const Extent extent = ExtentOf(basis);
  grid.period_u = extent.period;
  const Reach u = Widened(box.u0, box.u1, extent, whole), v = Widened(box.v0, box.v1, {}, whole);
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  Result<CurvePieces> profile = PiecesOf(basis, u.low, u.high, kMaxArc, Parametrization::kNative);
  if (!profile.ok()) return profile.error();
  grid.approximated = profile.value().approximated;
  const Vec3 direction = ToVec3(surface.Direction().XYZ());
  FillProduct(grid, std::move(profile.value().pieces), ParameterPiece(v), [&](const Vec4& p, const Vec4& t) {
    return Homogeneous(Vec3{p.x, p.y, p.z} + (p.w * t.x) * direction, p.w);
  });
  return grid;
}

Result<PatchGrid> RevolutionPatches(const Geom_SurfaceOfRevolution& surface, const ParameterBox& box,
                                    bool whole) {
  PatchGrid grid;
  grid.kind = SurfaceKind::kRevolution;
  const Handle(Geom_Curve) basis = Untrimmed(surface.BasisCurve());
  Extent extent = ExtentOf(basis);
  extent.pole = true;
  grid.period_u = 2 * std::numbers::pi;
  grid.period_v = extent.period;
  const Vec3 origin = ToVec3(surface.Location().XYZ()), axis = ToVec3(surface.Direction().XYZ());
  const auto radial = [&](double t) {
    const Vec3 q = ToVec3(basis->Value(t).XYZ()) - origin;
    return q - Dot(q, axis) * axis;
  };
  const Reach u = Widened(box.u0, box.u1, {-INFINITY, INFINITY, grid.period_u}, whole);
  Reach v = Widened(box.v0, box.v1, extent, whole);
  // The margin must not cross the axis, because the surface folds over itself beyond it.
  const Vec3 inside = radial(0.5 * (box.v0 + box.v1));
  if (!(Dot(radial(v.low), inside) > 0)) v = {box.v0, v.high, false};
  if (!(Dot(radial(v.high), inside) > 0)) v = {v.low, box.v1, false};
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  Result<CurvePieces> profile = PiecesOf(basis, v.low, v.high, kMaxArc, Parametrization::kNative);
  if (!profile.ok()) return profile.error();
  grid.approximated = profile.value().approximated;
  FillProduct(grid, AnglePieces(u), std::move(profile.value().pieces), [&](const Vec4& arc, const Vec4& p) {
    // Split the profile's point into its part along the axis, which is constant, and its radial part, which
    // rotates.
    const Vec3 q = Vec3{p.x, p.y, p.z} - p.w * origin;
    const Vec3 along = Dot(q, axis) * axis, out = q - along;
    return Homogeneous((arc.w * p.w) * origin + arc.w * along + arc.x * out + arc.y * Cross(axis, out),
                       arc.w * p.w);
  });
  return grid;
}

// The poles and flat knots of a non-periodic B-spline surface. The index of u varies slowest.
struct PoleNet {
  int degree_u, degree_v, count_u, count_v;
  std::vector<double> u_knots, v_knots;
  std::vector<Vec4> poles;
  bool rational;
};

template <typename Surface>
void ReadPoles(const Surface& surface, PoleNet& net) {
  net.degree_u = surface.UDegree();
  net.degree_v = surface.VDegree();
  net.count_u = surface.NbUPoles();
  net.count_v = surface.NbVPoles();
  net.rational = surface.IsURational() || surface.IsVRational();
  for (int i = 1; i <= net.count_u; ++i) {
    for (int j = 1; j <= net.count_v; ++j) {
      const double weight = net.rational ? surface.Weight(i, j) : 1;
      net.poles.push_back(Homogeneous(weight * ToVec3(surface.Pole(i, j).XYZ()), weight));
    }
  }
}

// Inserts knots along one direction of the net. For each stretch and each row across it, the result has
// degree + 1 points: out[stretch][k][row].
std::vector<std::vector<std::vector<Vec4>>> ExtractAlong(const std::vector<double>& knots, int degree,
                                                         const std::vector<KnotStretch>& stretches,
                                                         const std::vector<std::vector<Vec4>>& rows) {
  std::vector<std::vector<std::vector<Vec4>>> out(
      stretches.size(), std::vector<std::vector<Vec4>>(degree + 1, std::vector<Vec4>(rows.size())));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t s = 0; s < stretches.size(); ++s) {
      std::vector<Vec4> points =
          BsplineSpanPoints(knots, degree, rows[r], stretches[s].span, stretches[s].begin, stretches[s].end);
      for (int k = 0; k <= degree; ++k) out[s][k][r] = points[k];
      // Neighbouring patches share their border bit by bit, unless they are the two ends of a turn.
      if (s > 0) out[s][0][r] = out[s - 1][degree][r];
    }
  }
  return out;
}

// A stretch of knots, with the shift by whole periods that moves it to the loops.
struct TurnStretch {
  KnotStretch stretch;
  double shift;
};

std::vector<TurnStretch> TurnStretches(const std::vector<double>& knots, int degree, double first,
                                       double last, double period) {
  std::vector<TurnStretch> out;
  if (period == 0) {
    for (const KnotStretch& stretch : KnotStretches(knots, degree, first, last)) out.push_back({stretch, 0});
    return out;
  }
  const double origin = knots[degree];
  const double rounding = 1e-14 * std::max({std::fabs(first), std::fabs(last), period});
  for (int turn = static_cast<int>(std::floor((first - origin) / period)); origin + turn * period < last;
       ++turn) {
    const double shift = turn * period;
    const double begin = std::max(first - shift, origin), end = std::min(last - shift, origin + period);
    if (!(end - begin > rounding)) continue;
    for (const KnotStretch& stretch : KnotStretches(knots, degree, begin, end))
      out.push_back({stretch, shift});
  }
  return out;
}

std::vector<Span> SpansOf(const std::vector<TurnStretch>& stretches) {
  std::vector<Span> spans;
  for (const TurnStretch& s : stretches) {
    const double begin = spans.empty() ? s.stretch.begin + s.shift : spans.back().end;
    spans.push_back({begin, s.stretch.end + s.shift, SpanMap::kLinear});
  }
  return spans;
}

std::vector<KnotStretch> WithoutShift(const std::vector<TurnStretch>& stretches) {
  std::vector<KnotStretch> out;
  for (const TurnStretch& s : stretches) out.push_back(s.stretch);
  return out;
}

void FillBspline(PatchGrid& grid, const PoleNet& net, const Reach& u, const Reach& v) {
  grid.degree_u = net.degree_u;
  grid.degree_v = net.degree_v;
  const auto u_stretches = TurnStretches(net.u_knots, net.degree_u, u.low, u.high, grid.period_u);
  const auto v_stretches = TurnStretches(net.v_knots, net.degree_v, v.low, v.high, grid.period_v);
  grid.u_spans = SpansOf(u_stretches);
  grid.v_spans = SpansOf(v_stretches);
  // Insert knots along v for every row of poles that the u-stretches use, then along u.
  std::vector<std::vector<Vec4>> rows(net.count_u);
  for (int i = 0; i < net.count_u; ++i) {
    rows[i].assign(net.poles.begin() + std::ptrdiff_t{i} * net.count_v,
                   net.poles.begin() + std::ptrdiff_t{i + 1} * net.count_v);
  }
  const auto along_v = ExtractAlong(net.v_knots, net.degree_v, WithoutShift(v_stretches), rows);
  grid.points.resize(u_stretches.size() * v_stretches.size() * (net.degree_u + 1) * (net.degree_v + 1));
  for (std::size_t j = 0; j < v_stretches.size(); ++j) {
    const auto along_u = ExtractAlong(net.u_knots, net.degree_u, WithoutShift(u_stretches), along_v[j]);
    for (std::size_t i = 0; i < u_stretches.size(); ++i) {
      Vec4* patch = &grid.points[(i * v_stretches.size() + j) * (net.degree_u + 1) * (net.degree_v + 1)];
      for (int k = 0; k <= net.degree_u; ++k) {
        for (int l = 0; l <= net.degree_v; ++l) patch[k * (net.degree_v + 1) + l] = along_u[i][k][l];
      }
    }
  }
}

PatchGrid BsplinePatches(Handle(Geom_BSplineSurface) surface, const ParameterBox& box, bool whole) {
  PatchGrid grid;
  grid.kind = SurfaceKind::kBspline;
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  Extent u_extent{u0, u1, 0}, v_extent{v0, v1, 0};
  // Clamp periodic directions at their origin. This inserts knots and moves no point.
  if (surface->IsUPeriodic() || surface->IsVPeriodic()) {
    surface = Handle(Geom_BSplineSurface)::DownCast(surface->Copy());
    if (surface->IsUPeriodic()) u_extent = {-INFINITY, INFINITY, grid.period_u = u1 - u0};
    if (surface->IsVPeriodic()) v_extent = {-INFINITY, INFINITY, grid.period_v = v1 - v0};
    if (surface->IsUPeriodic()) surface->SetUNotPeriodic();
    if (surface->IsVPeriodic()) surface->SetVNotPeriodic();
  }
  PoleNet net;
  ReadPoles(*surface, net);
  const TColStd_Array1OfReal &u_sequence = surface->UKnotSequence(), &v_sequence = surface->VKnotSequence();
  net.u_knots.assign(u_sequence.begin(), u_sequence.end());
  net.v_knots.assign(v_sequence.begin(), v_sequence.end());
  const Reach u = Widened(box.u0, box.u1, u_extent, whole), v = Widened(box.v0, box.v1, v_extent, whole);
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  FillBspline(grid, net, u, v);
  return grid;
}

PatchGrid BezierPatches(const Geom_BezierSurface& surface, const ParameterBox& box, bool whole) {
  PatchGrid grid;
  grid.kind = SurfaceKind::kBezier;
  PoleNet net;
  ReadPoles(surface, net);
  net.u_knots.assign(2 * (net.degree_u + 1), 0.0);
  std::fill(net.u_knots.begin() + net.degree_u + 1, net.u_knots.end(), 1.0);
  net.v_knots.assign(2 * (net.degree_v + 1), 0.0);
  std::fill(net.v_knots.begin() + net.degree_v + 1, net.v_knots.end(), 1.0);
  const Reach u = Widened(box.u0, box.u1, {0, 1, 0}, whole), v = Widened(box.v0, box.v1, {0, 1, 0}, whole);
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  FillBspline(grid, net, u, v);
  return grid;
}

std::vector<double> Breaks(const TColStd_Array1OfReal& intervals, double low, double high) {
  std::vector<double> breaks{low};
  for (double value : intervals) {
    if (value > breaks.back() && value < high) breaks.push_back(value);
  }
  breaks.push_back(high);
  return breaks;
}

// All other surfaces, above all offset surfaces: polynomial patches between the lines at which the surface is
// not smooth.
PatchGrid ApproximatedPatches(const Handle(Geom_Surface) & surface, const ParameterBox& box, bool whole) {
  PatchGrid grid;
  grid.kind = surface->IsKind(STANDARD_TYPE(Geom_OffsetSurface)) ? SurfaceKind::kOffset : SurfaceKind::kOther;
  grid.approximated = true;
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  Extent u_extent{Precision::IsInfinite(u0) ? -INFINITY : u0, Precision::IsInfinite(u1) ? INFINITY : u1, 0};
  Extent v_extent{Precision::IsInfinite(v0) ? -INFINITY : v0, Precision::IsInfinite(v1) ? INFINITY : v1, 0};
  if (surface->IsUPeriodic()) u_extent = {-INFINITY, INFINITY, grid.period_u = surface->UPeriod()};
  if (surface->IsVPeriodic()) v_extent = {-INFINITY, INFINITY, grid.period_v = surface->VPeriod()};
  const Reach u = Widened(box.u0, box.u1, u_extent, whole), v = Widened(box.v0, box.v1, v_extent, whole);
  grid.extendable_u = u.extendable;
  grid.extendable_v = v.extendable;
  const GeomAdaptor_Surface adaptor(surface, u.low, u.high, v.low, v.high);
  TColStd_Array1OfReal u_intervals(1, adaptor.NbUIntervals(GeomAbs_CN) + 1),
      v_intervals(1, adaptor.NbVIntervals(GeomAbs_CN) + 1);
  adaptor.UIntervals(u_intervals, GeomAbs_CN);
  adaptor.VIntervals(v_intervals, GeomAbs_CN);
  const auto point = [&](double s, double t) { return ToVec3(surface->Value(s, t).XYZ()); };
  const double size = Length(point(u.low, v.low) - point(u.high, v.high)) +
                      Length(point(u.low, v.high) - point(u.high, v.low));
  ApproximateGrid approximate =
      ApproximateSurface(point, Breaks(u_intervals, u.low, u.high), Breaks(v_intervals, v.low, v.high),
                         kRelativeTolerance * size);
  grid.degree_u = grid.degree_v = kApproximationDegree;
  for (std::size_t i = 0; i + 1 < approximate.u_breaks.size(); ++i)
    grid.u_spans.push_back({approximate.u_breaks[i], approximate.u_breaks[i + 1], SpanMap::kLinear});
  for (std::size_t i = 0; i + 1 < approximate.v_breaks.size(); ++i)
    grid.v_spans.push_back({approximate.v_breaks[i], approximate.v_breaks[i + 1], SpanMap::kLinear});
  grid.points = std::move(approximate.points);
  grid.deviation = approximate.deviation;
  return grid;
}

Result<PatchGrid> Unplaced(const Handle(Geom_Surface) & surface, const ParameterBox& box, bool whole) {
  if (const auto plane = Handle(Geom_Plane)::DownCast(surface); !plane.IsNull())
    return PlanePatches(plane->Pln(), box, whole);
  if (const auto s = Handle(Geom_CylindricalSurface)::DownCast(surface); !s.IsNull())
    return ConePatches(SurfaceKind::kCylinder, s->Position(), s->Radius(), 0, box, whole);
  if (const auto s = Handle(Geom_ConicalSurface)::DownCast(surface); !s.IsNull())
    return ConePatches(SurfaceKind::kCone, s->Position(), s->RefRadius(), s->SemiAngle(), box, whole);
  if (const auto s = Handle(Geom_SphericalSurface)::DownCast(surface); !s.IsNull())
    return TorusPatches(SurfaceKind::kSphere, s->Position(), 0, s->Radius(), box, whole);
  if (const auto s = Handle(Geom_ToroidalSurface)::DownCast(surface); !s.IsNull())
    return TorusPatches(SurfaceKind::kTorus, s->Position(), s->MajorRadius(), s->MinorRadius(), box, whole);
  if (const auto s = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(surface); !s.IsNull())
    return ExtrusionPatches(*s, box, whole);
  if (const auto s = Handle(Geom_SurfaceOfRevolution)::DownCast(surface); !s.IsNull())
    return RevolutionPatches(*s, box, whole);
  if (const auto s = Handle(Geom_BSplineSurface)::DownCast(surface); !s.IsNull())
    return BsplinePatches(s, box, whole);
  if (const auto s = Handle(Geom_BezierSurface)::DownCast(surface); !s.IsNull())
    return BezierPatches(*s, box, whole);
  return ApproximatedPatches(surface, box, whole);
}

// Returns the span of `native`; for parameters beyond the range, the first or last span.
std::size_t FindSpan(const std::vector<Span>& spans, double native) {
  std::size_t i = 0;
  while (i + 1 < spans.size() && native > spans[i].end) ++i;
  return i;
}

// Returns lattice parameters: several in each span, thinned out to kMaxChecks.
std::vector<double> CheckParameters(const std::vector<Span>& spans) {
  std::vector<double> all;
  for (const Span& span : spans) {
    for (double t : {0.1, 0.37, 0.5, 0.81, 1.0}) all.push_back(span.begin + t * (span.end - span.begin));
  }
  if (static_cast<int>(all.size()) <= kMaxChecks) return all;
  std::vector<double> thinned;
  for (int i = 0; i < kMaxChecks; ++i) thinned.push_back(all[all.size() * i / kMaxChecks]);
  return thinned;
}

void Measure(const Handle(Geom_Surface) & surface, PatchGrid& grid) {
  for (const Vec4& p : grid.points)
    grid.size =
        std::fmax(grid.size, std::fmax(std::fabs(p.x), std::fmax(std::fabs(p.y), std::fabs(p.z))) / p.w);
  const std::vector<double> us = CheckParameters(grid.u_spans), vs = CheckParameters(grid.v_spans);
  const GeomAdaptor_Surface adaptor(surface);
  for (double u : us) {
    for (double v : vs) {
      const double distance = Length(Cartesian(Evaluate(grid, u, v)) - ToVec3(adaptor.Value(u, v).XYZ()));
      grid.deviation = std::fmax(grid.deviation, distance);
    }
  }
}

}  // namespace

Handle(Geom_Surface) Untrimmed(Handle(Geom_Surface) surface) {
  while (true) {
    const Handle(Geom_RectangularTrimmedSurface) trimmed =
        Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
    if (trimmed.IsNull()) return surface;
    surface = trimmed->BasisSurface();
  }
}

Vec4 Evaluate(const PatchGrid& grid, double u, double v) {
  const std::size_t i = FindSpan(grid.u_spans, u), j = FindSpan(grid.v_spans, v);
  const Span &u_span = grid.u_spans[i], &v_span = grid.v_spans[j];
  const std::size_t row = grid.degree_v + 1;
  const Vec4* patch = &grid.points[(i * grid.v_spans.size() + j) * (grid.degree_u + 1) * row];
  std::vector<Vec4> column(grid.degree_u + 1);
  const double t = PieceParameter(v_span.begin, v_span.end, v_span.map, v);
  for (int k = 0; k <= grid.degree_u; ++k) column[k] = EvaluateBezier({patch + k * row, row}, t);
  return EvaluateBezier(column, PieceParameter(u_span.begin, u_span.end, u_span.map, u));
}

Result<PatchGrid> PatchesOf(const Handle(Geom_Surface) & trimmed, const ParameterBox& box, bool whole,
                            const gp_Trsf& placement) {
  for (double value : {box.u0, box.u1, box.v0, box.v1}) {
    if (!std::isfinite(value) || Precision::IsInfinite(value))
      return Error{ErrorCode::kFormatBroken, "the surface is unbounded and no loop bounds it"};
  }
  if (!(box.u0 < box.u1) || !(box.v0 < box.v1))
    return Error{ErrorCode::kFormatBroken, "its loops enclose no area"};
  const Handle(Geom_Surface) surface = Untrimmed(trimmed);
  if ((surface->IsUPeriodic() && box.u1 - box.u0 > kMaxTurns * surface->UPeriod()) ||
      (surface->IsVPeriodic() && box.v1 - box.v0 > kMaxTurns * surface->VPeriod()))
    return Error{ErrorCode::kLimitExceeded, "its loops go around more than 4096 times"};
  Result<PatchGrid> result = Unplaced(surface, box, whole);
  if (!result.ok()) return result;
  PatchGrid& grid = result.value();
  if (grid.points.empty()) return Error{ErrorCode::kFormatBroken, "its loops lie outside its surface"};
  // Check the numbers, then the shape.
  for (const Vec4& p : grid.points) {
    if (!std::isfinite(p.x + p.y + p.z + p.w))
      return Error{ErrorCode::kFormatBroken, "its surface has a number that is not finite"};
    if (!(p.w > 0))
      return Error{
          ErrorCode::kFormatBroken,
          "the weights of its surface differ so much that a patch's are lost in rounding; keep them within "
          "1e12 of each other"};
    grid.rational = grid.rational || p.w != 1;
  }
  Measure(surface, grid);
  if (placement.Form() != gp_Identity) {
    for (Vec4& p : grid.points) p = Transformed(placement, p);
  }
  return result;
}

}  // namespace facetless
