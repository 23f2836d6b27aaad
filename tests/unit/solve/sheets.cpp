#include "tests/unit/solve/sheets.h"

#include <cmath>
#include <stdexcept>

namespace facetless::testing {
namespace {

constexpr double kHalf = 50;  // mm

double Number(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
}

}  // namespace

CameraFrame SheetFrame(bool perspective) {
  Box3 box;
  box.Add({-kHalf, -kHalf, -kHalf});
  box.Add({kHalf, kHalf, kHalf});
  const auto camera =
      NamedView("front", box, perspective ? Projection::kPerspective : Projection::kOrthographic,
                kSheetPixels, kSheetPixels);
  return MakeFrame(camera.value(), box.diagonal()).value();
}

Sheet MakeSheet(int degree_u, int degree_v, const SheetShape& shape, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  Sheet sheet{degree_u, degree_v, {}};
  const double step_u = 1.6 * kHalf / degree_u, step_v = 1.6 * kHalf / degree_v,
               depth = shape.depth * std::min(step_u, step_v);
  for (int k = 0; k <= degree_u; ++k)
    for (int l = 0; l <= degree_v; ++l) {
      const double x = (k + Number(engine, -shape.noise, shape.noise)) * step_u - 0.8 * kHalf,
                   z = (l + Number(engine, -shape.noise, shape.noise)) * step_v - 0.8 * kHalf,
                   y = Number(engine, -shape.noise, shape.noise) * depth;
      const double w = shape.spread == 1 ? 1 : Number(engine, 1 / shape.spread, shape.spread);
      sheet.points.push_back({w * x, w * y, w * z, w});
    }
  return sheet;
}

Sheet WildSheet(int degree_u, int degree_v, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  Sheet sheet{degree_u, degree_v, {}};
  for (int k = 0; k < (degree_u + 1) * (degree_v + 1); ++k) {
    const double w = std::exp2(Number(engine, -20, 20));
    sheet.points.push_back({w * Number(engine, -kHalf, kHalf), w * Number(engine, -20 * kHalf, kHalf),
                            w * Number(engine, -kHalf, kHalf), w});
  }
  return sheet;
}

SolverScene SceneOf(const CameraFrame& frame, const Sheet& sheet) {
  SolverScene scene(frame, {1, 2, 3});
  scene.AddPatch(sheet.degree_u, sheet.degree_v, sheet.points);
  return scene;
}

ExtendedPoint PointOn(const SolverScene& scene, std::uint32_t index, double u, double v) {
  const SolverPatch& patch = scene.patches()[index];
  const Vec4* points = scene.space(patch);
  const auto halve = [](std::vector<std::array<long double, 4>> row, long double t) {
    for (std::size_t n = row.size(); n > 1; --n)
      for (std::size_t i = 0; i + 1 < n; ++i)
        for (std::size_t c = 0; c < 4; ++c) row[i][c] = (1 - t) * row[i][c] + t * row[i + 1][c];
    return row[0];
  };
  std::vector<std::array<long double, 4>> column;
  for (int k = 0; k <= patch.degree_u; ++k) {
    std::vector<std::array<long double, 4>> row;
    for (int l = 0; l <= patch.degree_v; ++l) {
      const Vec4& p = points[k * (patch.degree_v + 1) + l];
      row.push_back({p.x, p.y, p.z, p.w});
    }
    column.push_back(halve(row, v));
  }
  const auto p = halve(column, u);
  return {p[0] / p[3], p[1] / p[3], p[2] / p[3]};
}

ExtendedPoint OnScreen(const SolverScene& scene, const ExtendedPoint& point) {
  const CameraFrame& frame = scene.frame();
  const ExtendedPoint d{point.x + scene.origin().x - frame.eye.x, point.y + scene.origin().y - frame.eye.y,
                        point.z + scene.origin().z - frame.eye.z};
  const auto dot = [&](Vec3 a) { return a.x * d.x + a.y * d.y + a.z * d.z; };
  const long double depth = dot(frame.forward),
                    scale = frame.projection == Projection::kPerspective ? depth : 1;
  return {dot(frame.right) / (frame.pixel_x * scale), dot(frame.down) / (frame.pixel_y * scale), depth};
}

double PixelsOff(const SolverScene& scene, const SolverRay& ray, const SolverRoot& root) {
  const ExtendedPoint at = OnScreen(scene, PointOn(scene, root.patch, root.u, root.v));
  return static_cast<double>(std::hypot(at.x - ray.x, at.y - ray.y));
}

SolverRay RayThrough(const SolverScene& scene, double x, double y) {
  const CameraFrame& frame = scene.frame();
  const Ray ray = PixelRay(frame, x + frame.center_x, y + frame.center_y);
  return {static_cast<int>(x + frame.center_x),
          static_cast<int>(y + frame.center_y),
          x,
          y,
          ray.origin - scene.origin(),
          ray.direction};
}

SolverRay RayTo(const SolverScene& scene, std::uint32_t patch, double u, double v) {
  const ExtendedPoint at = OnScreen(scene, PointOn(scene, patch, u, v));
  return RayThrough(scene, static_cast<double>(at.x), static_cast<double>(at.y));
}

std::unique_ptr<const Solver> MakeSolver(const std::string& name, const SolverScene& scene) {
  const SolverInfo* info = FindSolver(name);
  if (info == nullptr) throw std::invalid_argument("no solver is called " + name);
  auto made = info->make(scene, 0, {});
  if (!made.ok()) throw std::runtime_error(made.error().message);
  return std::move(made).value();
}

SolverStart StartAt(std::uint32_t surface, double u, double v, bool from_map) {
  return {surface, u, v, 0, 1, 0, 1, from_map};
}

std::uint64_t Ends(const SolverCounters& counters) {
  std::uint64_t sum = 0;
  for (const std::uint64_t stops : counters.stops) sum += stops;
  return sum;
}

}  // namespace facetless::testing
