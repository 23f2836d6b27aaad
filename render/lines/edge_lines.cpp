#include "render/lines/edge_lines.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

#include "render/base/parallel.h"
#include "render/base/trigonometry.h"
#include "render/model/walk.h"
#include "render/nurbs/monotone_curve.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {
namespace {

constexpr int kMostHalvings = 14;  // of a segment; sufficient for a line of a million pixels
constexpr int kPlaces = 5;         // points along an edge at which its angle is measured

constexpr double kSmallest = 0.1;  // pixels; the ends of neighbouring lines cover a smaller edge

// The outward normal of the face at a parameter of the edge; nothing if there is none.
std::optional<Vec3> NormalBeside(const Model& model, const EdgeUse& use, double parameter) {
  const Coedge& coedge = model.coedges[use.coedge];
  for (const TrimSegment& segment : SegmentsOf(model, coedge)) {
    const double low = std::min(segment.edge_begin, segment.edge_end),
                 high = std::max(segment.edge_begin, segment.edge_end);
    if (!(parameter >= low && parameter <= high && high > low)) continue;
    const double t = (parameter - segment.edge_begin) / (segment.edge_end - segment.edge_begin);
    const Vec2 uv = PointOn({PointsOf(model, segment).data(), segment.degree}, t);
    const SurfaceEval surface(model, model.faces[use.face].surface);
    const SurfacePoint point = surface.First(uv.x, uv.y);
    const Vec3 normal = Normalized(Cross(point.du, point.dv));
    if (!(Dot(normal, normal) > 0)) return {};
    return model.faces[use.face].reversed ? -normal : normal;
  }
  return {};
}

LineClass ClassOf(const Model& model, const Edge& edge, std::span<const EdgeUse> uses, double cos_edge) {
  if (uses.size() == 1) return LineClass::kBoundary;
  if (uses.size() != 2) return LineClass::kFeature;
  if (uses[0].face == uses[1].face) return LineClass::kSeam;
  const std::span<const EdgeSegment> segments = SegmentsOf(model, edge);
  const double begin = segments.front().begin, end = segments.back().end;
  double least_cosine = 1;
  for (int i = 0; i < kPlaces; ++i) {
    const double parameter = begin + (end - begin) * (i + 0.5) / kPlaces;
    const auto a = NormalBeside(model, uses[0], parameter), b = NormalBeside(model, uses[1], parameter);
    if (a && b) least_cosine = std::min(least_cosine, Dot(*a, *b));
  }
  return least_cosine < cos_edge ? LineClass::kFeature : LineClass::kSmooth;
}

// Projects the edges of one instance.
class Projector {
 public:
  Projector(const Model& model, const Instance& instance, const Camera& camera, const CameraFrame& frame)
      : model_(model),
        placement_(instance.placement),
        to_placed_face_(PlacedFaceId(model, instance, 0)),
        camera_(camera),
        frame_(frame) {}

  void Add(const Edge& edge, std::span<const EdgeUse> uses, LineClass kind, std::vector<ViewLine>* lines) {
    line_ = {kind, true, {}};
    for (std::size_t k = 0; k < std::min(uses.size(), line_.faces.size()); ++k)
      line_.faces[k] = to_placed_face_ + uses[k].face;
    for (const EdgeSegment& segment : SegmentsOf(model_, edge)) {
      std::vector<Vec4> points;
      for (const Vec4& p : PointsOf(model_, segment)) {
        const Vec3 placed = placement_.Point({p.x / p.w, p.y / p.w, p.z / p.w});
        points.push_back({p.w * placed.x, p.w * placed.y, p.w * placed.z, p.w});
      }
      Flatten(points, 0, lines);
    }
    End(lines);
  }

 private:
  PixelPoint At(const Vec4& p) const { return Project(frame_, {p.x / p.w, p.y / p.w, p.z / p.w}); }

  void End(std::vector<ViewLine>* lines) {
    double size = 0;
    for (const LinePoint& p : line_.points)
      size = std::max({size, std::fabs(p.x - line_.points[0].x), std::fabs(p.y - line_.points[0].y)});
    if (size >= kSmallest) lines->push_back(line_);
    line_.points.clear();
  }

  void Flatten(const std::vector<Vec4>& points, int halvings, std::vector<ViewLine>* lines) {
    // Skip a piece that lies behind the eye or outside the window.
    const bool perspective = frame_.projection == Projection::kPerspective;
    bool left = true, right = true, above = true, below = true, behind = perspective, in_front = true;
    std::vector<PixelPoint> pixels;
    for (const Vec4& p : points) {
      pixels.push_back(At(p));
      const PixelPoint& q = pixels.back();
      const bool ahead = !perspective || q.depth > frame_.near_mm;
      in_front = in_front && ahead;
      behind = behind && !ahead;
      left = left && q.x < 0;
      right = right && q.x > camera_.width_px;
      above = above && q.y < 0;
      below = below && q.y > camera_.height_px;
    }
    if (behind || (in_front && (left || right || above || below))) return End(lines);
    const PixelPoint &a = pixels.front(), &b = pixels.back();
    if (in_front && IsFlat(pixels)) {
      if (line_.points.empty()) line_.points.push_back({a.x, a.y, a.depth});
      line_.points.push_back({b.x, b.y, b.depth});
      return;
    }
    if (halvings == kMostHalvings) return End(lines);
    // Halve by de Casteljau's algorithm.
    std::vector<Vec4> row = points, low, high(points.size());
    for (std::size_t level = 0; level < points.size(); ++level) {
      low.push_back(row.front());
      high[points.size() - 1 - level] = row[points.size() - 1 - level];
      for (std::size_t i = 0; i + 1 < points.size() - level; ++i) row[i] = 0.5 * (row[i] + row[i + 1]);
    }
    Flatten(low, halvings + 1, lines);
    Flatten(high, halvings + 1, lines);
  }

  // Returns whether the control points are close enough to the chord, on the screen and in depth (in pixels).
  bool IsFlat(const std::vector<PixelPoint>& pixels) const {
    const PixelPoint &a = pixels.front(), &b = pixels.back();
    const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    const double scale = std::max(frame_.pixel_x, frame_.pixel_y);
    for (std::size_t i = 1; i + 1 < pixels.size(); ++i) {
      const PixelPoint& p = pixels[i];
      const double share =
          square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0;
      const double off_x = p.x - a.x - share * dx, off_y = p.y - a.y - share * dy;
      if (!(off_x * off_x + off_y * off_y <= kFlatness * kFlatness)) return false;
      const double pixel = frame_.projection == Projection::kPerspective ? scale * p.depth : scale;
      // If the chord is a point on the screen, depth cannot be interpolated along it.
      const double chord_depth =
          square > kFlatness * kFlatness
              ? a.depth + share * (b.depth - a.depth)
              : std::clamp(p.depth, std::min(a.depth, b.depth), std::max(a.depth, b.depth));
      if (!(std::fabs(p.depth - chord_depth) <= kDepthFlatness * pixel)) return false;
    }
    return true;
  }

  const Model& model_;
  const Placement& placement_;
  const std::uint32_t to_placed_face_;  // added to a face's index to get its placed-face id, modulo 2^32
  const Camera& camera_;
  const CameraFrame& frame_;
  ViewLine line_;
};

}  // namespace

std::vector<LineClass> ClassifyEdges(const Model& model, double edge_angle_deg) {
  // Compute the cosine from the tangent of half the angle, without libm.
  const double t = edge_angle_deg < 180 ? PolyTan(edge_angle_deg * (std::numbers::pi / 360)) : INFINITY;
  const double cos_edge = std::isfinite(t) ? (1 - t * t) / (1 + t * t) : -1;
  const EdgeUses uses(model);
  std::vector<LineClass> classes(model.edges.size(), LineClass::kFeature);
  ParallelFor(std::size_t{0}, model.edges.size(), [&](std::size_t e) {
    const Edge& edge = model.edges[e];
    if (!edge.degenerate && edge.segments.count > 0 && !uses[e].empty())
      classes[e] = ClassOf(model, edge, uses[e], cos_edge);
  });
  return classes;
}

std::vector<ViewLine> EdgeLines(const Model& model, const std::vector<LineClass>& classes,
                                const Camera& camera, const CameraFrame& frame, const Execution& execution) {
  const EdgeUses uses(model);
  // List the edges of each part, in ascending order.
  std::vector<std::vector<std::uint32_t>> edges_of(model.parts.size());
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    std::vector<std::uint32_t>& edges = edges_of[p];
    for (const Face& face : FacesOf(model, model.parts[p]))
      for (const Coedge& coedge : CoedgesOf(model, face))
        if (coedge.edge != kNoIndex) edges.push_back(coedge.edge);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
  std::vector<std::vector<ViewLine>> of_instance(model.instances.size());
  ParallelFor(std::size_t{0}, model.instances.size(), [&](std::size_t i) {
    if (execution.cancelled()) return;
    const Instance& instance = model.instances[i];
    Projector projector(model, instance, camera, frame);
    for (const std::uint32_t e : edges_of[instance.part])
      if (!model.edges[e].degenerate) projector.Add(model.edges[e], uses[e], classes[e], &of_instance[i]);
  });
  std::vector<ViewLine> lines;
  for (auto& own : of_instance)
    lines.insert(lines.end(), std::make_move_iterator(own.begin()), std::make_move_iterator(own.end()));
  return lines;
}

}  // namespace facetless
