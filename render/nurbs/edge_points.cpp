#include "render/nurbs/edge_points.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/model/walk.h"
#include "render/nurbs/monotone_curve.h"

namespace facetless {

const EdgeSegment& SegmentAt(const Model& model, const Edge& edge, double parameter) {
  const std::span<const EdgeSegment> segments = SegmentsOf(model, edge);
  std::size_t s = 0;
  while (s + 1 < segments.size() && segments[s].end < parameter) ++s;
  return segments[s];
}

EdgePoint EvaluateEdge(const Model& model, const Edge& edge, double parameter) {
  const EdgeSegment& segment = SegmentAt(model, edge, parameter);
  const double t = std::clamp((parameter - segment.begin) / (segment.end - segment.begin), 0.0, 1.0);
  const std::span<const Vec4> points = PointsOf(model, segment);
  std::vector<Vec4> p(points.begin(), points.end());
  for (int last = segment.degree; last > 1; --last)
    for (int i = 0; i < last; ++i) p[i] = (1 - t) * p[i] + t * p[i + 1];
  const Vec4 h = (1 - t) * p[0] + t * p[1], d = p[1] - p[0];
  const Vec3 position{h.x / h.w, h.y / h.w, h.z / h.w};
  return {position, Normalized(Vec3{d.x, d.y, d.z} - d.w * position)};
}

Vec2 EvaluateCoedge(const Model& model, const Coedge& coedge, double parameter) {
  double best = INFINITY;
  Vec2 point;
  for (const TrimSegment& segment : SegmentsOf(model, coedge)) {
    if (!(best > 0)) break;
    // P-curves of real files have segments of zero length, which correspond to a single parameter.
    const double width = segment.edge_end - segment.edge_begin;
    const double inside = width != 0 ? std::clamp((parameter - segment.edge_begin) / width, 0.0, 1.0) : 0.5;
    const double off = std::fabs(parameter - (segment.edge_begin + inside * width));
    if (!(off < best)) continue;
    best = off;
    point = PointOn({PointsOf(model, segment).data(), segment.degree}, inside);
  }
  return point;
}

}  // namespace facetless
