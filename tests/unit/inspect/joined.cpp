#include "tests/unit/inspect/joined.h"

#include <array>
#include <utility>

#include "tests/support/shapes.h"

namespace facetless::testing {
namespace {

// The parabola z = square·x² + slope·x + step over [x0, x1], from its polar form.
PatchGrid Parabola(double x0, double x1, double square, double slope, double step, double width) {
  PatchGrid grid{SurfaceKind::kBspline, 2, 1, {Span{}}, {Span{}}, {}};
  const double from[3] = {x0, x0, x1}, to[3] = {x0, x1, x1};
  for (int k = 0; k < 3; ++k) {
    const double x = 0.5 * (from[k] + to[k]), z = square * from[k] * to[k] + slope * x + step;
    for (double y : {0.0, width}) grid.points.push_back({x, y, z, 1});
  }
  return grid;
}

// The four sides of the parameter square. Side `shared` belongs to edge 0, which runs along v.
void AddBorder(ModelBuilder* builder, int shared) {
  constexpr Vec3 kCorners[5] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, 0, 1}};
  builder->AddLoop();
  for (int side = 0; side < 4; ++side) {
    Coedge coedge;
    const bool down = side == 3;
    if (side == shared) {
      coedge.edge = 0;
      coedge.reversed = down;
    }
    builder->AddCoedge(coedge);
    builder->AddTrimSegment({kCorners + side, 2}, down ? 1 : 0, down ? 0 : 1);
  }
}

}  // namespace

Model Joined(const Join& join, double width) {
  ModelBuilder builder;
  builder.AddPart("part");
  builder.AddInstance({});
  Edge edge;
  edge.vertices[0] = builder.AddVertex({0, 0, 0});
  edge.vertices[1] = builder.AddVertex({0, width, 0});
  builder.AddEdge(edge);
  builder.AddEdgeSegment(std::array{Vec4{0, 0, 0, 1}, Vec4{0, width, 0, 1}});
  builder.AddFace(Parabola(-1, 0, join.bend, 0, 0, width));
  AddBorder(&builder, 1);
  Face other;
  other.reversed = join.against;
  builder.AddFace(Parabola(0, 1, join.other_bend, join.slope, join.step, width), other);
  AddBorder(&builder, 3);
  return Finished(std::move(builder));
}

Model HollowBall(Vec3 center, double outer, double inner) {
  Model model = ModelOf({Sphere(center, outer), Sphere(center, inner)});
  model.faces[1].reversed = true;
  return ClosedSolid(std::move(model), "shell");
}

}  // namespace facetless::testing
