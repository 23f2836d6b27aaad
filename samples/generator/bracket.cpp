#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <cmath>
#include <gp_Ax2.hxx>

#include "samples/generator/shapes.h"

namespace facetless::samples {
namespace {

constexpr double kLength = 90, kWidth = 60, kHeight = 70, kThickness = 12;

// Returns the straight edge of `shape` whose middle is at `middle`. Fillets take one edge at a time.
TopoDS_Edge EdgeAt(const TopoDS_Shape& shape, const gp_Pnt& middle) {
  for (TopExp_Explorer edges(shape, TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(edges.Current());
    const BRepAdaptor_Curve curve(edge);
    if (curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2).Distance(middle) < 1e-6)
      return edge;
  }
  throw Standard_NoSuchObject("bracket: no edge at the given point");
}

TopoDS_Shape LProfile() {
  const TopoDS_Shape base = BRepPrimAPI_MakeBox(kLength, kWidth, kThickness).Shape();
  const TopoDS_Shape wall = BRepPrimAPI_MakeBox(kThickness, kWidth, kHeight).Shape();
  ShapeUpgrade_UnifySameDomain unify(BRepAlgoAPI_Fuse(base, wall).Shape());
  unify.Build();
  return unify.Shape();
}

TopoDS_Shape RoundCorners(const TopoDS_Shape& block) {
  BRepFilletAPI_MakeFillet corners(block);
  corners.Add(14, EdgeAt(block, gp_Pnt(kLength, 0, kThickness / 2)));
  corners.Add(14, EdgeAt(block, gp_Pnt(kLength, kWidth, kThickness / 2)));
  corners.Add(14, EdgeAt(block, gp_Pnt(kThickness / 2, 0, kHeight)));
  corners.Add(14, EdgeAt(block, gp_Pnt(kThickness / 2, kWidth, kHeight)));
  corners.Add(10, EdgeAt(block, gp_Pnt(kThickness, kWidth / 2, kThickness)));
  return corners.Shape();
}

// Rounds the upper border of the base. Its two round corners give tori. The edges are found by following
// tangent edges from the far side.
TopoDS_Shape RollBase(const TopoDS_Shape& block) {
  BRepFilletAPI_MakeFillet roll(block);
  roll.Add(2.5, EdgeAt(block, gp_Pnt(kLength, kWidth / 2, kThickness)));
  return roll.Shape();
}

TopoDS_Shape CutHoles(const TopoDS_Shape& block) {
  // Two countersunk holes through the wall.
  TopoDS_Shape result = block;
  for (const double y : {16.0, 44.0}) {
    const gp_Ax2 axis(gp_Pnt(-1, y, 50), gp_Dir(1, 0, 0));
    result = BRepAlgoAPI_Cut(result, BRepPrimAPI_MakeCylinder(axis, 4, kThickness + 2).Shape()).Shape();
    const gp_Ax2 sink(gp_Pnt(kThickness - 3, y, 50), gp_Dir(1, 0, 0));
    result = BRepAlgoAPI_Cut(result, BRepPrimAPI_MakeCone(sink, 4, 8, 4).Shape()).Shape();
  }
  // A hole through the base, slanted against all axes, that breaks through the inner fillet.
  const gp_Dir slant(-0.3, 0.15, 1);
  const gp_Pnt start = gp_Pnt(29, 27, 0).Translated(gp_Vec(slant) * -20.0);
  return BRepAlgoAPI_Cut(result, BRepPrimAPI_MakeCylinder(gp_Ax2(start, slant), 7, 42).Shape()).Shape();
}

}  // namespace

TopoDS_Shape Bracket() {
  const TopoDS_Shape result = CutHoles(RollBase(RoundCorners(LProfile())));
  // Boolean operations wrap their result in a compound.
  return TopExp_Explorer(result, TopAbs_SOLID).Current();
}

}  // namespace facetless::samples
