#include "render/trace/edge_winding.h"

#include <algorithm>

#include "render/model/walk.h"
#include "render/nurbs/point_room.h"

namespace facetless {
namespace {

// The largest number of halvings. After that, a piece is shorter than the rounding of its points, and its
// ends alone decide.
constexpr int kMaxHalvings = 52;

// A projected Bézier segment relative to the pixel, (x·W, y·W, W) with W > 0: the signs of x and y are those
// of the first two components.
bool CrossesOdd(Vec3* p, int degree, int halvings) {
  bool above = true, below = true, left = true, right = true;
  for (int i = 0; i <= degree; ++i) {
    (p[i].y >= 0 ? below : above) = false;
    (p[i].x >= 0 ? left : right) = false;
  }
  if (above || below || left) return false;
  const Vec3 first = p[0], last = p[degree];
  const bool rises = first.y < 0, ends_differ = rises != (last.y < 0);
  if (right) return ends_differ;
  if (degree == 1 || halvings == kMaxHalvings) {
    // Find the side on which the chord crosses y = 0.
    const double side = first.x * last.y - last.x * first.y;
    return ends_differ && (rises ? side : -side) > 0;
  }

  // Halve.
  PointRoom room;
  Vec3* const low = room.points;
  low[0] = p[0];
  for (int level = 1; level <= degree; ++level) {
    for (int i = 0; i <= degree - level; ++i) p[i] = 0.5 * (p[i] + p[i + 1]);
    low[level] = p[0];
  }
  return CrossesOdd(low, degree, halvings + 1) != CrossesOdd(p, degree, halvings + 1);
}

bool CrossesOdd(const Vec3& from, const Vec3& to) {
  Vec3 line[2] = {from, to};
  return CrossesOdd(line, 1, 0);
}

}  // namespace

std::optional<bool> CrossesHalfLine(const ProjectedEdges& edges, std::uint32_t index, double x, double y) {
  const Model& model = edges.model();
  const Edge& edge = model.edges[index];
  if (edge.segments.count == 0) return std::nullopt;
  const auto vertex = [&](int end) {
    const Vec3& p = model.vertices[edge.vertices[end]].point;
    return edges.Relative({p.x, p.y, p.z, 1}, x, y);
  };
  bool odd = false, in_front = true;
  const bool has_vertices = edge.vertices[0] != kNoIndex && edge.vertices[1] != kNoIndex;
  Vec3 at;
  if (has_vertices) {
    at = vertex(0);
    in_front = at.z > 0;
  }

  // Follow the edge from vertex to vertex; the ends of successive segments may differ by rounding.
  bool first = true;
  for (const EdgeSegment& segment : SegmentsOf(model, edge)) {
    const std::span<const Vec4> points = PointsOf(model, segment);
    PointRoom room;
    Vec3* const p = room.points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      p[i] = edges.Relative(points[i], x, y);
      in_front = in_front && p[i].z > 0;
    }
    if (!in_front) return std::nullopt;
    if (has_vertices || !first) odd ^= CrossesOdd(at, p[0]);
    first = false;
    at = p[segment.degree];
    odd ^= CrossesOdd(p, segment.degree, 0);
  }
  if (!has_vertices) return odd;
  const Vec3 last = vertex(1);
  if (!(last.z > 0)) return std::nullopt;
  return odd != CrossesOdd(at, last);
}

}  // namespace facetless
