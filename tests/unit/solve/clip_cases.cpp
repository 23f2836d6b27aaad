#include "tests/unit/solve/clip_cases.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "render/solve/patch_jet.h"

namespace facetless::testing::clip {
namespace {

struct Extended {
  long double x = 0, y = 0, w = 0;
};

// De Casteljau's algorithm in extended precision.
Extended Evaluate(const SolverScene& scene, std::uint32_t index, long double u, long double v) {
  const SolverPatch& patch = scene.patches()[index];
  const ViewProjection::Point* points = scene.screen(patch);
  const auto curve = [](std::vector<Extended> row, long double t) {
    for (std::size_t n = row.size(); n > 1; --n)
      for (std::size_t i = 0; i + 1 < n; ++i)
        row[i] = {(1 - t) * row[i].x + t * row[i + 1].x, (1 - t) * row[i].y + t * row[i + 1].y,
                  (1 - t) * row[i].w + t * row[i + 1].w};
    return row[0];
  };
  std::vector<Extended> column;
  for (int k = 0; k <= patch.degree_u; ++k) {
    std::vector<Extended> row;
    for (int l = 0; l <= patch.degree_v; ++l, ++points) row.push_back({points->x, points->y, points->w});
    column.push_back(curve(row, v));
  }
  return curve(column, u);
}

Vec3 DrawDirection(std::mt19937_64& engine) {
  Vec3 d;
  do {
    d = {Draw(engine, -1, 1), Draw(engine, -1, 1), Draw(engine, -1, 1)};
  } while (Length(d) > 1 || Length(d) < 0.1);
  return Normalized(d);
}

CameraFrame FrameOf(const Camera& camera) {
  Result<CameraFrame> frame = MakeFrame(camera, 200);
  if (!frame.ok()) throw std::runtime_error(frame.error().message);
  return frame.value();
}

}  // namespace

double Draw(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * (double(engine() >> 11) * 0x1p-53);
}

int DrawDegree(std::mt19937_64& engine) {
  return 1 + static_cast<int>(engine() % kMaxDegree);
}

CameraFrame DrawView(std::mt19937_64& engine) {
  Camera camera;
  const Vec3 direction = DrawDirection(engine);
  camera.eye = Draw(engine, 150, 600) * direction;
  camera.up = Cross(direction, DrawDirection(engine));
  camera.projection = engine() % 2 == 0 ? Projection::kOrthographic : Projection::kPerspective;
  camera.height = 200;
  camera.fov_y_deg = 60;
  camera.width_px = 400;
  camera.height_px = 300;
  return FrameOf(camera);
}

CameraFrame PlainView() {
  Camera camera;
  camera.eye = {0, 0, 100};
  camera.up = {0, 1, 0};
  camera.height = 300;
  camera.width_px = camera.height_px = 300;
  return FrameOf(camera);
}

std::vector<Vec4> DrawNet(int degree_u, int degree_v, double bump, double spread, std::mt19937_64& engine) {
  const Vec3 a = DrawDirection(engine), c = Normalized(Cross(a, DrawDirection(engine))), b = Cross(c, a);
  std::vector<Vec4> points;
  for (int k = 0; k <= degree_u; ++k)
    for (int l = 0; l <= degree_v; ++l) {
      const double s = 100 * ((k + bump * Draw(engine, -1, 1)) / degree_u - 0.5);
      const double t = 100 * ((l + bump * Draw(engine, -1, 1)) / degree_v - 0.5);
      const Vec3 p = s * a + t * b + 100 * bump * Draw(engine, -1, 1) * c;
      // The share is squared, not raised to a power, so that most weights are moderate.
      const double share = Draw(engine, 0, 1);
      const double weight = 1 + (spread - 1) * share * share;
      const double w = engine() % 2 == 0 ? weight : 1 / weight;
      points.push_back({w * p.x, w * p.y, w * p.z, w});
    }
  return points;
}

std::vector<Vec4> Biquadratic(double (*x)(double, double), double (*y)(double, double)) {
  // The middle control point of a quadratic with the values a, m and b is 2m − (a + b)/2.
  const auto net = [](double (*value)(double, double)) {
    double n[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) n[i][j] = value(0.5 * i, 0.5 * j);
    for (auto& row : n) row[1] = 2 * row[1] - 0.5 * (row[0] + row[2]);
    for (int j = 0; j < 3; ++j) n[1][j] = 2 * n[1][j] - 0.5 * (n[0][j] + n[2][j]);
    return std::vector<double>(&n[0][0], &n[0][0] + 9);
  };
  const std::vector<double> xs = net(x), ys = net(y);
  std::vector<Vec4> points;
  for (std::size_t k = 0; k < 9; ++k) points.push_back({xs[k], -ys[k], 0, 1});
  return points;
}

SolverRay RayThrough(const SolverScene& scene, double x, double y) {
  const CameraFrame& frame = scene.frame();
  const Ray ray = PixelRay(frame, x + frame.center_x, y + frame.center_y);
  return {0, 0, x, y, ray.origin - scene.origin(), ray.direction};
}

SolverRay RayTo(const SolverScene& scene, std::uint32_t patch, double u, double v) {
  const Extended p = Evaluate(scene, patch, u, v);
  return RayThrough(scene, static_cast<double>(p.x / p.w), static_cast<double>(p.y / p.w));
}

double Distance(const SolverScene& scene, const SolverRay& ray, const SolverRoot& root) {
  const Extended p = Evaluate(scene, root.patch, root.u, root.v);
  const long double x = p.x / p.w - ray.x, y = p.y / p.w - ray.y;
  return static_cast<double>(std::sqrt(x * x + y * y));
}

double Condition(const SolverScene& scene, std::uint32_t index, double u, double v) {
  const SolverPatch& patch = scene.patches()[index];
  const PatchJet<3> jet = EvaluatePatch<3>(&scene.screen(patch)->x, patch.degree_u, patch.degree_v, u, v);
  const double w = jet.value[2], x = jet.value[0] / w, y = jet.value[1] / w;
  const Vec2 along_u{(jet.du[0] - x * jet.du[2]) / w, (jet.du[1] - y * jet.du[2]) / w};
  const Vec2 along_v{(jet.dv[0] - x * jet.dv[2]) / w, (jet.dv[1] - y * jet.dv[2]) / w};
  return std::fabs(Cross(along_u, along_v)) / std::max(Length(along_u), Length(along_v));
}

std::unique_ptr<const Solver> Prepared(std::string_view name, const SolverScene& scene) {
  const SolverInfo* info = FindSolver(name);
  if (info == nullptr) throw std::runtime_error("there is no solver of this name");
  Result<std::unique_ptr<const Solver>> solver = info->make(scene, 0, {});
  if (!solver.ok()) throw std::runtime_error(solver.error().message);
  return std::move(solver).value();
}

Answer Ask(const Solver& solver, const SolverRay& ray, std::uint32_t patch) {
  const auto state = solver.MakeState();
  solver.BeginRow(ray.row, *state);
  state->BeginRay();
  solver.Solve(ray, StartOf(solver.pieces()[patch]), *state);
  return {state->roots, state->counters, kMostRayWork - state->work_left};
}

std::uint64_t Stops(const Answer& answer, SolverStop stop) {
  return answer.counters.stops[static_cast<std::size_t>(stop)];
}

int RootsNear(const Answer& answer, double u, double v, double distance) {
  return static_cast<int>(
      std::count_if(answer.roots.begin(), answer.roots.end(), [&](const SolverRoot& root) {
        return std::fabs(root.u - u) <= distance && std::fabs(root.v - v) <= distance;
      }));
}

}  // namespace facetless::testing::clip
