// The teapot that Martin Newell measured in 1975, from its published control points. Body, rim, lid and
// bottom are turned profiles: each quadrant's row is (r, 0), (r, −0.56 r), (0.56 r, −r), (0, −r). Handle and
// spout are mirrored in the plane y = 0.

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BezierSurface.hxx>
#include <Precision.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <array>
#include <vector>

#include "samples/generator/shapes.h"

namespace facetless::samples {
namespace {

constexpr double kMillimetresPerUnit = 20;

struct ProfilePoint {
  double radius, z;
  double inner;  // the inner control points' short coordinate: 0.56 r, but for the knob, where the table
                 // rounds it
};
using Profile = std::array<ProfilePoint, 4>;

constexpr Profile kRim = {
    {{1.4, 2.4, 0.784}, {1.3375, 2.53125, 0.749}, {1.4375, 2.53125, 0.805}, {1.5, 2.4, 0.84}}};
constexpr Profile kUpperBody = {{{1.5, 2.4, 0.84}, {1.75, 1.875, 0.98}, {2, 1.35, 1.12}, {2, 0.9, 1.12}}};
constexpr Profile kLowerBody = {{{2, 0.9, 1.12}, {2, 0.45, 1.12}, {1.5, 0.225, 0.84}, {1.5, 0.15, 0.84}}};
constexpr Profile kBottom = {{{1.5, 0.15, 0.84}, {1.5, 0.075, 0.84}, {1.425, 0, 0.798}, {0, 0, 0}}};
constexpr Profile kKnob = {{{0, 3.15, 0}, {0.8, 3.15, 0.45}, {0, 2.85, 0}, {0.2, 2.7, 0.112}}};
constexpr Profile kLid = {{{0.2, 2.7, 0.112}, {0.4, 2.55, 0.224}, {1.3, 2.55, 0.728}, {1.3, 2.4, 0.728}}};

// Four cross-sections of half a tube: (x, z) of its outer and its inner line, and its half width.
struct TubeRow {
  double outer_x, outer_z, inner_x, inner_z, half_width;
};
using Tube = std::array<TubeRow, 4>;

constexpr Tube kUpperHandle = {{{-1.6, 2.025, -1.5, 2.25, 0.3},
                                {-2.3, 2.025, -2.5, 2.25, 0.3},
                                {-2.7, 2.025, -3, 2.25, 0.3},
                                {-2.7, 1.8, -3, 1.8, 0.3}}};
constexpr Tube kLowerHandle = {{{-2.7, 1.8, -3, 1.8, 0.3},
                                {-2.7, 1.575, -3, 1.35, 0.3},
                                {-2.5, 1.125, -2.65, 0.9375, 0.3},
                                {-2, 0.9, -1.9, 0.6, 0.3}}};
constexpr Tube kLowerSpout = {{{1.7, 1.425, 1.7, 0.6, 0.66},
                               {2.6, 1.425, 3.1, 0.825, 0.66},
                               {2.3, 2.1, 2.4, 2.025, 0.25},
                               {2.7, 2.4, 3.3, 2.4, 0.25}}};
constexpr Tube kUpperSpout = {{{2.7, 2.4, 3.3, 2.4, 0.25},
                               {2.8, 2.475, 3.525, 2.49375, 0.25},
                               {2.9, 2.475, 3.45, 2.5125, 0.15},
                               {2.8, 2.4, 3.2, 2.4, 0.15}}};

gp_Pnt Scaled(double x, double y, double z) {
  return {kMillimetresPerUnit * x, kMillimetresPerUnit * y, kMillimetresPerUnit * z};
}

// The table's patches face inwards; with the columns exchanged they face outwards.
void AddPatch(BRepBuilderAPI_Sewing& shell, const TColgp_Array2OfPnt& table) {
  TColgp_Array2OfPnt points(1, 4, 1, 4);
  for (int row = 1; row <= 4; ++row) {
    for (int column = 1; column <= 4; ++column) points(row, column) = table(row, 5 - column);
  }
  shell.Add(BRepBuilderAPI_MakeFace(new Geom_BezierSurface(points), Precision::Confusion()).Face());
}

void AddTurned(BRepBuilderAPI_Sewing& shell, const Profile& profile) {
  // Quarter turns by exchanging coordinates, which is exact: (x, y) → (−y, x).
  for (int quarter = 0; quarter < 4; ++quarter) {
    TColgp_Array2OfPnt points(1, 4, 1, 4);
    for (int row = 0; row < 4; ++row) {
      const auto [r, z, inner] = profile[row];
      const std::array<std::array<double, 2>, 4> quadrant = {{{r, 0}, {r, -inner}, {inner, -r}, {0, -r}}};
      for (int column = 0; column < 4; ++column) {
        auto [x, y] = quadrant[column];
        for (int turn = 0; turn < quarter; ++turn) {
          const double old_x = x;
          x = -y;
          y = old_x;
        }
        points(row + 1, column + 1) = Scaled(x, y, z);
      }
    }
    AddPatch(shell, points);
  }
}

void AddTube(BRepBuilderAPI_Sewing& shell, const Tube& tube) {
  for (const double side : {-1.0, 1.0}) {
    TColgp_Array2OfPnt points(1, 4, 1, 4);
    for (int row = 0; row < 4; ++row) {
      const TubeRow& r = tube[row];
      // The mirrored half runs backwards, so that both halves are oriented alike.
      const auto at = [&](int column) { return side < 0 ? column + 1 : 4 - column; };
      points(row + 1, at(0)) = Scaled(r.outer_x, 0, r.outer_z);
      points(row + 1, at(1)) = Scaled(r.outer_x, side * r.half_width, r.outer_z);
      points(row + 1, at(2)) = Scaled(r.inner_x, side * r.half_width, r.inner_z);
      points(row + 1, at(3)) = Scaled(r.inner_x, 0, r.inner_z);
    }
    AddPatch(shell, points);
  }
}

}  // namespace

TopoDS_Shape Teapot() {
  std::array<BRepBuilderAPI_Sewing, 4> shells;
  for (const Profile& profile : {kRim, kUpperBody, kLowerBody, kBottom}) AddTurned(shells[0], profile);
  for (const Profile& profile : {kKnob, kLid}) AddTurned(shells[1], profile);
  for (const Tube& tube : {kUpperHandle, kLowerHandle}) AddTube(shells[2], tube);
  for (const Tube& tube : {kLowerSpout, kUpperSpout}) AddTube(shells[3], tube);

  BRep_Builder builder;
  TopoDS_Compound teapot;
  builder.MakeCompound(teapot);
  for (BRepBuilderAPI_Sewing& shell : shells) {
    shell.Perform();
    builder.Add(teapot, shell.SewedShape());
  }
  return teapot;
}

}  // namespace facetless::samples
