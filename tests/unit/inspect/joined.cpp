#include "tests/unit/inspect/joined.h"

#include <utility>

#include "tests/support/shapes.h"

namespace facetless::testing {
namespace {

// z = square·x² + slope·x + step over [x0, x1], by its polar form.
PatchGrid Parabola(double x0, double x1, double square, double slope, double step, double width) {
  PatchGrid grid{SurfaceKind::kBspline, 2, 1, {Span{}}, {Span{}}, {}};
  const double from[3] = {x0, x0, x1}, to[3] = {x0, x1, x1};
  for (int k = 0; k < 3; ++k) {
    const double x = 0.5 * (from[k] + to[k]), z = square * from[k] * to[k] + slope * x + step;
    for (double y : {0.0, width}) grid.points.push_back({x, y, z, 1});
  }
  return grid;
}

// The four sides of the parameter square; side `shared` belongs to edge 0, which runs along v.
void AddBorder(Model* model, std::uint32_t face, int shared) {
  constexpr Vec2 kCorners[5] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  model->faces[face].loops = {static_cast<std::uint32_t>(model->loops.size()), 1};
  model->loops.push_back({{static_cast<std::uint32_t>(model->coedges.size()), 4}});
  for (int side = 0; side < 4; ++side) {
    Coedge coedge;
    const bool down = side == 3;
    if (side == shared) coedge.edge = 0, coedge.reversed = down;
    coedge.segments = {static_cast<std::uint32_t>(model->trim_segments.size()), 1};
    model->trim_segments.push_back(
        {1, static_cast<std::uint32_t>(model->trim_points.size()), down ? 1.0 : 0.0, down ? 0.0 : 1.0});
    for (const Vec2 p : {kCorners[side], kCorners[side + 1]}) model->trim_points.push_back({p.x, p.y, 1});
    model->coedges.push_back(coedge);
  }
}

}  // namespace

Model Joined(const Join& join, double width) {
  Model model = ModelOf({Parabola(-1, 0, join.bend, 0, 0, width),
                         Parabola(0, 1, join.other_bend, join.slope, join.step, width)});
  Edge edge;
  edge.segments = {0, 1};
  edge.vertices[0] = 0;
  edge.vertices[1] = 1;
  edge.coedge_count = 2;
  model.edge_segments.push_back({1, 0, 0, 1});
  model.edge_points = {{0, 0, 0, 1}, {0, width, 0, 1}};
  model.vertices = {{{0, 0, 0}, 0}, {{0, width, 0}, 0}};
  model.edges.push_back(edge);
  AddBorder(&model, 0, 1);
  AddBorder(&model, 1, 3);
  model.faces[1].reversed = join.against;
  return model;
}

Model HollowBall(Vec3 center, double outer, double inner) {
  Model model = ModelOf({Sphere(center, outer), Sphere(center, inner)});
  model.faces[1].reversed = true;
  for (Face& face : model.faces) face.solid = 0;
  model.solids.push_back({0, true, "shell"});
  model.parts[0].solids = {0, 1};
  return model;
}

}  // namespace facetless::testing
