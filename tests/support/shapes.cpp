#include "tests/support/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

namespace facetless::testing {
namespace {

using std::numbers::pi;

// A control point of a profile (radius, height, weight), in homogeneous form.
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

Model Finished(ModelBuilder builder) {
  Result<Model> model = std::move(builder).Finish();
  if (!model.ok()) throw std::invalid_argument(model.error().message);
  return std::move(model).value();
}

Model ModelOf(const std::vector<PatchGrid>& grids) {
  ModelBuilder builder;
  builder.AddPart("part");
  for (const PatchGrid& grid : grids) builder.AddFace(grid);
  builder.AddInstance({});
  return Finished(std::move(builder));
}

Model Squares(int faces) {
  std::vector<PatchGrid> grids;
  for (int i = 0; i < faces; ++i) grids.push_back(Rectangle({double(i), 0, 0}, {1, 0, 0}, {0, 1, 0}));
  return ModelOf(grids);
}

Model ClosedSolid(Model model, const std::string& name) {
  ModelBuilder builder(std::move(model));
  const std::uint32_t solid = builder.AddSolid(true, name);
  for (std::uint32_t f = 0; f < builder.model().faces.size(); ++f) builder.SetSolid(f, solid);
  return Finished(std::move(builder));
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

PatchGrid Roof() {
  PatchGrid grid;
  grid.u_spans = {{0, 1}, {1, 2}};
  grid.v_spans = {{0, 1}};
  for (const auto& [x, z] : {std::pair{-1.0, -5.0}, {0.0, 0.0}, {0.0, 0.0}, {1.0, -5.0}})
    for (const double y : {-1.0, 1.0}) grid.points.push_back({x, y, z, 1});
  return grid;
}

Model LooseBox(Vec3 size, double gap_mm, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto number = [&] { return double(engine() >> 11) * 0x1p-52 - 1; };
  // The offset is at most the gap.
  const auto off = [&] {
    const double x = number(), y = number(), z = number();
    return (gap_mm / 2) * Vec3{x, y, z};
  };
  const auto corner = [&](int i) { return Vec3{i & 1 ? size.x : 0, i & 2 ? size.y : 0, i & 4 ? size.z : 0}; };
  // Corners in the order of the patch's own border: (0,0), (1,0), (1,1), (0,1); Su × Sv points outwards.
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  ModelBuilder builder;
  builder.AddPart("part");
  builder.AddSolid(true, "box");
  for (int i = 0; i < 8; ++i) builder.AddVertex(corner(i) + off(), gap_mm);

  std::map<std::pair<int, int>, std::uint32_t> known;
  const auto edge_of = [&](int a, int b) {
    const auto [place, is_new] = known.try_emplace(std::minmax(a, b), 0);
    if (!is_new) return place->second;
    const Vec3 begin = corner(std::min(a, b)), end = corner(std::max(a, b));
    Edge edge;
    edge.vertices[0] = static_cast<std::uint32_t>(std::min(a, b));
    edge.vertices[1] = static_cast<std::uint32_t>(std::max(a, b));
    edge.tolerance_mm = gap_mm;
    place->second = builder.AddEdge(edge);
    std::vector<Vec4> points;
    for (const Vec3 p : {begin, 0.5 * (begin + end), end}) {
      const Vec3 at = p + off();
      points.push_back({at.x, at.y, at.z, 1});
    }
    builder.AddEdgeSegment(points);
    return place->second;
  };
  constexpr Vec3 kBorder[5] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, 0, 1}};
  for (const auto& f : kFaces) {
    Face face;
    face.solid = 0;
    builder.AddFace(Rectangle(corner(f[0]), corner(f[1]) - corner(f[0]), corner(f[3]) - corner(f[0])), face);
    builder.AddLoop();
    for (int i = 0; i < 4; ++i) {
      const int a = f[i], b = f[(i + 1) % 4];
      Coedge coedge;
      coedge.edge = edge_of(a, b);
      coedge.reversed = a > b;
      coedge.gap_mm = gap_mm;
      builder.AddCoedge(coedge);
      builder.AddTrimSegment({kBorder + i, 2}, coedge.reversed ? 1 : 0, coedge.reversed ? 0 : 1);
    }
  }
  builder.AddInstance({});
  return Finished(std::move(builder));
}

MeshPart SphereMesh(double radius, int longitudes, int latitudes) {
  MeshPart part;
  for (int j = 0; j <= latitudes; ++j)
    for (int i = 0; i <= longitudes; ++i) {
      const double u = 2 * pi * (i % longitudes) / longitudes;
      const double v = pi * (static_cast<double>(j) / latitudes - 0.5);
      const bool pole = j == 0 || j == latitudes;
      const Vec3 n = pole ? Vec3{0, 0, j == 0 ? -1.0 : 1.0}
                          : Vec3{std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)};
      part.normals.push_back({static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
      part.positions.push_back({static_cast<float>(radius * n.x), static_cast<float>(radius * n.y),
                                static_cast<float>(radius * n.z)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (longitudes + 1) + i); };
  for (int j = 0; j < latitudes; ++j)
    for (int i = 0; i < longitudes; ++i) {
      if (j > 0) part.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      if (j + 1 < latitudes) part.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  part.face_of_triangle.assign(part.triangles.size(), 0);
  return part;
}

Mesh BallMesh(double radius, int longitudes) {
  Mesh mesh;
  mesh.parts.push_back(SphereMesh(radius, longitudes, longitudes / 2));
  mesh.nodes.push_back({0, {}, 0});
  mesh.from_model = true;
  return mesh;
}

void Place(Model* model, const Placement& placement) {
  model->instances[0].placement = placement;
}

}  // namespace facetless::testing
