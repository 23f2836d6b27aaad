#include "tests/unit/nurbs/trim_models.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/nurbs/monotone_curve.h"
#include "tests/support/shapes.h"

namespace facetless::trim_models {
namespace {

constexpr double kPi = 3.14159265358979323846;

Curve ReversedCurve(Curve curve) {
  std::reverse(curve.begin(), curve.end());
  return curve;
}

}  // namespace

Curve Line(Vec2 a, Vec2 b) {
  return {{a.x, a.y, 1}, {b.x, b.y, 1}};
}

Outline Polygon(const std::vector<Vec2>& corners) {
  Outline outline;
  for (std::size_t i = 0; i < corners.size(); ++i)
    outline.push_back({Line(corners[i], corners[(i + 1) % corners.size()])});
  return outline;
}

Outline Circle(Vec2 center, double radius) {
  const double w = std::sqrt(0.5);
  const auto point = [&](double x, double y, double weight) {
    return Vec3{weight * (center.x + radius * x), weight * (center.y + radius * y), weight};
  };
  return {{{point(1, 0, 1), point(1, 1, w), point(0, 1, 1)},
           {point(0, 1, 1), point(-1, 1, w), point(-1, 0, 1)},
           {point(-1, 0, 1), point(-1, -1, w), point(0, -1, 1)},
           {point(0, -1, 1), point(1, -1, w), point(1, 0, 1)}}};
}

Outline Reversed(const Outline& outline) {
  Outline result;
  for (auto chain = outline.rbegin(); chain != outline.rend(); ++chain) {
    result.emplace_back();
    for (auto curve = chain->rbegin(); curve != chain->rend(); ++curve)
      result.back().push_back(ReversedCurve(*curve));
  }
  return result;
}

Model PlaneModel(double u0, double u1, double v0, double v1) {
  return testing::ModelOf({{SurfaceKind::kPlane,
                            1,
                            1,
                            {{u0, u1}},
                            {{v0, v1}},
                            {{u0, v0, 0, 1}, {u0, v1, 0, 1}, {u1, v0, 0, 1}, {u1, v1, 0, 1}}}});
}

Model HalfCylinderModel(double radius, double height) {
  SurfaceGrid grid{SurfaceKind::kCylinder, 2, 1, {}, {{0, height}}, {}};
  grid.u_spans = {{0, kPi / 2, SpanMap::kHalfAngle}, {kPi / 2, kPi, SpanMap::kHalfAngle}};
  const double w = std::sqrt(0.5);
  const Vec3 arcs[2][3] = {{{1, 0, 1}, {w, w, w}, {0, 1, 1}}, {{0, 1, 1}, {-w, w, w}, {-1, 0, 1}}};
  for (const auto& arc : arcs)
    for (const Vec3& p : arc)
      for (double z : {0.0, height}) grid.points.push_back({radius * p.x, radius * p.y, p.z * z, p.z});
  return testing::ModelOf({grid});
}

Model SphereModel() {
  SurfaceGrid grid{SurfaceKind::kSphere, 2, 2, {}, {}, {}};
  grid.period_u = 2 * kPi;
  for (int i = 0; i < 4; ++i) grid.u_spans.push_back({i * kPi / 2, (i + 1) * kPi / 2, SpanMap::kHalfAngle});
  for (int i = -1; i < 1; ++i) grid.v_spans.push_back({i * kPi / 2, (i + 1) * kPi / 2, SpanMap::kHalfAngle});
  // A quarter of a circle in the plane, rotated four times; a meridian in two quarters.
  const double w = std::sqrt(0.5);
  const Vec3 turns[4][3] = {{{1, 0, 1}, {w, w, w}, {0, 1, 1}},
                            {{0, 1, 1}, {-w, w, w}, {-1, 0, 1}},
                            {{-1, 0, 1}, {-w, -w, w}, {0, -1, 1}},
                            {{0, -1, 1}, {w, -w, w}, {1, 0, 1}}};
  const Vec3 meridian[2][3] = {{{0, -1, 1}, {w, -w, w}, {1, 0, 1}}, {{1, 0, 1}, {w, w, w}, {0, 1, 1}}};
  for (const auto& turn : turns)
    for (const auto& quarter : meridian)
      for (const Vec3& t : turn)
        for (const Vec3& m : quarter) grid.points.push_back({t.x * m.x, t.y * m.x, t.z * m.y, t.z * m.z});
  ModelBuilder builder;
  builder.AddPart("part");
  builder.AddFace(grid);
  builder.AddInstance({});

  // The seam is used twice, and there are two poles.
  Edge pole;
  pole.degenerate = true;
  const std::uint32_t seam = builder.AddEdge({});
  for (int q = 0; q < 2; ++q) {
    std::vector<Vec4> points;
    for (const Vec3& m : meridian[q]) points.push_back({m.x, 0, m.y, m.z});
    builder.AddEdgeSegment(points, q, q + 1);
  }
  const std::uint32_t south = builder.AddEdge(pole), north = builder.AddEdge(pole);
  const Vec2 corners[5] = {
      {0, -kPi / 2}, {2 * kPi, -kPi / 2}, {2 * kPi, kPi / 2}, {0, kPi / 2}, {0, -kPi / 2}};
  const std::uint32_t edges[4] = {south, seam, north, seam};
  builder.AddLoop();
  for (int i = 0; i < 4; ++i) {
    // The edge and the p-curve agree at the ends and in the middle: each coedge of the seam has the edge's
    // two segments.
    Coedge coedge;
    coedge.edge = edges[i];
    coedge.reversed = i == 3;
    builder.AddCoedge(coedge);
    const bool on_seam = edges[i] == seam;
    const int pieces = on_seam ? 2 : 1;
    for (int k = 0; k < pieces; ++k) {
      const Vec2 a = corners[i] + (double(k) / pieces) * (corners[i + 1] - corners[i]);
      const Vec2 b = corners[i] + (double(k + 1) / pieces) * (corners[i + 1] - corners[i]);
      const double from = on_seam ? (i == 3 ? 2 - k : k) : 0, to = on_seam ? (i == 3 ? 1 - k : k + 1) : 0;
      builder.AddTrimSegment(Line(a, b), from, to);
    }
  }
  return testing::Finished(std::move(builder));
}

void AddLoop(Model& model, const Outline& outline, double gap_mm) {
  ModelBuilder builder(std::move(model));
  builder.AddLoop();
  for (const Chain& chain : outline) {
    Coedge coedge;
    coedge.edge = builder.AddEdge({});
    coedge.gap_mm = gap_mm;
    builder.AddCoedge(coedge);
    double parameter = 0;
    for (const Curve& curve : chain) {
      std::vector<Vec4> points;
      for (const Vec3& p : curve) points.push_back({p.x, p.y, 0, p.z});
      builder.AddTrimSegment(curve, parameter, parameter + 1);
      builder.AddEdgeSegment(points, parameter, parameter + 1);
      parameter += 1;
    }
  }
  model = testing::Finished(std::move(builder));
}

void AddOpenLoop(Model& model, const Outline& outline, double gap_mm) {
  // Add the loop with every curve starting at the end of the previous one, and then restore the given starts.
  Outline closed = outline;
  Vec3 before = outline.back().back().back();
  for (Chain& chain : closed) {
    for (Curve& curve : chain) {
      curve.front() = before;
      before = curve.back();
    }
  }
  std::size_t trim_point = model.trim_points.size(), edge_point = model.edge_points.size();
  AddLoop(model, closed, gap_mm);
  for (const Chain& chain : outline) {
    for (const Curve& curve : chain) {
      for (const Vec3& p : curve) {
        model.trim_points[trim_point++] = p;
        model.edge_points[edge_point++] = {p.x, p.y, 0, p.z};
      }
    }
  }
}

Sampled::Sampled(const std::vector<Outline>& loops, int points_per_segment) {
  for (const Outline& outline : loops) {
    std::vector<Vec2>& polygon = polygons_.emplace_back();
    for (const Chain& chain : outline)
      for (const Curve& curve : chain) {
        const int n = curve.size() == 2 ? 1 : points_per_segment;
        for (int i = 0; i < n; ++i)
          polygon.push_back(PointOn({curve.data(), static_cast<int>(curve.size()) - 1}, double(i) / n));
      }
  }
}

bool Sampled::Inside(Vec2 q) const {
  bool inside = false;
  for (const auto& polygon : polygons_)
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 a = polygon[i], b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
      if ((a.y <= q.y) != (b.y <= q.y) && q.x < a.x + (q.y - a.y) / (b.y - a.y) * (b.x - a.x))
        inside = !inside;
    }
  return inside;
}

double Sampled::Distance(Vec2 q) const {
  double distance = INFINITY;
  for (const auto& polygon : polygons_)
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 a = polygon[i], b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
      const double length = Dot(b - a, b - a);
      const double t = length > 0 ? std::clamp(Dot(q - a, b - a) / length, 0.0, 1.0) : 0;
      distance = std::min(distance, Length(q - a - t * (b - a)));
    }
  return distance;
}

}  // namespace facetless::trim_models
