#include "import/mend_face.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Precision.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "import/surface_patches.h"

namespace facetless {
namespace {

// Returns the edges of a wire in order, without those that are followed forwards and backwards.
std::vector<TopoDS_Edge> Reduced(const TopoDS_Shape& wire, TopTools_MapOfShape& left_out) {
  const auto opposite = [](const TopoDS_Edge& a, const TopoDS_Edge& b) {
    return a.IsSame(b) && a.Orientation() != b.Orientation() && !BRep_Tool::Degenerated(a);
  };
  std::vector<TopoDS_Edge> edges;
  for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Value());
    if (!edges.empty() && opposite(edges.back(), edge)) {
      left_out.Add(edge.Oriented(TopAbs_FORWARD));
      edges.pop_back();
    } else {
      edges.push_back(edge);
    }
  }
  // The wire is closed, so its two ends may cancel, too.
  std::size_t ends = 0;
  while (edges.size() >= 2 * ends + 2 && opposite(edges[ends], edges[edges.size() - 1 - ends])) {
    left_out.Add(edges[ends].Oriented(TopAbs_FORWARD));
    ++ends;
  }
  return {edges.begin() + static_cast<std::ptrdiff_t>(ends), edges.end() - static_cast<std::ptrdiff_t>(ends)};
}

// Returns whether the iso-line is a point.
bool IsPoint(const Handle(Geom_Curve) & line) {
  const double first = line->FirstParameter(), last = line->LastParameter();
  if (Precision::IsInfinite(first) || Precision::IsInfinite(last)) return false;
  constexpr int kSamples = 8;
  const gp_Pnt begin = line->Value(first);
  for (int i = 1; i <= kSamples; ++i) {
    if (line->Value(first + (last - first) * i / kSamples).Distance(begin) > Precision::Confusion())
      return false;
  }
  return true;
}

// Returns whether the surface has no border.
bool IsClosed(const Handle(Geom_Surface) & surface) {
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  for (const double value : {u0, u1, v0, v1}) {
    if (Precision::IsInfinite(value)) return false;
  }
  const bool across_u = surface->IsUClosed() || (IsPoint(surface->UIso(u0)) && IsPoint(surface->UIso(u1)));
  const bool across_v = surface->IsVClosed() || (IsPoint(surface->VIso(v0)) && IsPoint(surface->VIso(v1)));
  return across_u && across_v;
}

}  // namespace

MendedFace MendFace(const std::vector<TopoDS_Face>& pieces) {
  MendedFace mended;
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = Untrimmed(BRep_Tool::Surface(pieces.front(), location));
  TopTools_MapOfShape left_out;
  std::vector<std::vector<TopoDS_Edge>> wires;
  for (const TopoDS_Face& piece : pieces) {
    const TopoDS_Shape forward = piece.Oriented(TopAbs_FORWARD);
    for (TopoDS_Iterator wire(forward); wire.More(); wire.Next()) {
      if (wire.Value().ShapeType() != TopAbs_WIRE) continue;
      std::vector<TopoDS_Edge> edges = Reduced(wire.Value(), left_out);
      if (!edges.empty()) wires.push_back(std::move(edges));
    }
  }
  if (left_out.IsEmpty()) return mended;
  mended.left_out = left_out.Extent();
  const double tolerance = BRep_Tool::Tolerance(pieces.front());
  BRep_Builder builder;
  if (wires.empty()) {
    if (!IsClosed(surface)) return mended;
    BRepBuilderAPI_MakeFace whole(surface, Precision::Confusion());
    if (whole.IsDone()) mended.face = TopoDS::Face(whole.Face().Moved(location));
  } else {
    TopoDS_Face face;
    builder.MakeFace(face, surface, location, tolerance);
    for (const std::vector<TopoDS_Edge>& edges : wires) {
      TopoDS_Wire wire;
      builder.MakeWire(wire);
      for (const TopoDS_Edge& edge : edges) builder.Add(wire, edge);
      builder.Add(face, wire);
    }
    mended.face = face;
  }
  if (pieces.front().Orientation() == TopAbs_REVERSED) mended.face.Reverse();
  return mended;
}

TopoDS_Face TorusPart(const TopoDS_Face& face, int part) {
  TopLoc_Location location;
  const auto torus = Handle(Geom_ToroidalSurface)::DownCast(Untrimmed(BRep_Tool::Surface(face, location)));
  if (part == 0 || torus.IsNull() || !(torus->MinorRadius() > torus->MajorRadius())) return face;
  double u0, u1, v0, v1;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  constexpr double kTurn = 2 * std::numbers::pi;
  if (u1 - u0 < kTurn - Precision::PConfusion() || v1 - v0 < kTurn - Precision::PConfusion()) return face;
  const double pole = std::acos(-torus->MajorRadius() / torus->MinorRadius());
  BRepBuilderAPI_MakeFace made(torus, 0, kTurn, part > 0 ? -pole : pole, part > 0 ? pole : kTurn - pole,
                               Precision::Confusion());
  if (!made.IsDone()) return face;
  TopoDS_Face result = TopoDS::Face(made.Face().Moved(location));
  if (face.Orientation() == TopAbs_REVERSED) result.Reverse();
  return result;
}

}  // namespace facetless
