#include "tests/support/shapes.h"

#include <cmath>
#include <numbers>

namespace facetless::testing {
namespace {

using std::numbers::pi;

// A profile (radius, height, weight) per control point, in homogeneous form.
struct ProfilePoint {
  double wr, wz, w;
};

// Arcs of a circle as homogeneous (cos, sin, weight) triples: three per span, spans of 90°.
struct Arc {
  double c[3], s[3], w[3];
};

Arc MakeArc(double begin, double end) {
  const double middle = 0.5 * (begin + end), half = 0.5 * (end - begin);
  return {{std::cos(begin), std::cos(middle), std::cos(end)},
          {std::sin(begin), std::sin(middle), std::sin(end)},
          {1, std::cos(half), 1}};
}

std::vector<Span> AngleSpans(double begin, double end, int count) {
  std::vector<Span> spans;
  for (int i = 0; i < count; ++i) {
    spans.push_back(
        {begin + (end - begin) * i / count, begin + (end - begin) * (i + 1) / count, SpanMap::kHalfAngle});
  }
  return spans;
}

// Revolves profile spans (all of one degree) about the vertical through `center`.
PatchGrid Revolve(SurfaceKind kind, Vec3 center, const std::vector<std::vector<ProfilePoint>>& profile,
                  const std::vector<Span>& v_spans) {
  PatchGrid grid{kind, 2, static_cast<int>(profile[0].size()) - 1, AngleSpans(0, 2 * pi, 4), v_spans, {}};
  for (const Span& u : grid.u_spans) {
    const Arc arc = MakeArc(u.begin, u.end);
    for (const auto& span : profile) {
      for (int k = 0; k < 3; ++k) {
        for (const ProfilePoint& p : span) {
          const double w = arc.w[k] * p.w;
          grid.points.push_back({arc.c[k] * p.wr + w * center.x, arc.s[k] * p.wr + w * center.y,
                                 arc.w[k] * p.wz + w * center.z, w});
        }
      }
    }
  }
  return grid;
}

}  // namespace

Model ModelOf(const std::vector<PatchGrid>& grids) {
  Model model;
  for (const PatchGrid& grid : grids) {
    Surface surface;
    surface.kind = grid.kind;
    surface.degree_u = static_cast<std::uint8_t>(grid.degree_u);
    surface.degree_v = static_cast<std::uint8_t>(grid.degree_v);
    for (const Vec4& p : grid.points) {
      surface.rational = surface.rational || p.w != 1;
      model.bounds.Add({p.x / p.w, p.y / p.w, p.z / p.w});
    }
    surface.u_spans = {static_cast<std::uint32_t>(model.spans.size()),
                       static_cast<std::uint32_t>(grid.u_spans.size())};
    model.spans.insert(model.spans.end(), grid.u_spans.begin(), grid.u_spans.end());
    surface.v_spans = {static_cast<std::uint32_t>(model.spans.size()),
                       static_cast<std::uint32_t>(grid.v_spans.size())};
    model.spans.insert(model.spans.end(), grid.v_spans.begin(), grid.v_spans.end());
    surface.first_control_point = static_cast<std::uint32_t>(model.control_points.size());
    model.control_points.insert(model.control_points.end(), grid.points.begin(), grid.points.end());
    Face face;
    face.surface = static_cast<std::uint32_t>(model.surfaces.size());
    model.surfaces.push_back(surface);
    model.faces.push_back(face);
  }
  model.parts.push_back({"part", {0, static_cast<std::uint32_t>(grids.size())}, {}});
  model.instances.push_back({});
  return model;
}

PatchGrid Sphere(Vec3 center, double radius) {
  std::vector<std::vector<ProfilePoint>> profile;
  const std::vector<Span> spans = AngleSpans(-pi / 2, pi / 2, 2);
  for (const Span& v : spans) {
    const Arc arc = MakeArc(v.begin, v.end);
    profile.emplace_back();
    for (int k = 0; k < 3; ++k) profile.back().push_back({radius * arc.c[k], radius * arc.s[k], arc.w[k]});
  }
  // The poles are exact: cos(±π/2) is not quite 0 in floating point.
  profile.front().front().wr = profile.back().back().wr = 0;
  return Revolve(SurfaceKind::kSphere, center, profile, spans);
}

PatchGrid Torus(Vec3 center, double major, double minor) {
  std::vector<std::vector<ProfilePoint>> profile;
  const std::vector<Span> spans = AngleSpans(0, 2 * pi, 4);
  for (const Span& v : spans) {
    const Arc arc = MakeArc(v.begin, v.end);
    profile.emplace_back();
    for (int k = 0; k < 3; ++k)
      profile.back().push_back({major * arc.w[k] + minor * arc.c[k], minor * arc.s[k], arc.w[k]});
  }
  return Revolve(SurfaceKind::kTorus, center, profile, spans);
}

PatchGrid Frustum(Vec3 base, double bottom, double top, double height) {
  return Revolve(SurfaceKind::kCone, base, {{{bottom, 0, 1}, {top, height, 1}}},
                 {{0, height, SpanMap::kLinear}});
}

PatchGrid Rectangle(Vec3 origin, Vec3 a, Vec3 b) {
  const auto point = [](Vec3 p) { return Vec4{p.x, p.y, p.z, 1}; };
  return {SurfaceKind::kPlane,
          1,
          1,
          {Span{}},
          {Span{}},
          {point(origin), point(origin + b), point(origin + a), point(origin + a + b)}};
}

void Place(Model* model, const Placement& placement) {
  model->instances[0].placement = placement;
}

}  // namespace facetless::testing
