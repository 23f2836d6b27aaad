#include "bench/thesis_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "bench/scene_surfaces.h"
#include "render/model/builder.h"

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;
// A cubic with this reach of its inner control points is a quarter of a circle to within 0.03 %.
constexpr double kQuarter = 0.5522847498;

// Control point k = 0 … 3 of quarter q of the unit circle.
Vec2 QuarterPoint(int quarter, int k) {
  constexpr double kX[] = {1, 1, kQuarter, 0}, kY[] = {0, kQuarter, 1, 1};
  const double x = kX[k], y = kY[k];
  switch (quarter) {
    case 0:
      return {x, y};
    case 1:
      return {-y, x};
    case 2:
      return {-x, -y};
    default:
      return {y, -x};
  }
}

// Four control points of a curve: in the plane of the axis (radius, 0, height), or in the plane y = 0.
using Cubic = std::array<Vec3, 4>;

// Adds a face of 4 × count bicubic patches: point k of quarter q and point l of curve c is place(q, k, c, l).
template <typename Place>
void AddQuarters(ModelBuilder& builder, std::size_t curves, const Place& place) {
  std::vector<Vec4> points;
  for (int quarter = 0; quarter < 4; ++quarter)
    for (std::size_t curve = 0; curve < curves; ++curve)
      for (int k = 0; k < 4; ++k)
        for (std::size_t l = 0; l < 4; ++l) points.push_back(Weighted(place(quarter, k, curve, l), 1));
  builder.AddFace({SurfaceKind::kBezier, 3, 3, UnitSpans(4), UnitSpans(static_cast<int>(curves)), points});
}

// Turns a profile of curves about the axis z.
void AddLathe(ModelBuilder& builder, const std::vector<Cubic>& profile) {
  AddQuarters(builder, profile.size(), [&](int quarter, int k, std::size_t curve, std::size_t l) {
    const Vec2 ring = QuarterPoint(quarter, k);
    const Vec3 p = profile[curve][l];
    return Vec3{p.x * ring.x, p.x * ring.y, p.z};
  });
}

// Moves a circle along curves in the plane y = 0. Its radius is interpolated between the ends of all curves.
void AddPipe(ModelBuilder& builder, const std::vector<Cubic>& path, double first_radius, double last_radius) {
  const double count = 3.0 * static_cast<double>(path.size());
  AddQuarters(builder, path.size(), [&](int quarter, int k, std::size_t curve, std::size_t l) {
    const Vec2 ring = QuarterPoint(quarter, k);
    const Cubic& c = path[curve];
    const Vec3 along = Normalized(c[std::min<std::size_t>(l + 1, 3)] - c[l > 0 ? l - 1 : 0]);
    const Vec3 across{-along.z, 0, along.x};
    const double share = (3.0 * static_cast<double>(curve) + static_cast<double>(l)) / count,
                 radius = first_radius + share * (last_radius - first_radius);
    return c[l] + (radius * ring.x) * across + Vec3{0, radius * ring.y, 0};
  });
}

Cubic Line(Vec3 a, Vec3 b) {
  return {a, a + (1.0 / 3) * (b - a), a + (2.0 / 3) * (b - a), b};
}

// Adds a B-spline sheet of columns × rows spans. at(s, t) gives its control points; s and t run from 0 to 1, and a little
// beyond.
template <typename At>
void AddSheet(ModelBuilder& builder, int columns, int rows, const At& at) {
  AddUniformBspline(builder, columns, rows,
                    [&](int i, int j) { return Weighted(at((i - 1.0) / columns, (j - 1.0) / rows), 1); });
}

}  // namespace

Model TeapotOnAPlane() {
  ModelBuilder builder;
  builder.AddPart("teapot");
  // The body from the foot to the rim, and the lid with its knob.
  AddLathe(builder, {{{{22, 0, 0}, {30, 0, 1}, {38, 0, 9}, {38, 0, 20}}},
                     {{{38, 0, 20}, {38, 0, 32}, {32, 0, 42}, {27, 0, 44}}},
                     Line({27, 0, 44}, {25, 0, 46})});
  AddLathe(builder, {{{{25, 0, 46}, {22, 0, 51}, {10, 0, 52}, {4, 0, 54}}},
                     {{{4, 0, 54}, {2, 0, 56}, {6, 0, 57}, {6, 0, 60}}},
                     {{{6, 0, 60}, {6, 0, 63}, {3, 0, 64}, {0.01, 0, 64}}}});
  // The spout and the handle begin inside the body.
  AddPipe(builder,
          {{{{30, 0, 16}, {48, 0, 16}, {46, 0, 30}, {54, 0, 38}}},
           {{{54, 0, 38}, {56, 0, 41}, {59, 0, 44}, {63, 0, 45}}}},
          9, 3.5);
  AddPipe(builder,
          {{{{-32, 0, 38}, {-46, 0, 42}, {-60, 0, 40}, {-60, 0, 30}}},
           {{{-60, 0, 30}, {-60, 0, 20}, {-50, 0, 14}, {-35, 0, 12}}}},
          3.5, 3.5);
  std::vector<Vec4> plane;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) plane.push_back({160.0 * i / 3 - 80, 160.0 * j / 3 - 80, 0, 1});
  builder.AddFace({SurfaceKind::kBezier, 3, 3, UnitSpans(1), UnitSpans(1), plane});
  return Placed(std::move(builder));
}

Model FlutedColumn() {
  ModelBuilder builder;
  builder.AddPart("column");
  const auto ring = [](double angle, double radius, double z) {
    return Vec3{radius * std::cos(angle), radius * std::sin(angle), z};
  };
  // The shaft has 8 flutes of four spans each.
  AddTube(
      builder, 32, 24, 120,
      [&](double angle, double share) {
        return ring(angle, (16 - 3 * share) * (1 + 0.07 * std::cos(8 * angle)), 20);
      },
      0);
  // The base swells twice, and the capital opens.
  AddTube(
      builder, 12, 8, 20,
      [&](double angle, double share) { return ring(angle, 21 + 4 * std::cos(4 * kPi * share), 0); }, 0);
  AddTube(
      builder, 12, 6, 18,
      [&](double angle, double share) { return ring(angle, 14 + 12 * share * share, 140); }, 0);
  return Placed(std::move(builder));
}

Model WaterLily() {
  ModelBuilder builder;
  builder.AddPart("water lily");
  for (int layer = 0; layer < 3; ++layer)
    for (int petal = 0; petal < 8; ++petal) {
      const double turn = 2 * kPi * (petal + 0.5 * layer) / 8, length = 40 - 8.0 * layer,
                   rise = 0.25 + 0.5 * layer;
      AddSheet(builder, 4, 6, [&](double s, double t) {
        // A petal is narrow at both ends, bent up along its length, and hollow across it.
        const double across = (2 * s - 1) * 11 * std::sin(kPi * std::fmin(0.97, std::fmax(0.06, t))),
                     along = 4 + length * t,
                     up = rise * length * t * t + 0.04 * across * across + 1.5 * layer;
        return Vec3{along * std::cos(turn) - across * std::sin(turn),
                    along * std::sin(turn) + across * std::cos(turn), up};
      });
    }
  // The middle, and three leaves that float.
  AddTube(
      builder, 10, 4, 12,
      [](double angle, double share) {
        const double radius = 6 * std::cos(0.45 * kPi * std::fmin(1.0, std::fmax(0.0, share))) + 0.1;
        return Vec3{radius * std::cos(angle), radius * std::sin(angle), 2};
      },
      0);
  for (int leaf = 0; leaf < 3; ++leaf) {
    const double turn = 2 * kPi * leaf / 3 + 0.4;
    AddSheet(builder, 12, 3, [&](double s, double t) {
      const double angle = turn + 0.2 + (2 * kPi - 0.4) * s, radius = 1 + 26 * t;
      return Vec3{46 * std::cos(turn) + radius * std::cos(angle),
                  46 * std::sin(turn) + radius * std::sin(angle), -2 + 1.2 * t * t * std::cos(5 * angle)};
    });
  }
  return Placed(std::move(builder));
}

Model SkullAndPathology() {
  ModelBuilder builder;
  builder.AddPart("skull");
  // The half of the skull behind the plane y = 0, with the folds of its inner surface.
  AddSheet(builder, 16, 14, [](double s, double t) {
    const double longitude = kPi * s, latitude = kPi * (std::fmin(1.0, std::fmax(0.0, t)) - 0.5);
    const double folds = 1 + 0.03 * std::cos(9 * longitude) * std::cos(7 * latitude);
    const double radius = folds * std::cos(latitude);
    return Vec3{70 * radius * std::cos(longitude), 85 * radius * std::sin(longitude),
                75 * folds * std::sin(latitude)};
  });
  // The pathology zone is an irregular closed body, pinched at both ends.
  AddTube(
      builder, 14, 8, 40,
      [](double angle, double share) {
        const double radius = 16 * std::sin(kPi * std::fmin(0.99, std::fmax(0.01, share))) *
                              (1 + 0.15 * std::cos(3 * angle + 5 * share) + 0.08 * std::cos(5 * angle));
        return Vec3{-15 + radius * std::cos(angle), 30 + radius * std::sin(angle), -10};
      },
      0);
  return Placed(std::move(builder));
}

}  // namespace facetless
