#include "render/trace/projected_edges.h"

#include <algorithm>
#include <cmath>

#include "render/model/walk.h"
#include "render/nurbs/point_room.h"

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;
// The parameter of the nearest point within its segment is rounded to multiples of this. Iterations from
// different starts agree to about 1e-14. On an edge of 1000 pixels, rounding moves the foot by 1e-7 pixels,
// and the curve perpendicular to itself by the square of that.
constexpr double kParameterGrid = 0x1p-32;
// The convergence rate of Gauss–Newton is the distance over the radius of curvature, which is far below one
// in the band of an edge.
constexpr int kMaxSteps = 40;
constexpr int kMaxHalvings = 8;

}  // namespace

// One projected segment of an edge, relative to a pixel, so that its evaluation does not subtract large
// numbers.
class ProjectedEdges::Segment {
 public:
  Segment(const ProjectedEdges& edges, Range segments, double x, double y)
      : edges_(edges), segments_(segments), pixel_{x, y} {}

  void Select(std::uint32_t index) {
    if (index == index_) return;
    index_ = index;
    const EdgeSegment& segment = edges_.model_->edge_segments[segments_.first + index];
    degree_ = segment.degree;
    double error = 0, size = 0, nearest = INFINITY;
    for (int i = 0; i <= degree_; ++i) {
      const Vec4& p = edges_.model_->edge_points[segment.first_point + static_cast<std::uint32_t>(i)];
      const Vec3 relative = edges_.Relative(p, pixel_.x, pixel_.y);
      points_.points[i] = relative;
      const auto own = edges_.projection_.Error(p);
      const double x = std::fabs(pixel_.x - edges_.center_x_), y = std::fabs(pixel_.y - edges_.center_y_);
      error = std::max({error, own.x + x * own.w, own.y + y * own.w});
      size = std::max(size, std::fabs(relative.x) + std::fabs(relative.y) + (x + y) * relative.z);
      nearest = std::min(nearest, relative.z);
    }
    // Subtracting the pixel rounds twice, and each step of de Casteljau's algorithm rounds three times.
    error_px_ = nearest > 0 ? (error + kEpsilon * (2 + 3 * degree_) * size) / nearest : INFINITY;
  }
  double error_px() const { return error_px_; }
  std::uint32_t index() const { return index_; }

  // The point relative to the pixel, and the derivative with respect to t, in pixels. Returns false behind
  // the eye.
  bool At(double t, Vec2& point, Vec2& tangent) const {
    // Apply de Casteljau's algorithm down to the last two points.
    PointRoom room;
    Vec3* const p = room.points;
    std::copy_n(points_.points, degree_ + 1, p);
    for (int last = degree_; last > 1; --last)
      for (int i = 0; i < last; ++i) p[i] = (1 - t) * p[i] + t * p[i + 1];
    const Vec3 h = (1 - t) * p[0] + t * p[1], d = double(degree_) * (p[1] - p[0]);
    if (!(h.z > 0)) return false;
    point = {h.x / h.z, h.y / h.z};
    tangent = {(d.x - d.z * point.x) / h.z, (d.y - d.z * point.y) / h.z};
    return true;
  }

 private:
  const ProjectedEdges& edges_;
  const Range segments_;
  const Vec2 pixel_;
  std::uint32_t index_ = kNoIndex;
  int degree_ = 1;
  double error_px_ = 0;
  PointRoom points_;
};

ProjectedEdges::ProjectedEdges(const Model& model, const Placement& placement, const CameraFrame& frame)
    : model_(&model), projection_(frame, placement), center_x_(frame.center_x), center_y_(frame.center_y) {}

Vec3 ProjectedEdges::Relative(const Vec4& p, double x, double y) const {
  const auto h = projection_(p);
  return {h.x - (x - center_x_) * h.w, h.y - (y - center_y_) * h.w, h.w};
}

namespace {

// The side of the line through `point` along `tangent` on which the pixel, at the origin, lies. On the line
// itself, the answer is kNegative for both faces.
Side SideOfLine(Vec2 point, Vec2 tangent) {
  if (!(Dot(tangent, tangent) > 0)) return Side::kUnknown;
  return Cross(point, tangent) > 0 ? Side::kPositive : Side::kNegative;  // = cross(tangent, −point)
}

// The side at a kink, from both tangent lines. The positive side is the intersection of two half planes if
// the curve turns towards it, and their union otherwise.
Side SideOfKink(Side in, Side out, double turn) {
  if (in == Side::kUnknown || out == Side::kUnknown) return in == Side::kUnknown ? out : in;
  if (turn > 0) return std::min(in, out);
  return std::max(in, out);
}

// The segment that contains `parameter`; at a joint, the later one.
std::uint32_t FindEdgeSegment(std::span<const EdgeSegment> segments, double parameter) {
  std::uint32_t low = 0, high = static_cast<std::uint32_t>(segments.size()) - 1;
  while (low < high) {
    const std::uint32_t middle = (low + high + 1) / 2;
    if (segments[middle].begin <= parameter) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

}  // namespace

EdgeSide ProjectedEdges::SideOf(std::uint32_t edge_index, double guess, double x, double y) const {
  EdgeSide result;
  const Edge& edge = model_->edges[edge_index];
  if (edge.segments.count == 0) return result;
  const std::span<const EdgeSegment> spans = SegmentsOf(*model_, edge);
  const std::uint32_t count = edge.segments.count;
  const bool closed = edge.vertices[0] != kNoIndex && edge.vertices[0] == edge.vertices[1];

  // Start at the guess.
  Segment segment(*this, edge.segments, x, y);
  segment.Select(FindEdgeSegment(spans, guess));
  const EdgeSegment& first = spans[segment.index()];
  double t = std::clamp((guess - first.begin) / (first.end - first.begin), 0.0, 1.0);
  Vec2 point, tangent;
  if (!segment.At(t, point, tangent)) return result;

  // Iterate by Gauss–Newton towards the foot. Each step is halved until it reduces the distance.
  for (int step = 0; step < kMaxSteps; ++step) {
    const double speed = Dot(tangent, tangent);
    if (!(speed > 0)) return result;
    double move = -Dot(point, tangent) / speed;
    // At a joint, continue along the neighbouring segment if that reduces the distance.
    const bool forwards = move > 0, at_end = forwards ? t == 1 : t == 0;
    if (at_end) {
      const std::uint32_t k = segment.index();
      if (!closed && k == (forwards ? count - 1 : 0)) break;
      segment.Select(forwards ? (k + 1) % count : (k + count - 1) % count);
      t = forwards ? 0 : 1;
      if (!segment.At(t, point, tangent)) return result;
      const double along = -Dot(point, tangent);
      if (!(forwards ? along > 0 : along < 0)) break;  // the joint itself is nearest
      continue;
    }
    bool nearer = false;
    for (int halving = 0; halving <= kMaxHalvings && !nearer; ++halving, move *= 0.5) {
      const double next = std::clamp(t + move, 0.0, 1.0);
      Vec2 next_point, next_tangent;
      if (!segment.At(next, next_point, next_tangent)) continue;
      nearer = next != t && Dot(next_point, next_point) < Dot(point, point);
      if (nearer) t = next, point = next_point, tangent = next_tangent;
    }
    if (!nearer) break;
  }

  // Round the foot to the grid and take the side there.
  t = std::floor(t / kParameterGrid + 0.5) * kParameterGrid;
  if (!segment.At(t, point, tangent)) return result;
  result.side = SideOfLine(point, tangent);
  result.error_px = segment.error_px();
  const std::uint32_t k = segment.index();
  const bool joins_next = t == 1 && (closed || k + 1 < count), joins_previous = t == 0 && (closed || k > 0);
  // Inside the edge, use the distance from the tangent line, which the rounding of t does not affect.
  const bool clamped = (t == 0 || t == 1) && !joins_next && !joins_previous;
  result.distance_px = clamped ? Length(point) : std::fabs(Cross(point, tangent)) / Length(tangent);
  const EdgeSegment& last = spans[k];
  const double width = last.end - last.begin;
  result.parameter = t <= 0.5 ? last.begin + t * width : last.end - (1 - t) * width;
  result.tangent = (1 / width) * tangent;

  // At a joint of two segments, use both tangents.
  if (joins_next || joins_previous) {
    segment.Select(joins_next ? (k + 1) % count : (k + count - 1) % count);
    Vec2 other_point, other;
    if (!segment.At(joins_next ? 0 : 1, other_point, other)) return result;
    const Side side = SideOfLine(point, other);
    result.side = joins_next ? SideOfKink(result.side, side, Cross(tangent, other))
                             : SideOfKink(side, result.side, Cross(other, tangent));
  }
  return result;
}

Vec2 ProjectedEdges::TangentAt(std::uint32_t edge_index, double parameter, bool ending) const {
  const Edge& edge = model_->edges[edge_index];
  if (edge.segments.count == 0) return {};
  const std::span<const EdgeSegment> spans = SegmentsOf(*model_, edge);
  std::uint32_t k = FindEdgeSegment(spans, parameter);
  if (ending && k > 0 && spans[k].begin == parameter) --k;
  const EdgeSegment& span = spans[k];
  Segment segment(*this, edge.segments, 0, 0);
  segment.Select(k);
  Vec2 point, tangent;
  if (!segment.At(std::clamp((parameter - span.begin) / (span.end - span.begin), 0.0, 1.0), point, tangent))
    return {};
  return (1 / (span.end - span.begin)) * tangent;
}

bool EdgeKeepsHit(const Coedge& coedge, bool material_left, Side side, bool jacobian_positive) {
  // The left side of the p-curve in (u,v) is the positive side of its image if the map preserves the
  // orientation. The edge may run in the opposite direction.
  const bool material_positive = (material_left == jacobian_positive) != coedge.reversed;
  return (side == Side::kPositive) == material_positive;
}

namespace {

// Returns whether the ray passes the edge so far away that the p-curve and the edge cannot disagree, because
// they are at most a gap apart. Twice the gap allows for the way in which it was measured; the rest, in
// samples, allows for the rounding of a projected edge.
bool OutOfReach(const Coedge& coedge, const EdgeSide& side, double mm_per_px) {
  constexpr double kRoundingPx = 0x1p-20;
  return side.distance_px > 2 * coedge.gap_mm / mm_per_px + std::max(kRoundingPx, side.error_px);
}

}  // namespace

EdgeDecision DecideAtEdge(const Model& model, const ProjectedEdges& edges, const TrimAnswer& answer, double x,
                          double y, double mm_per_px, bool jacobian_positive) {
  if (answer.coedge == kNoIndex) return {};
  const Coedge& one = model.coedges[answer.coedge];
  const EdgeSide side = edges.SideOf(one.edge, answer.edge_parameter, x, y);
  if (side.side == Side::kUnknown) return {};
  // At grazing incidence, the band in (u,v) and the error box may be wide, although neither is wide as seen
  // along the ray. If the edge is farther away on the screen, the side of the edge is irrelevant for this
  // hit.
  if (OutOfReach(one, side, mm_per_px)) return {};
  const bool keeps = EdgeKeepsHit(one, answer.material_left, side.side, jacobian_positive);
  EdgeDecision decision{keeps ? EdgeVerdict::kKeep : EdgeVerdict::kDrop, side.distance_px > side.error_px};
  if (answer.other_coedge == kNoIndex || answer.other_material_left != answer.material_left) return decision;

  // Ask the other coedge of the corner.
  const Coedge& two = model.coedges[answer.other_coedge];
  const EdgeSide other = edges.SideOf(two.edge, answer.other_edge_parameter, x, y);
  if (other.side == Side::kUnknown) return decision;
  decision.proven = decision.proven && other.distance_px > other.error_px;
  const bool other_keeps = EdgeKeepsHit(two, answer.other_material_left, other.side, jacobian_positive);
  if (other_keeps == keeps) return decision;
  // A seam that ends in a pole: the face surrounds the corner.
  if (one.edge == two.edge) return {EdgeVerdict::kKeep, decision.proven};

  // Find the direction in which the loop turns there, in the image.
  const Coedge& in = answer.other_is_next ? one : two;
  const Coedge& out = answer.other_is_next ? two : one;
  const double in_end = SegmentsOf(model, in).back().edge_end;
  const double out_begin = SegmentsOf(model, out).front().edge_begin;
  const Vec2 arriving = (in.reversed ? -1.0 : 1.0) * edges.TangentAt(in.edge, in_end, !in.reversed);
  const Vec2 leaving = (out.reversed ? -1.0 : 1.0) * edges.TangentAt(out.edge, out_begin, out.reversed);
  const double turn = Cross(arriving, leaving);
  if (turn == 0) return decision;  // smooth, a cusp, or unknown
  const bool convex = (turn > 0) == (answer.material_left == jacobian_positive);
  const bool both = convex ? keeps && other_keeps : keeps || other_keeps;
  decision.verdict = both ? EdgeVerdict::kKeep : EdgeVerdict::kDrop;
  return decision;
}

}  // namespace facetless
