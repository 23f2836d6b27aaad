#include "tests/verify/extremes/models.h"

#include <cmath>
#include <utility>

namespace facetless::extremes {

using testing::PatchGrid;

PatchGrid BezierPatch(int degree_u, int degree_v, std::vector<Vec4> points) {
  return {SurfaceKind::kBezier, degree_u, degree_v, {Span{}}, {Span{}}, std::move(points)};
}

PatchGrid BumpyPatch(int degree_u, int degree_v, double size, const std::function<double(int, int)>& weight) {
  std::vector<Vec4> points;
  for (int k = 0; k <= degree_u; ++k) {
    for (int l = 0; l <= degree_v; ++l) {
      const double w = weight ? weight(k, l) : 1;
      const double height = 0.2 * size * std::sin(2.4 * k + 1) * std::cos(1.7 * l);
      points.push_back({w * size * k / degree_u, w * size * l / degree_v, w * height, w});
    }
  }
  return BezierPatch(degree_u, degree_v, std::move(points));
}

PatchGrid WavySheet(int count, double size) {
  const int spans = count - 3;
  PatchGrid grid{SurfaceKind::kBspline, 3, 3, {}, {}, {}};
  for (int i = 0; i < spans; ++i) grid.u_spans.push_back({double(i), double(i + 1), SpanMap::kLinear});
  grid.v_spans = grid.u_spans;
  const auto control = [&](int i, int j) {
    return Vec3{size * i / (count - 1), size * j / (count - 1),
                0.02 * size * std::sin(0.9 * i) * std::cos(0.7 * j)};
  };
  // Converts four points of a uniform cubic span to Bézier form: rows divided by 6.
  constexpr int kRows[4][4] = {{1, 4, 1, 0}, {0, 4, 2, 0}, {0, 2, 4, 0}, {0, 1, 4, 1}};
  grid.points.reserve(std::size_t(spans) * spans * 16);
  for (int i = 0; i < spans; ++i) {
    for (int j = 0; j < spans; ++j) {
      for (const auto& row_u : kRows) {
        for (const auto& row_v : kRows) {
          Vec3 point;
          for (int k = 0; k < 4; ++k)
            for (int l = 0; l < 4; ++l) point = point + (row_u[k] * row_v[l] / 36.0) * control(i + k, j + l);
          grid.points.push_back({point.x, point.y, point.z, 1});
        }
      }
    }
  }
  return grid;
}

PatchGrid CutAt(const PatchGrid& grid, const std::vector<double>& cuts) {
  const Span whole = grid.u_spans[0];
  std::vector<double> at = {whole.begin};
  at.insert(at.end(), cuts.begin(), cuts.end());
  at.push_back(whole.end);
  PatchGrid cut{grid.kind, grid.degree_u, grid.degree_v, {}, grid.v_spans, {}};
  const int stride = grid.degree_v + 1;
  for (std::size_t piece = 0; piece + 1 < at.size(); ++piece) {
    cut.u_spans.push_back({at[piece], at[piece + 1], SpanMap::kLinear});
    // Point j of a piece is the blossom with `degree − j` arguments equal to the piece's begin and j equal to
    // its end.
    for (int j = 0; j <= grid.degree_u; ++j) {
      std::vector<Vec4> work = grid.points;
      for (int round = 1; round <= grid.degree_u; ++round) {
        const double value = round <= grid.degree_u - j ? at[piece] : at[piece + 1];
        const double t = (value - whole.begin) / (whole.end - whole.begin);
        for (int k = 0; k + round <= grid.degree_u; ++k)
          for (int l = 0; l < stride; ++l)
            work[k * stride + l] = (1 - t) * work[k * stride + l] + t * work[(k + 1) * stride + l];
      }
      for (int l = 0; l < stride; ++l) {
        if (grid.points[l].w == 1) work[l].w = 1;  // the mean of ones may be rounded
        cut.points.push_back(work[l]);
      }
    }
  }
  return cut;
}

PatchGrid Mapped(PatchGrid grid, const std::function<Vec3(Vec3)>& map) {
  for (Vec4& p : grid.points) {
    const Vec3 q = map({p.x / p.w, p.y / p.w, p.z / p.w});
    p = {p.w * q.x, p.w * q.y, p.w * q.z, p.w};
  }
  return grid;
}

std::vector<PatchGrid> ThreeSolids(Vec3 center, double size) {
  return {testing::Sphere(center, size), testing::Torus(center + Vec3{2.5 * size, 0, 0}, size, 0.3 * size),
          testing::Frustum(center + Vec3{-2.5 * size, 0, -size}, size, 0.2 * size, 2 * size)};
}

Camera Orthographic(std::string name, Vec3 eye, Vec3 target, Vec3 up, double height, int width_px,
                    int height_px) {
  Camera camera;
  camera.name = std::move(name);
  camera.eye = eye;
  camera.target = target;
  camera.up = up;
  camera.height = height;
  camera.width_px = width_px;
  camera.height_px = height_px;
  return camera;
}

Camera Perspective(std::string name, Vec3 eye, Vec3 target, Vec3 up, double fov_y_deg, int width_px,
                   int height_px) {
  Camera camera = Orthographic(std::move(name), eye, target, up, 0, width_px, height_px);
  camera.projection = Projection::kPerspective;
  camera.fov_y_deg = fov_y_deg;
  return camera;
}

std::vector<Camera> NamedViews(const Model& model, const std::vector<std::string>& names, int size) {
  std::vector<Camera> cameras;
  for (const std::string& name : names) {
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      cameras.push_back(NamedView(name, model.bounds, projection, size, size).value());
      cameras.back().name += projection == Projection::kPerspective ? "-perspective" : "";
    }
  }
  return cameras;
}

Camera CloseTo(const Model& model, const std::string& name, Vec3 point, double window, int size) {
  Camera camera = NamedView(name, model.bounds, Projection::kOrthographic, size, size).value();
  const Vec3 forward = MakeFrame(camera, model.Diagonal()).value().forward;
  const double distance = Length(camera.target - camera.eye);
  camera.target = point;
  camera.eye = point - distance * forward;
  camera.height = window;
  return camera;
}

Camera FromBehind(Camera camera) {
  camera.eye = camera.target + (camera.target - camera.eye);
  camera.name += "-reversed";
  return camera;
}

}  // namespace facetless::extremes
