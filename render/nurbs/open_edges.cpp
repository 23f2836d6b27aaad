#include "render/nurbs/open_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "render/model/walk.h"
#include "render/nurbs/monotone_curve.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {
namespace {

constexpr int kMaxPoints = 256;  // the degree is 8 bits wide
// The number of points per segment of a p-curve among which the widest gap is searched.
constexpr int kPlaces = 10;

Vec3 PointOf(const Model& model, const EdgeSegment& segment, double t) {
  Vec4 p[kMaxPoints];
  std::ranges::copy(PointsOf(model, segment), p);
  for (int level = segment.degree; level > 0; --level)
    for (int i = 0; i < level; ++i) p[i] = (1 - t) * p[i] + t * p[i + 1];
  return {p[0].x / p[0].w, p[0].y / p[0].w, p[0].z / p[0].w};
}

Vec3 MiddleOf(const Model& model, const Edge& edge) {
  const std::span<const EdgeSegment> segments = SegmentsOf(model, edge);
  return PointOf(model, segments[segments.size() / 2], segments.size() % 2 ? 0.5 : 0);
}

// The point of the coedge's p-curve, on the surface, that is farthest from the edge near the same parameter.
Vec3 WidestPlace(const Model& model, const EdgeUse& use) {
  const Coedge& coedge = model.coedges[use.coedge];
  const Edge& edge = model.edges[coedge.edge];
  const SurfaceEval surface(model, model.faces[use.face].surface);
  Vec3 widest = MiddleOf(model, edge);
  double most = -1;
  for (const TrimSegment& segment : SegmentsOf(model, coedge)) {
    for (int i = 0; i <= kPlaces; ++i) {
      const double t = double(i) / kPlaces;
      const Vec2 uv = PointOn({PointsOf(model, segment).data(), segment.degree}, t);
      const Vec3 point = surface.Position(uv.x, uv.y);
      // Take the nearest of the points around the same parameter.
      const double parameter = segment.edge_begin + t * (segment.edge_end - segment.edge_begin);
      double nearest = INFINITY;
      for (const EdgeSegment& stretch : SegmentsOf(model, edge)) {
        const double at = std::clamp((parameter - stretch.begin) / (stretch.end - stretch.begin), 0.0, 1.0);
        const Vec3 there = PointOf(model, stretch, at);
        // Measure perpendicular to the edge, because the parametrisations of p-curve and edge may differ.
        constexpr double kStep = 1e-4;
        const double other = at < 0.5 ? at + kStep : at - kStep;
        const Vec3 along = Normalized(PointOf(model, stretch, other) - there), offset = point - there;
        nearest = std::min(nearest, Length(offset - Dot(offset, along) * along));
      }
      if (!(nearest > most) || !std::isfinite(nearest)) continue;
      most = nearest;
      widest = point;
    }
  }
  return widest;
}

}  // namespace

const char* OpenCauseName(OpenCause cause) {
  switch (cause) {
    case OpenCause::kUsedOnce:
      return "used_once";
    case OpenCause::kUsedOften:
      return "used_often";
    case OpenCause::kSameSense:
      return "same_sense";
    case OpenCause::kGap:
      break;
  }
  return "gap";
}

std::vector<OpenEdge> FindOpenEdges(const Model& model) {
  const EdgeUses uses(model);
  std::vector<OpenEdge> open;
  for (std::uint32_t e = 0; e < model.edges.size(); ++e) {
    const Edge& edge = model.edges[e];
    if (edge.segments.count == 0 || uses[e].empty()) continue;
    OpenEdge found{OpenCause::kGap,      e, {}, 0, edge.tolerance_mm, PolygonLength(model, edge),
                   MiddleOf(model, edge)};
    const EdgeUse* widest = nullptr;
    int along = 0, against = 0;
    bool of_solid = false;
    for (const EdgeUse& use : uses[e]) {
      const Coedge& coedge = model.coedges[use.coedge];
      const Face& face = model.faces[use.face];
      ++(coedge.reversed != face.reversed ? against : along);
      of_solid = of_solid || face.solid != kNoIndex;
      found.faces.push_back(use.face);
      if (!widest || coedge.gap_mm > found.gap_mm) widest = &use, found.gap_mm = coedge.gap_mm;
    }
    found.faces.erase(std::unique(found.faces.begin(), found.faces.end()), found.faces.end());
    // If several solids share an edge, each uses it twice.
    const bool paired = along == against;
    if (of_solid && !paired) {
      found.cause = along + against == 1   ? OpenCause::kUsedOnce
                    : along + against == 2 ? OpenCause::kSameSense
                                           : OpenCause::kUsedOften;
    } else if (found.gap_mm > edge.tolerance_mm) {
      found.at = WidestPlace(model, *widest);
    } else {
      continue;
    }
    open.push_back(std::move(found));
  }
  std::sort(open.begin(), open.end(), [](const OpenEdge& a, const OpenEdge& b) {
    const bool hole_a = a.cause != OpenCause::kGap, hole_b = b.cause != OpenCause::kGap;
    if (hole_a != hole_b) return hole_a;
    const double size_a = hole_a ? a.length_mm : a.gap_mm, size_b = hole_a ? b.length_mm : b.gap_mm;
    return std::tie(size_b, a.edge) < std::tie(size_a, b.edge);
  });
  return open;
}

}  // namespace facetless
