#include "import/heal_changes.h"

#include <BRep_Tool.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <Geom_Curve.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <vector>

namespace facetless {
namespace {

// The points at which a replaced edge is compared with the one before.
constexpr int kPointsOfEdge = 9;

std::set<const void*> ShapesOf(const TopoDS_Shape& body, TopAbs_ShapeEnum kind) {
  std::set<const void*> shapes;
  for (TopExp_Explorer shape(body, kind); shape.More(); shape.Next())
    shapes.insert(shape.Current().TShape().get());
  return shapes;
}

std::size_t CountMissing(const std::set<const void*>& before, const std::set<const void*>& after) {
  return static_cast<std::size_t>(
      std::count_if(before.begin(), before.end(), [&](const void* shape) { return !after.contains(shape); }));
}

// The largest distance of points of `after` from `before`. OpenCASCADE may raise exceptions.
double LargestDistance(const TopoDS_Edge& before, const TopoDS_Edge& after) {
  double first = 0, last = 0, begin = 0, end = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(before, first, last);
  const Handle(Geom_Curve) moved = BRep_Tool::Curve(after, begin, end);
  if (curve.IsNull() || moved.IsNull()) return 0;
  if (curve == moved && first == begin && last == end) return 0;
  double largest = 0;
  for (int i = 0; i < kPointsOfEdge; ++i) {
    const gp_Pnt point = moved->Value(begin + (end - begin) * i / (kPointsOfEdge - 1));
    double distance = std::min(point.Distance(curve->Value(first)), point.Distance(curve->Value(last)));
    const GeomAPI_ProjectPointOnCurve nearest(point, curve, first, last);
    if (nearest.NbPoints() > 0) distance = std::min(distance, nearest.LowerDistance());
    largest = std::max(largest, distance);
  }
  return largest;
}

std::vector<TopoDS_Edge> EdgesWithout(const TopoDS_Shape& shape, const std::set<const void*>& known) {
  std::vector<TopoDS_Edge> edges;
  for (TopExp_Explorer edge(shape, TopAbs_EDGE); edge.More(); edge.Next())
    if (!known.contains(edge.Current().TShape().get())) edges.push_back(TopoDS::Edge(edge.Current()));
  return edges;
}

// The largest distance of a new edge of a face from the nearest edge that was replaced.
double LargestMove(const TopoDS_Shape& face, const TopoDS_Shape& healed) {
  double largest = 0;
  try {
    OCC_CATCH_SIGNALS
    const std::vector<TopoDS_Edge> replaced = EdgesWithout(face, ShapesOf(healed, TopAbs_EDGE));
    if (replaced.empty()) return 0;
    for (const TopoDS_Edge& edge : EdgesWithout(healed, ShapesOf(face, TopAbs_EDGE))) {
      double nearest = INFINITY;
      for (const TopoDS_Edge& before : replaced) nearest = std::min(nearest, LargestDistance(before, edge));
      largest = std::max(largest, nearest);
    }
  } catch (const Standard_Failure&) {
    return largest;
  }
  return largest;
}

}  // namespace

BodyBefore::BodyBefore(const TopoDS_Shape& body)
    : body_(body),
      faces_(ShapesOf(body, TopAbs_FACE)),
      edges_(ShapesOf(body, TopAbs_EDGE)),
      pcurves_(StoredPcurves(body)) {}

void BodyBefore::Describe(const TopoDS_Shape& healed,
                          const std::function<TopoDS_Shape(const TopoDS_Shape& face)>& became,
                          HealedBody& entry) const {
  entry.faces = faces_.size();
  entry.faces_changed = CountMissing(faces_, ShapesOf(healed, TopAbs_FACE));
  entry.edges_changed = CountMissing(edges_, ShapesOf(healed, TopAbs_EDGE));
  for (const auto& [use, pcurve] : StoredPcurves(healed)) {
    const auto before = pcurves_.find(use);
    if (before == pcurves_.end() || before->second != pcurve) ++entry.pcurves_changed;
  }
  for (TopExp_Explorer face(body_, TopAbs_FACE); face.More(); face.Next())
    if (const TopoDS_Shape after = became(face.Current()); !after.IsNull())
      entry.moved_mm = std::max(entry.moved_mm, LargestMove(face.Current(), after));
}

BodyBefore::Pcurves BodyBefore::StoredPcurves(const TopoDS_Shape& body) {
  Pcurves pcurves;
  for (TopExp_Explorer explorer(body, TopAbs_FACE); explorer.More(); explorer.Next()) {
    const TopoDS_Face face = TopoDS::Face(explorer.Current().Oriented(TopAbs_FORWARD));
    TopLoc_Location location;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
    if (surface.IsNull()) continue;
    for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
      double first = 0, last = 0;
      Standard_Boolean stored = false;
      const Handle(Geom2d_Curve) pcurve =
          BRep_Tool::CurveOnSurface(TopoDS::Edge(edge.Current()), face, first, last, &stored);
      if (pcurve.IsNull() || !stored) continue;
      const bool reversed = edge.Current().Orientation() == TopAbs_REVERSED;
      pcurves[{edge.Current().TShape().get(), surface.get(), reversed}] = pcurve;
    }
  }
  return pcurves;
}

}  // namespace facetless
