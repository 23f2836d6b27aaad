// Faces that are cut out of larger surfaces by curves in parameter space. The p-curve is exact, and the 3D curve
// approximates it.

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <GeomAbs_Shape.hxx>
#include <Geom_Plane.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <array>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <vector>

#include "samples/generator/bspline.h"
#include "samples/generator/shapes.h"

namespace facetless::samples {
namespace {

// The edge that runs along `curve` on `surface`; its 3D curve is within 1e-6 mm of it.
TopoDS_Edge EdgeOn(const Handle(Geom_Surface) & surface, const Handle(Geom2d_Curve) & curve, double first,
                   double last) {
  TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(curve, surface, first, last).Edge();
  BRepLib::BuildCurve3d(edge, 1e-6, GeomAbs_C1, 14, 500);
  return edge;
}

// A closed curve in parameters as a wire of two edges.
TopoDS_Wire ClosedWire(const Handle(Geom_Surface) & surface, const Handle(Geom2d_Curve) & curve) {
  const double first = curve->FirstParameter(), last = curve->LastParameter(), middle = (first + last) / 2;
  return BRepBuilderAPI_MakeWire(EdgeOn(surface, curve, first, middle), EdgeOn(surface, curve, middle, last))
      .Wire();
}

Handle(Geom2d_Curve) CircleAt(double u, double v, double radius) {
  return new Geom2d_Circle(gp_Ax2d(gp_Pnt2d(u, v), gp_Dir2d(1, 0)), radius);
}

// A closed cubic B-spline through no particular points: a rounded, uneven outline inside [0, 1]².
Handle(Geom2d_BSplineCurve) FreeOutline() {
  const std::vector<gp_Pnt2d> corners = {{0.5, 0.04}, {0.82, 0.1}, {0.96, 0.38}, {0.88, 0.7}, {0.7, 0.94},
                                         {0.4, 0.9},  {0.1, 0.96}, {0.05, 0.6},  {0.14, 0.3}, {0.2, 0.06}};
  const int count = static_cast<int>(corners.size());
  TColgp_Array1OfPnt2d poles(1, count);
  TColStd_Array1OfReal knots(1, count + 1);
  TColStd_Array1OfInteger multiplicities(1, count + 1);
  for (int i = 0; i < count; ++i) poles(i + 1) = corners[i];
  for (int i = 0; i <= count; ++i) {
    knots(i + 1) = i;
    multiplicities(i + 1) = 1;
  }
  const Handle(Geom2d_BSplineCurve) outline = new Geom2d_BSplineCurve(poles, knots, multiplicities, 3, true);
  // Readers treat periodic curves differently. The clamped curve is the same curve.
  outline->SetNotPeriodic();
  return outline;
}

TopoDS_Face FaceWithHoles(const Handle(Geom_Surface) & surface, const TopoDS_Wire& outer,
                          const std::vector<Handle(Geom2d_Curve)>& holes) {
  BRepBuilderAPI_MakeFace face(surface, outer, true);
  for (const Handle(Geom2d_Curve) & hole : holes) {
    face.Add(TopoDS::Wire(ClosedWire(surface, hole).Reversed()));
  }
  TopoDS_Face result = face.Face();
  BRepLib::SameParameter(result, 1e-7);
  return result;
}

TopoDS_Face CurvedSheet() {
  constexpr int kPoles = 8;
  TColgp_Array2OfPnt poles(1, kPoles, 1, kPoles);
  for (int i = 0; i < kPoles; ++i) {
    for (int j = 0; j < kPoles; ++j) {
      poles(i + 1, j + 1) =
          gp_Pnt(10.0 * i, 10.0 * j, Rounded(6 * std::sin(0.9 * i) + 4 * std::cos(0.7 * j)));
    }
  }
  const Handle(Geom_Surface) surface = ClampedSurface(poles, 3, 3);
  return FaceWithHoles(surface, ClosedWire(surface, CircleAt(0.5, 0.5, 0.46)), {CircleAt(0.42, 0.58, 0.15)});
}

TopoDS_Face Plate() {
  const gp_Pln plane(gp_Pnt(0, 0, -25), gp_Dir(0, 0, 1));
  BRepBuilderAPI_MakeFace face(plane, 0, 70, 0, 70);
  for (const double x : {18.0, 50.0}) {
    const gp_Circ circle(gp_Ax2(gp_Pnt(x, 35, -25), gp_Dir(0, 0, -1)), 11);
    face.Add(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire());
  }
  return face.Face();
}

TopoDS_Face CylinderPart() {
  const gp_Cylinder cylinder(gp_Ax3(gp_Pnt(95, 0, -10), gp_Dir(0, 1, 0), gp_Dir(1, 0, 0)), 15);
  return BRepBuilderAPI_MakeFace(cylinder, 0.25, 4.0, 5, 65).Face();
}

}  // namespace

TopoDS_Shape Freeform() {
  constexpr int kPolesU = 7, kPolesV = 6;
  constexpr std::array<double, 5> kWeights = {1, 0.25, 2, 0.5, 4};
  TColgp_Array2OfPnt poles(1, kPolesU, 1, kPolesV);
  TColStd_Array2OfReal weights(1, kPolesU, 1, kPolesV);
  for (int i = 0; i < kPolesU; ++i) {
    for (int j = 0; j < kPolesV; ++j) {
      const double height = 12 * std::sin(1.1 * i) * std::cos(0.9 * j) + 0.35 * (i - 3) * (j - 2.5) * 4;
      poles(i + 1, j + 1) = gp_Pnt(14.0 * i, 14.0 * j, Rounded(height));
      weights(i + 1, j + 1) = kWeights[(2 * i + 3 * j) % kWeights.size()];
    }
  }
  const Handle(Geom_Surface) surface = ClampedSurface(poles, weights, 4, 3);
  const Handle(Geom2d_Curve) slot =
      new Geom2d_Ellipse(gp_Ax2d(gp_Pnt2d(0.34, 0.62), gp_Dir2d(1, 1)), 0.16, 0.07);
  return FaceWithHoles(surface, ClosedWire(surface, FreeOutline()), {CircleAt(0.65, 0.35, 0.12), slot});
}

TopoDS_Shape TrimmedFaces() {
  BRep_Builder builder;
  TopoDS_Compound faces;
  builder.MakeCompound(faces);
  for (const TopoDS_Face& face : {CurvedSheet(), CylinderPart(), Plate()}) builder.Add(faces, face);
  return faces;
}

}  // namespace facetless::samples
