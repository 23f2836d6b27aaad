#include "bench/patch_scene.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "bench/scene_surfaces.h"
#include "render/model/builder.h"

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;

// Returns one free-form body, about 60 mm high.
ModelBuilder BirdBody(bool rational) {
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
      rational ? 1 : 0);
  // Add a beak.
  AddTube(
      builder, 8, 3, 22,
      [](double angle, double share) {
        const double radius = 7 * (1.05 - share) + 0.5;
        return Vec3{20 + 14 * share + radius * std::cos(angle), radius * std::sin(angle), 40};
      },
      rational ? 2 : 0);
  return builder;
}

Model Birds() {
  ModelBuilder builder = BirdBody(true);
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
  return {
      {"bird", Placed(BirdBody(true))}, {"27 birds", Birds()}, {"handset", Handset()}, {"flange", Flange()}};
}

Model BezierBird() {
  return Placed(BirdBody(false));
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

}  // namespace facetless
