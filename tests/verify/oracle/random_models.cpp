#include "tests/verify/oracle/random_models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "render/model/walk.h"
#include "tests/support/shapes.h"

namespace facetless::oracle {
namespace {

struct KnotLine {
  std::vector<double> knots;   // clamped
  std::vector<double> breaks;  // the distinct knots
};

KnotLine RandomKnots(int degree, int spans, Random& random) {
  KnotLine line;
  double at = random.Uniform(-5, 5);
  for (int span = 0; span <= spans; ++span) {
    const bool inside = span > 0 && span < spans;
    const int multiplicity =
        inside ? 1 + static_cast<int>(random.Below(static_cast<std::uint32_t>(degree))) : degree + 1;
    line.knots.insert(line.knots.end(), static_cast<std::size_t>(multiplicity), at);
    line.breaks.push_back(at);
    at += random.Uniform(0.2, 2);
  }
  return line;
}

// Inserts interior knots (W. Boehm) until each has the multiplicity of the degree.
std::vector<Vec4> ToBezier(std::vector<Vec4> points, KnotLine line, int degree) {
  std::vector<double>& knots = line.knots;
  for (std::size_t b = 1; b + 1 < line.breaks.size(); ++b) {
    const double knot = line.breaks[b];
    while (std::count(knots.begin(), knots.end(), knot) < degree) {
      // knots[k] <= knot < knots[k + 1].
      const auto above = std::upper_bound(knots.begin(), knots.end(), knot);
      const std::size_t k = static_cast<std::size_t>(above - knots.begin()) - 1,
                        p = static_cast<std::size_t>(degree);
      std::vector<Vec4> inserted;
      for (std::size_t i = 0; i <= points.size(); ++i) {
        if (i + p <= k) {
          inserted.push_back(points[i]);
        } else if (i > k) {
          inserted.push_back(points[i - 1]);
        } else {
          const double share = std::clamp((knot - knots[i]) / (knots[i + p] - knots[i]), 0.0, 1.0);
          inserted.push_back((1 - share) * points[i - 1] + share * points[i]);
        }
      }
      points = std::move(inserted);
      knots.insert(knots.begin() + static_cast<std::ptrdiff_t>(k) + 1, knot);
    }
  }
  return points;
}

std::vector<Span> SpansBetween(const std::vector<double>& breaks) {
  std::vector<Span> spans;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) spans.push_back({breaks[i], breaks[i + 1]});
  return spans;
}

}  // namespace

Model RandomSurface(const SurfaceRecipe& recipe) {
  Random random(recipe.seed);
  const int n = recipe.degree_u, m = recipe.degree_v;
  const KnotLine u = RandomKnots(n, recipe.spans_u, random), v = RandomKnots(m, recipe.spans_v, random);
  const std::size_t rows = u.knots.size() - static_cast<std::size_t>(n) - 1,
                    columns = v.knots.size() - static_cast<std::size_t>(m) - 1;
  // Make the B-spline's net, and convert it to Bézier form along v, then along u.
  constexpr double kSide = 10;
  std::vector<std::vector<Vec4>> net(rows);
  const double log_spread = std::log(recipe.weight_spread);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const auto off = [&] { return kSide * recipe.bump * random.Uniform(-1, 1); };
      const double x =
          kSide * static_cast<double>(i) / static_cast<double>(rows - 1) + off() / static_cast<double>(rows);
      const double y = kSide * static_cast<double>(j) / static_cast<double>(columns - 1) +
                       off() / static_cast<double>(columns);
      const double z = off();
      const double w = recipe.weight_spread > 1 ? std::exp(log_spread * random.Uniform(-1, 1)) : 1;
      net[i].push_back({w * x, w * y, w * z, w});
    }
    net[i] = ToBezier(net[i], v, m);
  }
  std::vector<std::vector<Vec4>> lines;  // along u
  for (std::size_t j = 0; j < net[0].size(); ++j) {
    std::vector<Vec4> line;
    for (std::size_t i = 0; i < rows; ++i) line.push_back(net[i][j]);
    lines.push_back(ToBezier(line, u, n));
  }
  SurfaceGrid grid{SurfaceKind::kBspline, n, m, SpansBetween(u.breaks), SpansBetween(v.breaks), {}};
  grid.rational = recipe.weight_spread > 1;
  for (int a = 0; a < recipe.spans_u; ++a) {
    for (int b = 0; b < recipe.spans_v; ++b) {
      for (int k = 0; k <= n; ++k) {
        for (int l = 0; l <= m; ++l) {
          Vec4 p = lines[static_cast<std::size_t>(b * m + l)][static_cast<std::size_t>(a * n + k)];
          if (!grid.rational) p.w = 1;  // the mean of ones may be rounded
          grid.points.push_back(p);
        }
      }
    }
  }
  return testing::ModelOf({grid});
}

void AddRandomLoop(Model& model, int corners, double radius, bool clockwise, std::uint64_t seed) {
  Random random(seed);
  const Surface& surface = model.surfaces[model.faces[0].surface];
  const auto u_spans = USpansOf(model, surface), v_spans = VSpansOf(model, surface);
  const double u0 = u_spans.front().begin, u1 = u_spans.back().end;
  const double v0 = v_spans.front().begin, v1 = v_spans.back().end;
  std::vector<Vec2> places;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + random.Uniform(0, 0.5)) / corners;
    const double size = radius * random.Uniform(0.6, 1);
    places.push_back({0.5 * (u0 + u1) + 0.5 * (u1 - u0) * size * std::cos(angle),
                      0.5 * (v0 + v1) + 0.5 * (v1 - v0) * size * std::sin(angle)});
  }
  if (clockwise) std::reverse(places.begin(), places.end());
  ModelBuilder builder(std::move(model));
  builder.AddLoop();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec2 a = places[i], b = places[(i + 1) % places.size()];
    const int degree = 1 + static_cast<int>(random.Below(3));
    std::vector<Vec3> points;
    for (int k = 0; k <= degree; ++k) {
      const bool end = k == 0 || k == degree;
      const double t = static_cast<double>(k) / degree;
      const Vec2 bulge = end ? Vec2{} : random.Uniform(-0.2, 0.2) * Vec2{b.y - a.y, a.x - b.x};
      // The ends are exactly the corners, because consecutive segments must meet.
      const Vec2 p = k == 0 ? a : k == degree ? b : (1 - t) * a + t * b + bulge;
      const double w = end ? 1 : random.Uniform(0.3, 3);
      points.push_back({w * p.x, w * p.y, w});
    }
    builder.AddCoedge({});
    builder.AddTrimSegment(points);
  }
  model = testing::Finished(std::move(builder));
}

Model SolidBox(const Placement& placement) {
  ModelBuilder builder;
  builder.AddPart("box");
  builder.AddSolid(true, "box");
  Instance instance;
  instance.placement = placement;
  builder.AddInstance(instance);
  const auto corner = [](int i) { return Vec3{i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0}; };
  Box3 bounds;
  for (int i = 0; i < 8; ++i) {
    builder.AddVertex(corner(i));
    bounds.Add(placement.Point(corner(i)));
  }
  builder.SetBounds(bounds);
  // There is an edge from each corner to each neighbour with one more bit.
  std::array<std::array<std::uint32_t, 8>, 8> edge_of{};
  for (int i = 0; i < 8; ++i) {
    for (const int bit : {1, 2, 4}) {
      if (i & bit) continue;
      const int j = i | bit;
      Edge edge;
      edge.vertices[0] = static_cast<std::uint32_t>(i);
      edge.vertices[1] = static_cast<std::uint32_t>(j);
      edge_of[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = builder.AddEdge(edge);
      std::vector<Vec4> points;
      for (const int end : {i, j}) points.push_back({corner(end).x, corner(end).y, corner(end).z, 1});
      builder.AddEdgeSegment(points);
    }
  }
  // There is a face across each axis at each end. u and v run along the other two axes, in such an order that
  // Su × Sv points outwards at the upper end.
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      const int along_u = 1 << ((axis + 1) % 3), along_v = 1 << ((axis + 2) % 3),
                base = upper ? 1 << axis : 0;
      // The plane extends beyond the face, like those of an importer.
      constexpr double kReach = 1.25;
      SurfaceGrid plane{SurfaceKind::kPlane, 1, 1, {{-kReach, kReach}}, {{-kReach, kReach}}, {}};
      plane.extendable_u = plane.extendable_v = true;
      for (const double u : {-kReach, kReach}) {
        for (const double v : {-kReach, kReach}) {
          double p[3] = {};
          p[axis] = upper ? 1 : -1;
          p[(axis + 1) % 3] = u;
          p[(axis + 2) % 3] = v;
          plane.points.push_back({p[0], p[1], p[2], 1});
        }
      }
      Face face;
      face.reversed = !upper;
      face.solid = 0;
      builder.AddFace(plane, face);
      builder.AddLoop();
      const int around[5] = {base, base | along_u, base | along_u | along_v, base | along_v, base};
      for (int side = 0; side < 4; ++side) {
        const int from = around[side], to = around[side + 1];
        Coedge coedge;
        coedge.edge = edge_of[static_cast<std::size_t>(std::min(from, to))]
                             [static_cast<std::size_t>(std::max(from, to))];
        coedge.reversed = from > to;
        coedge.from_file = true;
        builder.AddCoedge(coedge);
        std::vector<Vec3> points;
        for (const int end : {from, to})
          points.push_back({end & along_u ? 1.0 : -1.0, end & along_v ? 1.0 : -1.0, 1});
        builder.AddTrimSegment(points, coedge.reversed ? 1 : 0, coedge.reversed ? 0 : 1);
      }
    }
  }
  return testing::Finished(std::move(builder));
}

Placement RandomPlacement(Random& random) {
  // Draw a unit quaternion.
  double q[4], square = 0;
  do {
    square = 0;
    for (double& c : q) {
      c = random.Uniform(-1, 1);
      square += c * c;
    }
  } while (square > 1 || square < 0.01);
  for (double& c : q) c /= std::sqrt(square);
  const double s = std::exp2(random.Uniform(-2, 2)), a = q[0], b = q[1], c = q[2], d = q[3];
  const auto shift = [&] { return random.Uniform(-100, 100); };
  return {{{s * (a * a + b * b - c * c - d * d), s * 2 * (b * c - a * d), s * 2 * (b * d + a * c), shift()},
           {s * 2 * (b * c + a * d), s * (a * a - b * b + c * c - d * d), s * 2 * (c * d - a * b), shift()},
           {s * 2 * (b * d - a * c), s * 2 * (c * d + a * b), s * (a * a - b * b - c * c + d * d), shift()}}};
}

}  // namespace facetless::oracle
