// Valid models of random structure, for tests that count and compare relations between elements.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/shapes.h"

namespace facetless::testing {

// Returns up to four parts, some of them empty, with up to five faces of up to three loops each. Coedges
// share random edges, and some have none.
inline Model RandomStructure(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(engine() % n); };
  ModelBuilder builder;
  std::vector<std::uint32_t> edges;
  for (std::uint32_t e = 0, count = 1 + below(9); e < count; ++e) {
    Edge edge;
    for (std::uint32_t& vertex : edge.vertices) vertex = builder.AddVertex({double(e), 0, 0}, 0.125);
    const std::uint32_t segments = below(4);
    edge.degenerate = segments == 0;
    edges.push_back(builder.AddEdge(edge));
    for (std::uint32_t s = 0; s < segments; ++s) {
      std::vector<Vec4> points;
      for (std::uint32_t i = 0, n = 2 + below(4); i < n; ++i) points.push_back({double(s), double(i), 0, 1});
      builder.AddEdgeSegment(points, s, s + 1);
    }
  }
  const std::uint32_t parts = 1 + below(4);
  for (std::uint32_t p = 0; p < parts; ++p) {
    builder.AddPart("part " + std::to_string(p));
    for (std::uint32_t s = below(3); s > 0; --s) builder.AddSolid(below(2) == 0);
    for (std::uint32_t f = below(6); f > 0; --f) {
      PatchGrid grid{SurfaceKind::kBspline, 1 + int(below(3)), 1 + int(below(3)), {}, {}, {}};
      for (std::uint32_t i = 0, n = 1 + below(3); i < n; ++i) grid.u_spans.push_back({double(i), i + 1.0});
      for (std::uint32_t i = 0, n = 1 + below(3); i < n; ++i) grid.v_spans.push_back({double(i), i + 1.0});
      const std::size_t count =
          grid.u_spans.size() * grid.v_spans.size() * (grid.degree_u + 1u) * (grid.degree_v + 1u);
      for (std::size_t i = 0; i < count; ++i)
        grid.points.push_back({double(below(100)), double(below(100)), double(below(100)), 1});
      builder.AddFace(grid);
      for (std::uint32_t l = below(4); l > 0; --l) {
        builder.AddLoop();
        // A polygon; some of its corners lie within a coedge.
        const std::uint32_t corners = 3 + below(4);
        const auto corner = [&](std::uint32_t i) {
          return Vec3{double(i % corners), double(i % corners % 2), 1};
        };
        for (std::uint32_t i = 0; i < corners; ++i) {
          if (i == 0 || below(3) > 0) {
            Coedge coedge;
            if (below(4) > 0) coedge.edge = edges[below(static_cast<std::uint32_t>(edges.size()))];
            coedge.reversed = below(2) == 0;
            coedge.gap_mm = 0.25 * below(8);
            builder.AddCoedge(coedge);
          }
          builder.AddTrimSegment(std::vector<Vec3>{corner(i), corner(i + 1)}, i, i + 1);
        }
      }
    }
  }
  for (std::uint32_t i = below(6); i > 0; --i) {
    Instance instance;
    instance.part = below(parts);
    instance.placement.m[0][3] = i;
    builder.AddInstance(instance);
  }
  return Finished(std::move(builder));
}

}  // namespace facetless::testing
