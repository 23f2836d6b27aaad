#include "bench/patch_scene.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>

#include "render/model/builder.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;

Vec4 Weighted(Vec3 p, double w) {
  return {w * p.x, w * p.y, w * p.z, w};
}

std::vector<Span> UnitSpans(int count) {
  std::vector<Span> spans(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    spans[static_cast<std::size_t>(i)] = {static_cast<double>(i), i + 1.0, SpanMap::kLinear};
  return spans;
}

// Returns the built model with one placement. Our own scenes are valid, so Finish() cannot fail.
Model Placed(ModelBuilder builder) {
  builder.AddInstance({});
  return std::move(builder).Finish().value();
}

// Adds a uniform bicubic B-spline, split into its columns × rows Bézier patches. Its control points are
// net(i, j) with i < columns + 3 and j < rows + 3.
void AddUniformBspline(ModelBuilder& builder, int columns, int rows,
                       const std::function<Vec4(int, int)>& net) {
  // This matrix converts the four B-spline control points of a span to its Bézier points, times 6.
  constexpr double kToBezier[4][4] = {{1, 4, 1, 0}, {0, 4, 2, 0}, {0, 2, 4, 0}, {0, 1, 4, 1}};
  std::vector<Vec4> points;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j)
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
          Vec4 sum{0, 0, 0, 0};
          for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b) {
              const double share = kToBezier[k][a] * kToBezier[l][b] / 36;
              const Vec4 p = net(i + a, j + b);
              sum = {sum.x + share * p.x, sum.y + share * p.y, sum.z + share * p.z, sum.w + share * p.w};
            }
          points.push_back(sum);
        }
  builder.AddFace({SurfaceKind::kBspline, 3, 3, UnitSpans(columns), UnitSpans(rows), points});
}

// Adds a closed tube around z. Its radius and centre depend on the angle and on the share of the height; its
// weights differ.
void AddTube(ModelBuilder& builder, int around, int along, double height,
             const std::function<Vec3(double, double)>& at, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<double> weights(static_cast<std::size_t>(around * (along + 3)));
  for (double& weight : weights) weight = 0.75 + 0.5 * static_cast<double>(engine() >> 11) * 0x1p-53;
  AddUniformBspline(builder, around, along, [&](int i, int j) {
    const double angle = 2 * kPi * (i % around) / around, share = (j - 1.0) / along;
    const Vec3 p = at(angle, share);
    return Weighted({p.x, p.y, p.z + height * share}, weights[(i % around) * (along + 3) + j]);
  });
}

// Returns one free-form body, about 60 mm high.
ModelBuilder Bird() {
  ModelBuilder builder;
  builder.AddPart("bird");
  AddTube(
      builder, 12, 8, 60,
      [](double angle, double share) {
        const double belly = 22 * std::sin(kPi * std::fmin(1.0, std::fmax(0.02, 0.9 * share + 0.05))) + 3;
        const double wave = 1 + 0.18 * std::cos(3 * angle + 4 * share);
        return Vec3{belly * wave * std::cos(angle) + 12 * share * share, 0.8 * belly * wave * std::sin(angle),
                    0};
      },
      1);
  // Add a beak.
  AddTube(
      builder, 8, 3, 22,
      [](double angle, double share) {
        const double radius = 7 * (1.05 - share) + 0.5;
        return Vec3{20 + 14 * share + radius * std::cos(angle), radius * std::sin(angle), 40};
      },
      2);
  return builder;
}

Model Birds() {
  ModelBuilder builder = Bird();
  for (int k = 0; k < 27; ++k) {
    const int column = k % 3, row = k / 3 % 3, layer = k / 9;
    Instance instance;
    instance.placement.m[0][3] = 90.0 * column;
    instance.placement.m[1][3] = 80.0 * row;
    instance.placement.m[2][3] = 90.0 * layer;
    builder.AddInstance(instance);
  }
  return std::move(builder).Finish().value();
}

// Adds a dome over a square of the plane y = middle.y, towards −y.
void AddDome(ModelBuilder& builder, Vec3 middle, double half, double rise, int degree) {
  std::vector<Vec4> points;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; j <= degree; ++j) {
      const double x = 2.0 * i / degree - 1, z = 2.0 * j / degree - 1;
      const bool border = i == 0 || j == 0 || i == degree || j == degree;
      points.push_back(Weighted({middle.x + half * x, middle.y - (border ? 0 : rise), middle.z + half * z},
                                border ? 1 : 0.9));
    }
  builder.AddFace({SurfaceKind::kBezier, degree, degree, UnitSpans(1), UnitSpans(1), points});
}

Model Handset() {
  ModelBuilder builder;
  builder.AddPart("handset");
  AddTube(
      builder, 16, 4, 110,
      [](double angle, double) {
        // The cross-section is a rounded rectangle.
        const double c = std::cos(angle), s = std::sin(angle);
        const auto rounded = [](double x) { return std::copysign(std::sqrt(std::fabs(x)), x); };
        return Vec3{24 * rounded(c), 7 * rounded(s), 0};
      },
      3);
  // Add keys on the front.
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 3; ++column)
      AddDome(builder, {14.0 * (column - 1), -8, 14 + 12.0 * row}, 4.5, 5, row % 2 == 0 ? 3 : 2);
  return Placed(std::move(builder));
}

// Rotates profile points (radius, height, weight) about z. u is the angle, in four exact arcs.
void AddRevolution(ModelBuilder& builder, SurfaceKind kind, Vec3 base,
                   const std::vector<std::vector<Vec3>>& profile) {
  const double half = kPi / 4, weight = std::cos(half);
  std::vector<Span> u_spans(4);
  for (int i = 0; i < 4; ++i)
    u_spans[static_cast<std::size_t>(i)] = {i * kPi / 2, (i + 1) * kPi / 2, SpanMap::kHalfAngle};
  std::vector<Vec4> points;
  const int degree_v = static_cast<int>(profile.front().size()) - 1;
  for (int i = 0; i < 4; ++i)
    for (const std::vector<Vec3>& piece : profile)
      for (int k = 0; k < 3; ++k) {
        // Each quarter of the circle has its two ends, and between them the intersection of the tangents,
        // with the weight cos 45°.
        const double angle = kPi / 2 * i + half * k, w = k == 1 ? weight : 1, reach = k == 1 ? 1 / weight : 1;
        for (const Vec3& p : piece)
          points.push_back(Weighted(
              {base.x + reach * p.x * std::cos(angle), base.y + reach * p.x * std::sin(angle), base.z + p.y},
              w * p.z));
      }
  builder.AddFace({kind, 2, degree_v, u_spans, UnitSpans(static_cast<int>(profile.size())), points});
}

// Returns a quarter of the circle of a torus's tube: radius, height, weight.
std::vector<Vec3> ArcPiece(double major, double minor, int quarter) {
  std::vector<Vec3> piece;
  const double weight = std::cos(kPi / 4);
  for (int k = 0; k < 3; ++k) {
    const double angle = kPi / 2 * quarter + kPi / 4 * k, reach = k == 1 ? minor / weight : minor;
    piece.push_back({major + reach * std::cos(angle), reach * std::sin(angle), k == 1 ? weight : 1});
  }
  return piece;
}

Model Flange() {
  ModelBuilder builder;
  builder.AddPart("flange");
  const auto cylinder = [&](Vec3 base, double bottom, double top, double height) {
    AddRevolution(builder, bottom == top ? SurfaceKind::kCylinder : SurfaceKind::kCone, base,
                  {{{bottom, 0, 1}, {top, height, 1}}});
  };
  cylinder({0, 0, 0}, 60, 60, 12);
  cylinder({0, 0, 12}, 60, 32, 0.001);
  cylinder({0, 0, 12}, 32, 24, 40);
  AddRevolution(builder, SurfaceKind::kTorus, {0, 0, 56},
                {ArcPiece(26, 6, 0), ArcPiece(26, 6, 1), ArcPiece(26, 6, 2), ArcPiece(26, 6, 3)});
  for (int i = 0; i < 8; ++i) {
    const double angle = 2 * kPi * i / 8;
    const Vec3 at{48 * std::cos(angle), 48 * std::sin(angle), 12};
    cylinder(at, 6, 6, 6);
    cylinder({at.x, at.y, 18}, 6, 1, 2);
  }
  return Placed(std::move(builder));
}

}  // namespace

std::vector<NamedScene> PatchScenes() {
  return {{"bird", Placed(Bird())}, {"27 birds", Birds()}, {"handset", Handset()}, {"flange", Flange()}};
}

Model FieldOfFaces(int faces) {
  const int side = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(faces)))));
  // The pillows are so flat that no face hides another by its own bulge; only the ground's waves produce
  // outlines.
  constexpr double kSize = 1000, kWave = 40, kRise = 0.1;
  const auto ground = [](double x, double y) {
    return kWave * std::sin(2 * kPi * x / kSize) * std::cos(3 * kPi * y / kSize);
  };
  ModelBuilder builder;
  builder.AddPart("field");
  const double step = kSize / side;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      // Each face is a pillow on the ground, whose bulge is proportional to its size.
      std::vector<Vec4> points;
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
          const bool inner = k % 3 != 0 && l % 3 != 0;
          const double x = step * (i + k / 3.0), y = step * (j + l / 3.0);
          points.push_back({x, y, ground(x, y) + (inner ? kRise * step : 0), 1});
        }
      builder.AddFace({SurfaceKind::kBezier, 3, 3, UnitSpans(1), UnitSpans(1), points});
    }
  return Placed(std::move(builder));
}

std::vector<ScenePatch> PatchesOf(const Model& model) {
  std::vector<ScenePatch> patches;
  for (const Instance& instance : model.instances) {
    for (const PlacedFace face : WalkPlacedFaces(model, instance)) {
      const Surface& surface = model.surfaces[model.faces[face.face].surface];
      for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
        ScenePatch out;
        out.degree_u = surface.degree_u;
        out.degree_v = surface.degree_v;
        out.placed_face = face.id;
        for (const Vec4& p : PatchPoints(model, surface, patch)) {
          const Vec3 placed = instance.placement.Point({p.x / p.w, p.y / p.w, p.z / p.w});
          out.points.push_back({p.w * placed.x, p.w * placed.y, p.w * placed.z, p.w});
        }
        patches.push_back(std::move(out));
      }
    }
  }
  return patches;
}

}  // namespace facetless
