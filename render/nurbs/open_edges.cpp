#include "render/nurbs/open_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "render/nurbs/monotone_curve.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {
namespace {

constexpr int kMaxPoints = 256;  // the degree is 8 bits wide
// Points per segment of a p-curve among which the widest place is sought.
constexpr int kPlaces = 10;

struct Use {
  std::uint32_t face, coedge;
};

Vec3 PointOf(const Model& model, const EdgeSegment& segment, double t) {
  Vec4 p[kMaxPoints];
  std::copy_n(model.edge_points.data() + segment.first_point, segment.degree + 1, p);
  for (int level = segment.degree; level > 0; --level)
    for (int i = 0; i < level; ++i) p[i] = (1 - t) * p[i] + t * p[i + 1];
  return {p[0].x / p[0].w, p[0].y / p[0].w, p[0].z / p[0].w};
}

Vec3 MiddleOf(const Model& model, const Edge& edge) {
  return PointOf(model, model.edge_segments[edge.segments.first + edge.segments.count / 2],
                 edge.segments.count % 2 ? 0.5 : 0);
}

double LengthOf(const Model& model, const Edge& edge) {
  double length = 0;
  for (std::uint32_t s = edge.segments.first; s < edge.segments.end(); ++s) {
    const EdgeSegment& segment = model.edge_segments[s];
    const auto point = [&](std::uint32_t i) {
      const Vec4& p = model.edge_points[segment.first_point + i];
      return Vec3{p.x / p.w, p.y / p.w, p.z / p.w};
    };
    for (std::uint32_t i = 0; i < segment.degree; ++i) length += Length(point(i + 1) - point(i));
  }
  return length;
}

// Of the points of the coedge's p-curve, on its surface, the one farthest from the edge near its parameter.
Vec3 WidestPlace(const Model& model, const Use& use) {
  const Coedge& coedge = model.coedges[use.coedge];
  const Edge& edge = model.edges[coedge.edge];
  const SurfaceEval surface(model, model.faces[use.face].surface);
  Vec3 widest = MiddleOf(model, edge);
  double most = -1;
  for (std::uint32_t s = coedge.segments.first; s < coedge.segments.end(); ++s) {
    const TrimSegment& segment = model.trim_segments[s];
    for (int i = 0; i <= kPlaces; ++i) {
      const double t = double(i) / kPlaces;
      const Vec2 uv = PointOn({model.trim_points.data() + segment.first_point, segment.degree}, t);
      const Vec3 point = surface.Position(uv.x, uv.y);
      // The nearest of the places around the same parameter.
      const double parameter = segment.edge_begin + t * (segment.edge_end - segment.edge_begin);
      double nearest = INFINITY;
      for (std::uint32_t k = edge.segments.first; k < edge.segments.end(); ++k) {
        const EdgeSegment& stretch = model.edge_segments[k];
        const double at = std::clamp((parameter - stretch.begin) / (stretch.end - stretch.begin), 0.0, 1.0);
        const Vec3 there = PointOf(model, stretch, at);
        // Across the edge's direction: parameters of p-curve and edge need not run alike.
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
  std::vector<std::vector<Use>> uses(model.edges.size());
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    const Face& face = model.faces[f];
    for (std::uint32_t l = face.loops.first; l < face.loops.end(); ++l) {
      const Range coedges = model.loops[l].coedges;
      for (std::uint32_t c = coedges.first; c < coedges.end(); ++c)
        if (const std::uint32_t e = model.coedges[c].edge; e != kNoIndex) uses[e].push_back({f, c});
    }
  }

  std::vector<OpenEdge> open;
  for (std::uint32_t e = 0; e < model.edges.size(); ++e) {
    const Edge& edge = model.edges[e];
    if (edge.segments.count == 0 || uses[e].empty()) continue;
    OpenEdge found{OpenCause::kGap,      e, {}, 0, edge.tolerance_mm, LengthOf(model, edge),
                   MiddleOf(model, edge)};
    const Use* widest = nullptr;
    int along = 0, against = 0;
    bool of_solid = false;
    for (const Use& use : uses[e]) {
      const Coedge& coedge = model.coedges[use.coedge];
      const Face& face = model.faces[use.face];
      ++(coedge.reversed != face.reversed ? against : along);
      of_solid = of_solid || face.solid != kNoIndex;
      found.faces.push_back(use.face);
      if (!widest || coedge.gap_mm > found.gap_mm) widest = &use, found.gap_mm = coedge.gap_mm;
    }
    found.faces.erase(std::unique(found.faces.begin(), found.faces.end()), found.faces.end());
    // Solids that share an edge use it twice each.
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
