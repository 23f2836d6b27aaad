#include "import/edge_projection.h"

#include <ElSLib.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "import/approximate.h"

namespace facetless {
namespace {

// The number of continuation steps per stretch. If a curve turns by no more than a full circle per stretch,
// its projection is nearly straight within a step.
constexpr int kSteps = 24;
// A stretch of the fit is halved at most this often.
constexpr int kFitDepth = 4;
// A point that is closer to the axis than this share of the surface's radius has no direction around the
// axis.
constexpr double kAtPole = 1e-9;
constexpr int kNewtonSteps = 40;
constexpr double kMostStep = 0.1;
// The largest ratio of weights at which a surface's points are still accurate to a millionth of its size.
constexpr double kMostWeights = 1e8;
// An edge is close to a border if its parameter differs by less than this share of the surface's range.
constexpr double kBeside = 1e-3;
// The iteration ends after a step that is shorter than this share of the coordinates.
constexpr double kLastStep = 1e-9;
// A parameter direction has collapsed into a pole if its squared derivative is below this share of its value
// in the middle of the surface.
constexpr double kCollapsed = 1e-14;
// The number of surface points per direction from which the search for the first point starts.
constexpr int kSeeds = 12;
// The number of these points from which Newton's iteration is tried.
constexpr int kTries = 4;

bool HasClosedForm(const GeomAdaptor_Surface& surface) {
  switch (surface.GetType()) {
    case GeomAbs_Cylinder:
    case GeomAbs_Cone:
    case GeomAbs_Sphere:
      return true;
    case GeomAbs_Torus:
      // On a torus that meets its axis, the closed form is ambiguous: a half-plane through the axis
      // contains arcs of two circles instead of one circle.
      return surface.Torus().MajorRadius() > surface.Torus().MinorRadius();
    default:
      return false;
  }
}

// Returns the axis of a surface of revolution with a closed form. RadiusOf returns the length to which
// kAtPole is relative.
gp_Ax1 AxisOf(const GeomAdaptor_Surface& surface) {
  switch (surface.GetType()) {
    case GeomAbs_Cylinder:
      return surface.Cylinder().Axis();
    case GeomAbs_Cone:
      return surface.Cone().Axis();
    case GeomAbs_Sphere:
      return {surface.Sphere().Location(), surface.Sphere().Position().Direction()};
    default:
      return surface.Torus().Axis();
  }
}

double RadiusOf(const GeomAdaptor_Surface& surface) {
  switch (surface.GetType()) {
    case GeomAbs_Cylinder:
      return surface.Cylinder().Radius();
    case GeomAbs_Cone:
      return std::fmax(surface.Cone().RefRadius(), 1e-300);
    case GeomAbs_Sphere:
      return surface.Sphere().Radius();
    default:
      return surface.Torus().MajorRadius();
  }
}

// Returns whether the weights of a surface differ so much that rounding moves its points by more than the
// allowed distance of an edge.
bool HasExtremeWeights(const GeomAdaptor_Surface& surface) {
  double least = INFINITY, most = 0;
  const auto look_at = [&](const auto& rational) {
    for (int i = 1; i <= rational->NbUPoles(); ++i)
      for (int j = 1; j <= rational->NbVPoles(); ++j) {
        least = std::fmin(least, rational->Weight(i, j));
        most = std::fmax(most, rational->Weight(i, j));
      }
  };
  if (surface.GetType() == GeomAbs_BSplineSurface) look_at(surface.BSpline());
  if (surface.GetType() == GeomAbs_BezierSurface) look_at(surface.Bezier());
  return most > kMostWeights * least;
}

double Nearest(double value, double period, double to) {
  return value + std::round((to - value) / period) * period;
}

class Projector {
 public:
  explicit Projector(const GeomAdaptor_Surface& surface)
      : surface_(surface),
        closed_(HasClosedForm(surface)),
        periodic_u_(surface.IsUPeriodic()),
        periodic_v_(surface.IsVPeriodic()),
        u0_(surface.FirstUParameter()),
        u1_(surface.LastUParameter()),
        v0_(surface.FirstVParameter()),
        v1_(surface.LastVParameter()) {
    if (!closed_) {
      gp_Pnt middle;
      gp_Vec du, dv;
      if (u1_ - u0_ < 1e50 && v1_ - v0_ < 1e50)
        surface.D1(0.5 * (u0_ + u1_), 0.5 * (v0_ + v1_), middle, du, dv);
      size_u_ = du.SquareMagnitude();
      size_v_ = dv.SquareMagnitude();
      return;
    }
    axis_ = AxisOf(surface);
    radius_ = RadiusOf(surface);
  }

  // Returns the parameters of the foot of `point`. Returns nothing if they are not unique, or if Newton's
  // iteration fails.
  std::optional<Vec2> Find(const gp_Pnt& point, const std::optional<Vec2>& guess) const {
    if (closed_) return ClosedForm(point, guess);
    if (guess) return Newton(point, *guess);
    return Search(point);
  }

  const GeomAdaptor_Surface& surface() const { return surface_; }
  bool closed_form() const { return closed_; }

 private:
  std::optional<Vec2> ClosedForm(const gp_Pnt& point, const std::optional<Vec2>& guess) const {
    const gp_Vec from(axis_.Location(), point);
    const gp_Dir& axis = axis_.Direction();
    const gp_Vec across = from - from.Dot(gp_Vec(axis)) * gp_Vec(axis);
    const bool pole = across.Magnitude() <= kAtPole * radius_;
    if (pole && !guess) return std::nullopt;
    double u = 0, v = 0;
    constexpr double kTurn = 2 * std::numbers::pi;
    switch (surface_.GetType()) {
      case GeomAbs_Cylinder:
        ElSLib::Parameters(surface_.Cylinder(), point, u, v);
        break;
      case GeomAbs_Cone:
        ElSLib::Parameters(surface_.Cone(), point, u, v);
        break;
      case GeomAbs_Sphere:
        ElSLib::Parameters(surface_.Sphere(), point, u, v);
        break;
      default:
        ElSLib::Parameters(surface_.Torus(), point, u, v);
        if (guess) v = Nearest(v, kTurn, guess->y);
    }
    if (pole) return Vec2{guess->x, v};
    if (guess) u = Nearest(u, kTurn, guess->x);
    return Vec2{u, v};
  }

  // Finds the foot of the perpendicular by Newton's method on the squared distance, starting at a guess. In
  // directions that are not periodic, the iteration stays within the surface's borders, because the surface's
  // formula is meaningless beyond them.
  std::optional<Vec2> Newton(const gp_Pnt& target, Vec2 guess) const {
    Vec2 at = Clamped(guess);
    double best = INFINITY;
    Vec2 from = at, change{};
    for (int step = 0; step < kNewtonSteps; ++step) {
      gp_Pnt there;
      gp_Vec du, dv, duu, dvv, duv;
      surface_.D2(at.x, at.y, there, du, dv, duu, dvv, duv);
      const gp_Vec offset(there, target);
      const double distance = offset.Magnitude();
      if (!std::isfinite(distance)) return std::nullopt;
      if (distance > best * (1 + 1e-12)) {
        // The distance has grown: halve the step.
        change = 0.5 * change;
        at = Clamped(from + change);
        if (at.x == from.x && at.y == from.y) return from;
        continue;
      }
      best = distance;
      from = at;
      const std::optional<Vec2> next = NewtonStep(offset, at, du, dv, duu, dvv, duv);
      if (!next) return std::nullopt;
      // The length of a step is limited to a share of the surface, because a nearly singular Hessian gives
      // arbitrary steps.
      change = {std::clamp(next->x, -kMostStep * (u1_ - u0_), kMostStep * (u1_ - u0_)),
                std::clamp(next->y, -kMostStep * (v1_ - v0_), kMostStep * (v1_ - v0_))};
      at = Clamped(from + change);
      const double moved =
          std::fabs(at.x - from.x) * du.Magnitude() + std::fabs(at.y - from.y) * dv.Magnitude();
      // The remaining error after this step is about its square.
      if (!(moved > kLastStep * (1 + gp_Vec(target.XYZ()).Magnitude()))) return at;
    }
    return from;
  }

  // Returns the Newton step towards the zero of the distance's gradient, or the Gauss-Newton step if the
  // Hessian is not positive definite. A direction that points out of a border, or that has collapsed into a
  // pole, is held fixed.
  std::optional<Vec2> NewtonStep(const gp_Vec& offset, Vec2 at, const gp_Vec& du, const gp_Vec& dv,
                                 const gp_Vec& duu, const gp_Vec& dvv, const gp_Vec& duv) const {
    const double f = offset.Dot(du), g = offset.Dot(dv);
    const bool hold_u = du.SquareMagnitude() <= kCollapsed * size_u_ ||
                        (!periodic_u_ && ((at.x <= u0_ && f < 0) || (at.x >= u1_ && f > 0)));
    const bool hold_v = dv.SquareMagnitude() <= kCollapsed * size_v_ ||
                        (!periodic_v_ && ((at.y <= v0_ && g < 0) || (at.y >= v1_ && g > 0)));
    for (const bool full : {true, false}) {
      const double a = du.Dot(du) - (full ? offset.Dot(duu) : 0),
                   b = du.Dot(dv) - (full ? offset.Dot(duv) : 0),
                   c = dv.Dot(dv) - (full ? offset.Dot(dvv) : 0);
      if (hold_u && hold_v) return Vec2{};
      if (hold_u) {
        if (c > 0) return Vec2{0, g / c};
      } else if (hold_v) {
        if (a > 0) return Vec2{f / a, 0};
      } else {
        const double determinant = a * c - b * b;
        if (a > 0 && c > 0 && determinant > (full ? 1e-12 : 1e-14) * a * c)
          return Vec2{(f * c - g * b) / determinant, (a * g - b * f) / determinant};
      }
    }
    return std::nullopt;
  }

  Vec2 Clamped(Vec2 at) const {
    return {periodic_u_ ? at.x : std::clamp(at.x, u0_, u1_), periodic_v_ ? at.y : std::clamp(at.y, v0_, v1_)};
  }

  // Searches for the nearest foot from a grid of points of the surface.
  std::optional<Vec2> Search(const gp_Pnt& target) const {
    if (!(u1_ - u0_ < 1e50 && v1_ - v0_ < 1e50)) return std::nullopt;
    struct Seed {
      double distance;
      Vec2 at;
    };
    std::vector<Seed> seeds;
    for (int i = 0; i <= kSeeds; ++i)
      for (int j = 0; j <= kSeeds; ++j) {
        const Vec2 at = {u0_ + (u1_ - u0_) * i / kSeeds, v0_ + (v1_ - v0_) * j / kSeeds};
        seeds.push_back({surface_.Value(at.x, at.y).Distance(target), at});
      }
    std::partial_sort(seeds.begin(), seeds.begin() + kTries, seeds.end(),
                      [](const Seed& a, const Seed& b) { return a.distance < b.distance; });
    std::optional<Vec2> best;
    double best_distance = INFINITY;
    for (int k = 0; k < kTries; ++k) {
      const std::optional<Vec2> foot = Newton(target, seeds[static_cast<std::size_t>(k)].at);
      if (!foot) continue;
      const double distance = surface_.Value(foot->x, foot->y).Distance(target);
      if (!(distance < best_distance)) continue;
      best_distance = distance;
      best = foot;
    }
    return best;
  }

  const GeomAdaptor_Surface& surface_;
  const bool closed_;  // the surface's parameters have a closed form
  const bool periodic_u_, periodic_v_;
  const double u0_, u1_, v0_, v1_;
  gp_Ax1 axis_;
  double radius_ = 1;
  double size_u_ = 0, size_v_ = 0;  // squared derivatives in the middle of the surface
};

struct Step {
  double s;
  Vec2 at;
};

// Follows the projection along the edge. The result is empty if that fails.
std::vector<Step> Follow(const Projector& projector, const std::function<gp_Pnt(double)>& edge,
                         const std::vector<double>& breaks) {
  std::vector<double> at;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    for (int k = 0; k < kSteps; ++k) at.push_back(breaks[i] + (breaks[i + 1] - breaks[i]) * k / kSteps);
  at.push_back(breaks.back());
  // An end may be a pole, so begin in the middle and go in both directions.
  const std::size_t middle = at.size() / 2;
  std::vector<Step> steps(at.size());
  const std::optional<Vec2> first = projector.Find(edge(at[middle]), std::nullopt);
  if (!first) return {};
  steps[middle] = {at[middle], *first};
  const auto walk = [&](std::size_t from, std::size_t to, std::size_t before) {
    // Extrapolate the last two steps.
    Vec2 guess = steps[from].at;
    if (before != from) {
      const double ratio = (at[to] - at[from]) / (at[from] - at[before]);
      guess = guess + ratio * (steps[from].at - steps[before].at);
    }
    const std::optional<Vec2> found = projector.Find(edge(at[to]), guess);
    if (!found || !std::isfinite(found->x) || !std::isfinite(found->y)) return false;
    steps[to] = {at[to], *found};
    return true;
  };
  for (std::size_t i = middle + 1; i < at.size(); ++i)
    if (!walk(i - 1, i, i >= middle + 2 ? i - 2 : i - 1)) return {};
  for (std::size_t i = middle; i-- > 0;)
    if (!walk(i + 1, i, i + 2 < at.size() ? i + 2 : i + 1)) return {};
  return steps;
}

// A border of the surface along which an edge runs, given by the parameter that is constant there.
struct Border {
  std::optional<double> u, v;

  Vec2 On(Vec2 at) const { return {u.value_or(at.x), v.value_or(at.y)}; }
};

// Returns the border next to the steps, provided that the edge is no farther from the border than from the
// steps themselves. If weights differ much, a parameter is much less accurate than a point, so that an edge
// on the border may have parameters beside it.
Border FindBorder(const GeomAdaptor_Surface& surface, const std::function<gp_Pnt(double)>& edge,
                  const std::vector<Step>& steps, double tolerance) {
  const auto follows = [&](const Border& border, double range) {
    return std::all_of(steps.begin(), steps.end(), [&](const Step& step) {
      const Vec2 on = border.On(step.at);
      if (!(std::fabs(on.x - step.at.x) + std::fabs(on.y - step.at.y) <= kBeside * range)) return false;
      const gp_Pnt point = edge(step.s);
      return surface.Value(on.x, on.y).Distance(point) <=
             surface.Value(step.at.x, step.at.y).Distance(point) + tolerance;
    });
  };
  const double u0 = surface.FirstUParameter(), u1 = surface.LastUParameter();
  const double v0 = surface.FirstVParameter(), v1 = surface.LastVParameter();
  for (const double u : {u0, u1})
    if (const Border border{u, std::nullopt}; u1 - u0 < 1e50 && follows(border, u1 - u0)) return border;
  for (const double v : {v0, v1})
    if (const Border border{std::nullopt, v}; v1 - v0 < 1e50 && follows(border, v1 - v0)) return border;
  return {};
}

// Returns whether the steps lie on the chord between the first and the last of them at even speed. The
// tolerance is in mm.
bool IsStraight(const std::vector<Step>& steps, double scale_u, double scale_v, double tolerance) {
  const Step &a = steps.front(), &b = steps.back();
  for (const Step& step : steps) {
    const double t = (step.s - a.s) / (b.s - a.s);
    const Vec2 off = step.at - (a.at + t * (b.at - a.at));
    if (!(std::hypot(off.x * scale_u, off.y * scale_v) <= tolerance)) return false;
  }
  return true;
}

CurvePiece Line(const Step& a, const Step& b) {
  CurvePiece piece;
  piece.begin = a.s;
  piece.end = b.s;
  piece.points = {{a.at.x, a.at.y, 0, 1}, {b.at.x, b.at.y, 0, 1}};
  return piece;
}

}  // namespace

std::vector<CurvePiece> ProjectEdge(const GeomAdaptor_Surface& surface,
                                    const std::function<gp_Pnt(double)>& edge,
                                    const std::vector<double>& breaks, double tolerance) {
  if (HasExtremeWeights(surface)) return {};
  const Projector projector(surface);
  if (!projector.closed_form() &&
      ((surface.IsUClosed() && !surface.IsUPeriodic()) || (surface.IsVClosed() && !surface.IsVPeriodic())))
    return {};
  std::vector<Step> steps = Follow(projector, edge, breaks);
  if (steps.empty()) return {};
  Border border;
  if (!projector.closed_form()) border = FindBorder(surface, edge, steps, tolerance);
  for (Step& step : steps) step.at = border.On(step.at);

  // Scale the parameters to millimetres, so that the fit's deviation is in millimetres, too.
  gp_Pnt point;
  gp_Vec du, dv;
  const Vec2 middle = steps[steps.size() / 2].at;
  surface.D1(middle.x, middle.y, point, du, dv);
  const double scale_u = du.Magnitude(), scale_v = dv.Magnitude();
  if (!(scale_u > 0) || !(scale_v > 0)) return {};
  if (IsStraight(steps, scale_u, scale_v, tolerance)) return {Line(steps.front(), steps.back())};

  bool found = true;
  const auto project = [&](double s) {
    const auto after = std::upper_bound(steps.begin() + 1, steps.end() - 1, s,
                                        [](double value, const Step& step) { return value < step.s; });
    const Step &a = *(after - 1), &b = *after;
    const Vec2 guess = a.at + (s - a.s) / (b.s - a.s) * (b.at - a.at);
    const std::optional<Vec2> uv = projector.Find(edge(s), guess);
    found = found && uv.has_value();
    if (!uv) return Vec3{};
    const Vec2 at = border.On(*uv);
    return Vec3{at.x * scale_u, at.y * scale_v, 0};
  };
  double deviation = 0;
  std::vector<CurvePiece> pieces = ApproximateCurve(project, breaks, tolerance, kFitDepth, &deviation);
  if (!found) return {};
  for (CurvePiece& piece : pieces)
    for (Vec4& p : piece.points)
      p = {border.u.value_or(p.x / scale_u), border.v.value_or(p.y / scale_v), 0, 1};
  return pieces;
}

}  // namespace facetless
