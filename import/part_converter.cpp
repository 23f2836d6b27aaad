#include "import/part_converter.h"

#include <BRep_Tool.hxx>
#include <OSD_Signal.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "import/curve_pieces.h"

namespace facetless {
namespace {

// As for p-curves: within an eighth of a turn the parameter of an arc and its angle nearly agree.
constexpr double kMaxArc = std::numbers::pi / 4;
// A conversion that is called exact must agree with the surface to this share of its coordinates' size.
constexpr double kExact = 1e-12;

// A p-curve that is farther from its 3D edge than this share of the edge's length is worth a warning: one of the two is wrong.
constexpr double kOffSurface = 0.01;
// Indices into the model's vectors are 32 bits wide; stop well before they run out.
constexpr std::size_t kMaxElements = std::size_t{1} << 31;

std::uint32_t Size(std::size_t size) {
  return static_cast<std::uint32_t>(size);
}

}  // namespace

void PartConverter::Begin() {
  first_face_ = Size(model_.faces.size());
  first_edge_ = Size(model_.edges.size());
  Gather(prototype_.shape, -1);
}

// Walks down to the faces, noting the solid or shell that each belongs to.
void PartConverter::Gather(const TopoDS_Shape& shape, int group) {
  if (shape.IsNull()) return;
  switch (shape.ShapeType()) {
    case TopAbs_FACE:
      members_.push_back({TopoDS::Face(shape), group});
      return;
    case TopAbs_SOLID:
      groups_.push_back({true, {}});
      group = static_cast<int>(groups_.size()) - 1;
      break;
    case TopAbs_SHELL:
      if (group < 0) {
        groups_.push_back({false, {}});
        group = static_cast<int>(groups_.size()) - 1;
      }
      break;
    case TopAbs_COMPOUND:
    case TopAbs_COMPSOLID:
      break;
    default:
      return;
  }
  for (TopoDS_Iterator child(shape); child.More(); child.Next()) Gather(child.Value(), group);
}

const FaceOrigin* PartConverter::OriginOf(const TopoDS_Face& face) const {
  const auto origin = document_.origins.find(face.TShape().get());
  return origin == document_.origins.end() ? nullptr : &origin->second;
}

void PartConverter::LoseFace(const TopoDS_Face& face, const std::string& reason) {
  const FaceOrigin* origin = OriginOf(face);
  model_.info.faces_lost.push_back(
      {kNoIndex, origin ? origin->name : "", origin ? origin->entity : "", reason});
}

std::uint32_t PartConverter::StoreSurface(PatchGrid grid) {
  Surface surface;
  surface.kind = grid.kind;
  surface.degree_u = static_cast<std::uint8_t>(grid.degree_u);
  surface.degree_v = static_cast<std::uint8_t>(grid.degree_v);
  surface.rational = grid.rational;
  surface.extendable_u = grid.extendable_u;
  surface.extendable_v = grid.extendable_v;
  surface.period_u = grid.period_u;
  surface.period_v = grid.period_v;
  surface.u_spans = {Size(model_.spans.size()), Size(grid.u_spans.size())};
  model_.spans.insert(model_.spans.end(), grid.u_spans.begin(), grid.u_spans.end());
  surface.v_spans = {Size(model_.spans.size()), Size(grid.v_spans.size())};
  model_.spans.insert(model_.spans.end(), grid.v_spans.begin(), grid.v_spans.end());
  surface.first_control_point = Size(model_.control_points.size());
  model_.control_points.insert(model_.control_points.end(), grid.points.begin(), grid.points.end());
  model_.surfaces.push_back(surface);
  return Size(model_.surfaces.size()) - 1;
}

std::uint32_t PartConverter::VertexIndex(const TopoDS_Shape& shape) {
  if (shape.IsNull()) return kNoIndex;
  if (const int* known = vertex_index_.Seek(shape)) return static_cast<std::uint32_t>(*known);
  const TopoDS_Vertex& vertex = TopoDS::Vertex(shape);
  model_.vertices.push_back({ToVec3(BRep_Tool::Pnt(vertex).XYZ()), BRep_Tool::Tolerance(vertex)});
  vertex_index_.Bind(shape, static_cast<int>(model_.vertices.size()) - 1);
  return Size(model_.vertices.size()) - 1;
}

// The edge that `oriented` is a use of, made when it is first met.
std::uint32_t PartConverter::EdgeIndex(const TopoDS_Edge& oriented) {
  const TopoDS_Edge shape = TopoDS::Edge(oriented.Oriented(TopAbs_FORWARD));
  if (const int* known = edge_index_.Seek(shape)) return static_cast<std::uint32_t>(*known);
  Edge edge;
  edge.tolerance_mm = BRep_Tool::Tolerance(shape);
  edge.vertices[0] = VertexIndex(TopExp::FirstVertex(shape));
  edge.vertices[1] = VertexIndex(TopExp::LastVertex(shape));
  edge.segments.first = Size(model_.edge_segments.size());
  TopLoc_Location location;
  double first = 0, last = 1;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(shape, location, first, last);
  if (!curve.IsNull() && !BRep_Tool::Degenerated(shape)) {
    Result<CurvePieces> pieces = PiecesOf(curve, first, last, kMaxArc, Parametrization::kEndsOnly);
    if (pieces.ok()) {
      Transform(location.Transformation(), pieces.value().pieces);
      for (const CurvePiece& piece : pieces.value().pieces) {
        model_.edge_segments.push_back({static_cast<std::uint8_t>(piece.degree()),
                                        Size(model_.edge_points.size()), piece.begin, piece.end});
        model_.edge_points.insert(model_.edge_points.end(), piece.points.begin(), piece.points.end());
      }
    }
  }
  edge.segments.count = Size(model_.edge_segments.size()) - edge.segments.first;
  edge.degenerate = edge.segments.count == 0;
  model_.edges.push_back(edge);
  edge_index_.Bind(shape, static_cast<int>(model_.edges.size()) - 1);
  return Size(model_.edges.size()) - 1;
}

void PartConverter::StoreLoop(const FaceLoop& loop) {
  Loop stored;
  stored.coedges = {Size(model_.coedges.size()), Size(loop.coedges.size())};
  for (const LoopCoedge& use : loop.coedges) {
    Coedge coedge;
    if (!use.edge.IsNull()) {
      coedge.edge = EdgeIndex(use.edge);
      ++model_.edges[coedge.edge].coedge_count;
    }
    coedge.reversed = use.reversed;
    coedge.from_file = use.from_file;
    coedge.gap_mm = use.gap_mm;
    coedge.segments = {Size(model_.trim_segments.size()), Size(use.segments.size())};
    for (const LoopSegment& segment : use.segments) {
      model_.trim_segments.push_back({static_cast<std::uint8_t>(segment.points.size() - 1),
                                      Size(model_.trim_points.size()), segment.edge_begin, segment.edge_end});
      for (const Vec4& p : segment.points) model_.trim_points.push_back({p.x, p.y, p.w});
    }
    model_.coedges.push_back(coedge);
  }
  model_.loops.push_back(stored);
}

void PartConverter::AddFace(const Member& member) {
  const TopoDS_Face& shape = member.face;
  try {
    OCC_CATCH_SIGNALS
    // Convert the loops, then as much of the surface as they reach.
    TopLoc_Location location;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(shape, location);
    if (surface.IsNull()) return LoseFace(shape, "it has no surface");
    Result<FaceLoops> loops = LoopsOf(shape, document_.pcurves_in_file);
    if (!loops.ok()) return LoseFace(shape, loops.error().message);
    const bool whole = loops.value().loops.empty();
    ParameterBox box = loops.value().box;
    if (whole) surface->Bounds(box.u0, box.u1, box.v0, box.v1);
    Result<PatchGrid> grid = PatchesOf(surface, box, whole, location.Transformation());
    if (!grid.ok()) return LoseFace(shape, grid.error().message);
    if (model_.control_points.size() + grid.value().points.size() > kMaxElements)
      return LoseFace(shape, "the model would have more than 2^31 control points");
    // Store.
    const std::uint32_t index = Size(model_.faces.size());
    Face face;
    const double deviation = grid.value().deviation;
    if (grid.value().approximated || !(deviation <= kExact * grid.value().size))
      model_.info.approximated.push_back({index, deviation});
    face.surface = StoreSurface(std::move(grid.value()));
    face.loops.first = Size(model_.loops.size());
    for (const FaceLoop& loop : loops.value().loops) StoreLoop(loop);
    face.loops.count = Size(model_.loops.size()) - face.loops.first;
    face.reversed = shape.Orientation() == TopAbs_REVERSED;
    face.tolerance_mm = BRep_Tool::Tolerance(shape);
    if (const auto color = prototype_.colors.find(shape.TShape().get()); color != prototype_.colors.end()) {
      face.has_color = true;
      face.color = color->second;
    }
    if (const FaceOrigin* origin = OriginOf(shape)) {
      face.name = origin->name;
      face.entity = origin->entity;
    }
    model_.faces.push_back(std::move(face));
    faces_.push_back(shape);
    face_groups_.push_back(member.group);
    WarnOfGaps(index);
    CheckAgainstFile(index, loops.value());
  } catch (const Standard_Failure& failure) {
    LoseFace(shape, std::string("OpenCASCADE failed on it: ") + failure.DynamicType()->Name());
  }
}

double PartConverter::PolygonLength(const Edge& edge) const {
  double length = 0;
  for (std::uint32_t s = edge.segments.first; s < edge.segments.end(); ++s) {
    const EdgeSegment& segment = model_.edge_segments[s];
    for (std::uint32_t i = segment.first_point; i < segment.first_point + segment.degree; ++i)
      length += Length(Cartesian(model_.edge_points[i + 1]) - Cartesian(model_.edge_points[i]));
  }
  return length;
}

void PartConverter::WarnOfGaps(std::uint32_t index) {
  const Face& face = model_.faces[index];
  double worst = 0;
  for (std::uint32_t l = face.loops.first; l < face.loops.end(); ++l) {
    const Range coedges = model_.loops[l].coedges;
    for (std::uint32_t c = coedges.first; c < coedges.end(); ++c) {
      const Coedge& coedge = model_.coedges[c];
      if (coedge.edge != kNoIndex && coedge.gap_mm > kOffSurface * PolygonLength(model_.edges[coedge.edge]))
        worst = std::fmax(worst, coedge.gap_mm);
    }
  }
  if (worst == 0) return;
  char distance[32];
  std::snprintf(distance, sizeof(distance), "%.3g", worst);
  model_.info.warnings.push_back("Face " + FaceName(index) + ": an edge lies " + distance +
                                 " mm off its surface.");
}

std::string PartConverter::FaceName(std::uint32_t index) const {
  const Face& face = model_.faces[index];
  return face.entity.empty() ? std::to_string(index) : face.entity;
}

// Lists bounds and edges that the file declares for the face and that did not arrive.
void PartConverter::CheckAgainstFile(std::uint32_t index, const FaceLoops& loops) {
  const Face& face = model_.faces[index];
  for (const std::string& repair : loops.repairs)
    model_.info.warnings.push_back("Face " + (face.entity.empty() ? std::to_string(index) : face.entity) +
                                   ": " + repair + ".");
  for (std::size_t i = 0; i < loops.lost_edges.size(); ++i)
    model_.info.edges_lost.push_back(
        {index, face.name, face.entity, "an edge has no curve on the surface and none can be computed"});
  const FaceOrigin* origin = OriginOf(faces_[index]);
  if (!origin || origin->bounds == 0) return;
  TopTools_MapOfShape edges;
  for (const FaceLoop& loop : loops.loops) {
    for (const LoopCoedge& coedge : loop.coedges) {
      if (!coedge.edge.IsNull() && !coedge.degenerate) edges.Add(coedge.edge.Oriented(TopAbs_FORWARD));
    }
  }
  const int missing_bounds = std::max(0, origin->bounds - static_cast<int>(loops.loops.size()));
  if (origin->edges > 0) {
    // Seams may join two bounds into one loop, and may add edges: a bound is missing only if edges are.
    if (edges.Extent() >= origin->edges) return;
    const int missing_edges = origin->edges - edges.Extent();
    for (int i = 0; i < missing_edges; ++i)
      model_.info.edges_lost.push_back(
          {index, face.name, face.entity, "OpenCASCADE dropped one of its edges"});
  }
  for (int i = 0; i < missing_bounds; ++i)
    model_.info.loops_lost.push_back(
        {index, face.name, face.entity, "OpenCASCADE dropped one of its bounds"});
}

// True if a bound or an edge that the file gives the face is missing.
bool PartConverter::HasLosses(std::uint32_t face) const {
  const auto of_face = [&](const Loss& loss) { return loss.face == face; };
  const ImportInfo& info = model_.info;
  return std::any_of(info.loops_lost.begin(), info.loops_lost.end(), of_face) ||
         std::any_of(info.edges_lost.begin(), info.edges_lost.end(), of_face);
}

// Every edge with a curve has exactly two uses, of opposite sense as seen from outside the faces, and none is known to be missing: a hole
// whose rim was lost on both sides would pass for closed.
bool PartConverter::IsClosed(int group) const {
  std::unordered_map<std::uint32_t, std::pair<int, int>> uses;
  for (std::size_t i = 0; i < face_groups_.size(); ++i) {
    if (face_groups_[i] != group) continue;
    if (HasLosses(first_face_ + static_cast<std::uint32_t>(i))) return false;
    const Face& face = model_.faces[first_face_ + i];
    for (std::uint32_t l = face.loops.first; l < face.loops.end(); ++l) {
      const Range coedges = model_.loops[l].coedges;
      for (std::uint32_t c = coedges.first; c < coedges.end(); ++c) {
        const Coedge& coedge = model_.coedges[c];
        if (coedge.edge == kNoIndex || model_.edges[coedge.edge].degenerate) continue;
        auto& [along, against] = uses[coedge.edge];
        ++(coedge.reversed != face.reversed ? against : along);
      }
    }
  }
  if (uses.empty()) return false;
  return std::all_of(uses.begin(), uses.end(),
                     [](const auto& use) { return use.second.first == 1 && use.second.second == 1; });
}

void PartConverter::End() {
  // Make solids of the groups: those that the file calls solids, and shells that turn out closed.
  Part part;
  part.name = prototype_.name;
  part.faces = {first_face_, Size(model_.faces.size()) - first_face_};
  part.solids.first = Size(model_.solids.size());
  std::vector<std::uint32_t> solid_of_group(groups_.size(), kNoIndex);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (std::find(face_groups_.begin(), face_groups_.end(), static_cast<int>(g)) == face_groups_.end())
      continue;
    const bool closed = IsClosed(static_cast<int>(g));
    if (!groups_[g].solid && !closed) continue;
    solid_of_group[g] = Size(model_.solids.size());
    model_.solids.push_back({Size(model_.parts.size()), closed, groups_[g].name});
  }
  part.solids.count = Size(model_.solids.size()) - part.solids.first;
  for (std::size_t i = 0; i < face_groups_.size(); ++i) {
    if (face_groups_[i] >= 0) model_.faces[first_face_ + i].solid = solid_of_group[face_groups_[i]];
  }
  model_.parts.push_back(std::move(part));
}

}  // namespace facetless
