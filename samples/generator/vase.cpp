// A body of revolution whose faces meet in every grade of smoothness, from a corner to equal curvature.

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <Geom_BezierCurve.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <cmath>
#include <gp_Ax1.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>

#include "samples/generator/shapes.h"

namespace facetless::samples {
namespace {

// A point of the profile's plane y = 0, given by radius and height.
gp_Pnt At(double radius, double height) {
  return {radius, 0, height};
}

gp_Vec Heading(double degrees) {
  return {std::cos(degrees * M_PI / 180), 0, std::sin(degrees * M_PI / 180)};
}

// The arc about the centre, counter-clockwise from `from` to `to`.
Handle(Geom_Curve) Arc(const gp_Pnt& center, double radius, const gp_Pnt& from, const gp_Pnt& to) {
  const gp_Circ circle(gp_Ax2(center, gp_Dir(0, -1, 0), gp_Dir(1, 0, 0)), radius);
  return Handle(Geom_Curve)(GC_MakeArcOfCircle(circle, from, to, true).Value());
}

}  // namespace

TopoDS_Shape Vase() {
  // Two arcs with the same vertical tangent at height 20, of radii 25 and 12: G1.
  const gp_Pnt foot = At(20, 0), belly = At(30, 20);
  const gp_Pnt shoulder = At(18, 20).Translated(12 * Heading(60));
  const auto lower = Arc(At(5, 20), 25, foot, belly);
  const auto upper = Arc(At(18, 20), 12, belly, shoulder);

  // A cubic that leaves at 142 degrees where the arc arrives at 150: a groove of 8 degrees, G0.
  constexpr double kHandle = 4;
  const gp_Pnt neck = shoulder.Translated(13 * Heading(145.5));
  TColgp_Array1OfPnt poles(1, 4);
  poles(1) = shoulder;
  poles(2) = shoulder.Translated(kHandle * Heading(142));
  poles(3) = neck.Translated(-kHandle * Heading(150));
  poles(4) = neck;
  const Handle(Geom_BezierCurve) cubic = new Geom_BezierCurve(poles);

  // An arc with the tangent and the curvature that the cubic ends with, 2/3 of the second control point's
  // distance to the tangent by the square of the handle: G2.
  const gp_Vec across = Heading(240);
  const double radius = 1.5 * kHandle * kHandle / gp_Vec(neck, poles(2)).Dot(across);
  const gp_Pnt center = neck.Translated(radius * across);
  const gp_Pnt lip = center.Translated(radius * Heading(70));
  const auto top = Arc(center, radius, neck, lip);

  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(At(0, 0), foot).Edge());
  for (const Handle(Geom_Curve) & curve : {lower, upper, Handle(Geom_Curve)(cubic), top})
    wire.Add(BRepBuilderAPI_MakeEdge(curve).Edge());
  const gp_Pnt middle = At(0, lip.Z());
  wire.Add(BRepBuilderAPI_MakeEdge(lip, middle).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(middle, At(0, 0)).Edge());
  const TopoDS_Face profile = BRepBuilderAPI_MakeFace(wire.Wire(), true).Face();
  return BRepPrimAPI_MakeRevol(profile, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape();
}

}  // namespace facetless::samples
