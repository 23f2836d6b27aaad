#include "render/model/walk.h"

#include <numeric>

namespace facetless {

double PolygonLength(const Model& model, const Edge& edge) {
  double length = 0;
  for (const EdgeSegment& segment : SegmentsOf(model, edge)) {
    const std::span<const Vec4> points = PointsOf(model, segment);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vec4 &a = points[i - 1], &b = points[i];
      length += Length(Vec3{b.x / b.w, b.y / b.w, b.z / b.w} - Vec3{a.x / a.w, a.y / a.w, a.z / a.w});
    }
  }
  return length;
}

EdgeUses::EdgeUses(const Model& model) : first_(model.edges.size() + 1, 0) {
  // Count the uses of each edge, at the position after the edge. The prefix sums of the counts are then the
  // positions where the uses of each edge begin.
  for (const Face& face : model.faces)
    for (const Coedge& coedge : CoedgesOf(model, face))
      if (coedge.edge != kNoIndex) ++first_[coedge.edge + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  // Store each use at the next free position of its edge.
  uses_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t f = 0; f < model.faces.size(); ++f)
    for (const Coedge& coedge : CoedgesOf(model, model.faces[f]))
      if (coedge.edge != kNoIndex) uses_[next[coedge.edge]++] = {f, IndexWithin(model.coedges, coedge)};
}

}  // namespace facetless
