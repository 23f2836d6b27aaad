#include "tests/unit/nurbs/trim_models.h"

#include <algorithm>
#include <cmath>

#include "render/nurbs/monotone_curve.h"

namespace facetless::trim_models {
namespace {

constexpr double kPi = 3.14159265358979323846;

Model OneFace(Surface surface) {
  Model model;
  model.surfaces.push_back(surface);
  model.faces.emplace_back();
  Part part;
  part.faces = {0, 1};
  model.parts.push_back(part);
  model.instances.emplace_back();
  return model;
}

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
  Surface surface;
  surface.kind = SurfaceKind::kPlane;
  surface.u_spans = {0, 1};
  surface.v_spans = {1, 1};
  Model model = OneFace(surface);
  model.spans = {{u0, u1, SpanMap::kLinear}, {v0, v1, SpanMap::kLinear}};
  model.control_points = {{u0, v0, 0, 1}, {u0, v1, 0, 1}, {u1, v0, 0, 1}, {u1, v1, 0, 1}};
  return model;
}

Model HalfCylinderModel(double radius, double height) {
  Surface surface;
  surface.kind = SurfaceKind::kCylinder;
  surface.degree_u = 2;
  surface.rational = true;
  surface.u_spans = {0, 2};
  surface.v_spans = {2, 1};
  Model model = OneFace(surface);
  model.spans = {
      {0, kPi / 2, SpanMap::kHalfAngle}, {kPi / 2, kPi, SpanMap::kHalfAngle}, {0, height, SpanMap::kLinear}};
  const double w = std::sqrt(0.5);
  const Vec3 arcs[2][3] = {{{1, 0, 1}, {w, w, w}, {0, 1, 1}}, {{0, 1, 1}, {-w, w, w}, {-1, 0, 1}}};
  for (const auto& arc : arcs)
    for (const Vec3& p : arc)
      for (double z : {0.0, height})
        model.control_points.push_back({radius * p.x, radius * p.y, p.z * z, p.z});
  return model;
}

Model SphereModel() {
  Surface surface;
  surface.kind = SurfaceKind::kSphere;
  surface.degree_u = surface.degree_v = 2;
  surface.rational = true;
  surface.u_spans = {0, 4};
  surface.v_spans = {4, 2};
  surface.period_u = 2 * kPi;
  Model model = OneFace(surface);
  for (int i = 0; i < 4; ++i) model.spans.push_back({i * kPi / 2, (i + 1) * kPi / 2, SpanMap::kHalfAngle});
  for (int i = -1; i < 1; ++i) model.spans.push_back({i * kPi / 2, (i + 1) * kPi / 2, SpanMap::kHalfAngle});
  // A quarter of a circle in the plane, turned four times; a meridian in two quarters.
  const double w = std::sqrt(0.5);
  const Vec3 turns[4][3] = {{{1, 0, 1}, {w, w, w}, {0, 1, 1}},
                            {{0, 1, 1}, {-w, w, w}, {-1, 0, 1}},
                            {{-1, 0, 1}, {-w, -w, w}, {0, -1, 1}},
                            {{0, -1, 1}, {w, -w, w}, {1, 0, 1}}};
  const Vec3 meridian[2][3] = {{{0, -1, 1}, {w, -w, w}, {1, 0, 1}}, {{1, 0, 1}, {w, w, w}, {0, 1, 1}}};
  for (const auto& turn : turns)
    for (const auto& quarter : meridian)
      for (const Vec3& t : turn)
        for (const Vec3& m : quarter)
          model.control_points.push_back({t.x * m.x, t.y * m.x, t.z * m.y, t.z * m.z});

  // The seam, twice, and the two poles.
  Edge seam, pole;
  seam.segments = {0, 2};
  pole.degenerate = true;
  model.edges = {seam, pole, pole};
  for (int q = 0; q < 2; ++q) {
    model.edge_segments.push_back({2, static_cast<std::uint32_t>(3 * q), double(q), double(q + 1)});
    for (const Vec3& m : meridian[q]) model.edge_points.push_back({m.x, 0, m.y, m.z});
  }
  const Vec2 corners[5] = {
      {0, -kPi / 2}, {2 * kPi, -kPi / 2}, {2 * kPi, kPi / 2}, {0, kPi / 2}, {0, -kPi / 2}};
  const std::uint32_t edges[4] = {1, 0, 2, 0};
  for (std::uint32_t i = 0; i < 4; ++i) {
    // Edge and p-curve agree at the ends and in the middle: each coedge of the seam has the edge's two
    // segments.
    Coedge coedge;
    coedge.edge = edges[i];
    coedge.reversed = i == 3;
    coedge.segments.first = static_cast<std::uint32_t>(model.trim_segments.size());
    const bool on_seam = edges[i] == 0;
    const int pieces = on_seam ? 2 : 1;
    for (int k = 0; k < pieces; ++k) {
      const Vec2 a = corners[i] + (double(k) / pieces) * (corners[i + 1] - corners[i]);
      const Vec2 b = corners[i] + (double(k + 1) / pieces) * (corners[i + 1] - corners[i]);
      const double from = on_seam ? (i == 3 ? 2 - k : k) : 0, to = on_seam ? (i == 3 ? 1 - k : k + 1) : 0;
      model.trim_segments.push_back({1, static_cast<std::uint32_t>(model.trim_points.size()), from, to});
      for (Vec3 p : Line(a, b)) model.trim_points.push_back(p);
    }
    coedge.segments.count = static_cast<std::uint32_t>(pieces);
    model.coedges.push_back(coedge);
  }
  model.loops.push_back({{0, 4}});
  model.faces[0].loops = {0, 1};
  return model;
}

void AddLoop(Model& model, const Outline& outline, double gap_mm) {
  Loop loop;
  loop.coedges = {static_cast<std::uint32_t>(model.coedges.size()),
                  static_cast<std::uint32_t>(outline.size())};
  for (const Chain& chain : outline) {
    Coedge coedge;
    coedge.edge = static_cast<std::uint32_t>(model.edges.size());
    coedge.gap_mm = gap_mm;
    coedge.segments = {static_cast<std::uint32_t>(model.trim_segments.size()),
                       static_cast<std::uint32_t>(chain.size())};
    Edge edge;
    edge.segments = {static_cast<std::uint32_t>(model.edge_segments.size()),
                     static_cast<std::uint32_t>(chain.size())};
    double parameter = 0;
    for (const Curve& curve : chain) {
      const auto degree = static_cast<std::uint8_t>(curve.size() - 1);
      model.trim_segments.push_back(
          {degree, static_cast<std::uint32_t>(model.trim_points.size()), parameter, parameter + 1});
      model.edge_segments.push_back(
          {degree, static_cast<std::uint32_t>(model.edge_points.size()), parameter, parameter + 1});
      for (Vec3 p : curve) {
        model.trim_points.push_back(p);
        model.edge_points.push_back({p.x, p.y, 0, p.z});
      }
      parameter += 1;
    }
    model.coedges.push_back(coedge);
    model.edges.push_back(edge);
  }
  if (model.faces[0].loops.count == 0)
    model.faces[0].loops.first = static_cast<std::uint32_t>(model.loops.size());
  ++model.faces[0].loops.count;
  model.loops.push_back(loop);
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
