#include "render/inspect/continuity.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/base/parallel.h"
#include "render/inspect/angle.h"
#include "render/inspect/curvature.h"
#include "render/model/walk.h"
#include "render/nurbs/edge_points.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {
namespace {

// The number of steps of Newton's method for a foot. It starts within a gap of the foot, and each step
// doubles the number of correct digits.
constexpr int kMostSteps = 6;

// The foot of `target` on the surface, within its grid, found by Gauss–Newton from `start`.
Vec2 FindSurfaceFoot(const SurfaceEval& surface, Vec3 target, Vec2 start) {
  const auto within = [&](Vec2 at) {
    return Vec2{std::clamp(at.x, surface.u_begin(), surface.u_end()),
                std::clamp(at.y, surface.v_begin(), surface.v_end())};
  };
  Vec2 at = within(start), best = at;
  double nearest = INFINITY;
  for (int step = 0; step < kMostSteps; ++step) {
    const SurfacePoint p = surface.First(at.x, at.y);
    const Vec3 off = target - p.position;
    const double distance = Length(off);
    if (!(distance < nearest)) break;
    nearest = distance;
    best = at;
    const double uu = Dot(p.du, p.du), uv = Dot(p.du, p.dv), vv = Dot(p.dv, p.dv),
                 determinant = uu * vv - uv * uv;
    const double u = Dot(off, p.du), v = Dot(off, p.dv);
    const Vec2 next =
        within({at.x + (u * vv - v * uv) / determinant, at.y + (v * uu - u * uv) / determinant});
    if (!std::isfinite(next.x) || !std::isfinite(next.y)) break;
    at = next;
  }
  return best;
}

// The values of one face at one point of an edge.
struct Side {
  SurfacePoint point;
  TangentFrame frame;
};

class EdgeMeter {
 public:
  EdgeMeter(const Model& model, const std::vector<SurfaceEval>& surfaces)
      : model_(model), surfaces_(surfaces) {}

  // Measures an edge; nothing if no point of it can be measured.
  std::optional<EdgeContinuity> Measure(std::uint32_t index, const EdgeUse (&uses)[2]) const {
    const Edge& edge = model_.edges[index];
    EdgeContinuity result;
    result.edge = index;
    // The two faces may lie within the tolerance on opposite sides of the edge.
    result.tolerance_mm = std::max(2 * edge.tolerance_mm, kPositionShare * model_.Diagonal());
    const double turn = Turn(uses);
    for (int side = 0; side < 2; ++side) result.faces[side] = uses[side].face;
    const std::span<const EdgeSegment> segments = SegmentsOf(model_, edge);
    const double begin = segments.front().begin, end = segments.back().end;
    bool measured = false;
    Vec3 before;
    for (int k = 0; k <= kPlaces; ++k) {
      const double parameter = k < kPlaces ? begin + (end - begin) * k / kPlaces : end;
      const EdgePoint place = EvaluateEdge(model_, edge, parameter);
      if (k > 0) result.length_mm += Length(place.position - before);
      before = place.position;
      const std::optional<Side> one = SideAt(uses[0], place, parameter),
                                other = SideAt(uses[1], place, parameter);
      if (!one || !other) continue;
      measured = true;
      Add(place, *one, *other, turn, &result);
    }
    if (!measured) return std::nullopt;
    Classify(&result);
    return result;
  }

 private:
  // Returns −1 if both faces run along the edge in the same sense, which means that their orientations are
  // opposite.
  double Turn(const EdgeUse (&uses)[2]) const {
    bool forward[2];
    for (int side = 0; side < 2; ++side)
      forward[side] = model_.coedges[uses[side].coedge].reversed == model_.faces[uses[side].face].reversed;
    return forward[0] == forward[1] ? -1 : 1;
  }

  std::optional<Side> SideAt(const EdgeUse& use, const EdgePoint& place, double parameter) const {
    const SurfaceEval& surface = surfaces_[use.face];
    const Vec2 foot = FindSurfaceFoot(surface, place.position,
                                      EvaluateCoedge(model_, model_.coedges[use.coedge], parameter));
    const SurfacePoint point = surface.Second(foot.x, foot.y);
    const std::optional<TangentFrame> frame =
        FrameAt(point, model_.faces[use.face].reversed ? -1 : 1, surface.u_end() - surface.u_begin(),
                surface.v_end() - surface.v_begin());
    if (!frame) return std::nullopt;
    return Side{point, *frame};
  }

  static void Add(const EdgePoint& place, const Side& one, const Side& other, double turn,
                  EdgeContinuity* result) {
    const auto keep = [&](WorstPlace& worst, double value) {
      if (!(value > worst.value)) return false;
      worst = {value, place.position};
      return true;
    };
    keep(result->gap_mm, Length(one.point.position - other.point.position));
    const double angle = AngleDeg(one.frame.normal, turn * other.frame.normal);
    keep(result->angle_deg, angle);
    if (angle > kAngleDeg || !(Length(place.tangent) > 0)) return;
    const double a =
        NormalCurvature(one.point, one.frame, Normalized(Cross(one.frame.normal, place.tangent)));
    const double b = turn * NormalCurvature(other.point, other.frame,
                                            Normalized(Cross(other.frame.normal, place.tangent)));
    if (!std::isfinite(a) || !std::isfinite(b) || !keep(result->curvature_jump, std::fabs(a - b))) return;
    result->relative_jump = std::fabs(a - b) / std::max(std::fabs(a), std::fabs(b));
    result->curvatures[0] = a;
    result->curvatures[1] = b;
  }

  void Classify(EdgeContinuity* result) const {
    const double flat = kFlatShare / model_.Diagonal();
    if (result->gap_mm.value > result->tolerance_mm) {
      result->grade = Grade::kGap;
    } else if (result->angle_deg.value > kAngleDeg) {
      result->grade = Grade::kG0;
    } else if (result->relative_jump > kCurvatureShare && result->curvature_jump.value > flat) {
      result->grade = Grade::kG1;
    }
  }

  const Model& model_;
  const std::vector<SurfaceEval>& surfaces_;
};

double GradeMeasure(const EdgeContinuity& edge) {
  switch (edge.grade) {
    case Grade::kGap:
      return edge.gap_mm.value;
    case Grade::kG0:
      return edge.angle_deg.value;
    default:
      return edge.curvature_jump.value;
  }
}

}  // namespace

Result<Continuity> MeasureContinuity(const Model& model, const Execution& execution) {
  const EdgeUses uses(model);
  std::vector<SurfaceEval> surfaces;
  surfaces.reserve(model.faces.size());
  for (const Face& face : model.faces) surfaces.emplace_back(model, face.surface);

  // Measure the edges that two faces share.
  Continuity continuity;
  std::vector<std::uint32_t> shared;
  for (std::uint32_t e = 0; e < model.edges.size(); ++e) {
    if (model.edges[e].degenerate || model.edges[e].segments.count == 0) continue;
    if (uses[e].size() == 1) ++continuity.border_edges;
    if (uses[e].size() > 2) ++continuity.crowded_edges;
    if (uses[e].size() == 2) shared.push_back(e);
  }
  const EdgeMeter meter(model, surfaces);
  std::vector<std::optional<EdgeContinuity>> found(shared.size());
  RunWithThreads(execution.threads, [&] {
    ParallelFor(std::size_t{0}, shared.size(), [&](std::size_t i) {
      if (execution.cancelled()) return;
      const std::span<const EdgeUse> both = uses[shared[i]];
      found[i] = meter.Measure(shared[i], {both[0], both[1]});
    });
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "stopped"};

  // Sort the edges, worst first.
  for (const std::optional<EdgeContinuity>& edge : found) {
    if (!edge) {
      ++continuity.unmeasured_edges;
      continue;
    }
    ++continuity.counts[static_cast<std::size_t>(edge->grade)];
    continuity.edges.push_back(*edge);
  }
  std::stable_sort(continuity.edges.begin(), continuity.edges.end(),
                   [](const EdgeContinuity& a, const EdgeContinuity& b) {
                     return a.grade != b.grade ? a.grade < b.grade : GradeMeasure(a) > GradeMeasure(b);
                   });
  return continuity;
}

}  // namespace facetless
