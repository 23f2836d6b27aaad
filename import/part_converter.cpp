#include "import/part_converter.h"

#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <OSD_Signal.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "import/crash_note.h"
#include "import/curve_pieces.h"
#include "import/loop_crossings.h"
#include "import/mend_face.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

// The same limit as for p-curves: within an eighth of a turn, the parameter of an arc nearly agrees with its
// angle.
constexpr double kMaxArc = std::numbers::pi / 4;
// A conversion counts as exact if it agrees with the surface to this share of the size of its coordinates.
constexpr double kExact = 1e-12;

// A p-curve that is farther from its 3D edge than this share of the edge's length causes a warning, since one
// of the two must be wrong.
constexpr double kOffSurface = 0.01;
// A line that closes a loop counts as a lost edge if it is longer than this share of the loop. Gaps in usable
// files reach a ten-thousandth.
constexpr double kOpenLost = 1e-2;
// Indices into the model's vectors are 32 bits wide. The conversion stops well before they overflow.
constexpr std::size_t kMaxElements = std::size_t{1} << 31;

}  // namespace

void PartConverter::Begin() {
  builder_.AddPart(prototype_.name);
  first_face_ = model().parts.back().faces.first;
  Gather(prototype_.shape, -1);
  stored_.assign(members_.size(), false);
}

// Walks down to the faces, and notes the solid or shell to which each belongs.
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
  builder_.info().faces_lost.push_back(
      {kNoIndex, origin ? origin->name : "", origin ? origin->entity : "", reason});
}

std::uint32_t PartConverter::VertexIndex(const TopoDS_Shape& shape) {
  if (shape.IsNull()) return kNoIndex;
  if (const int* known = vertex_index_.Seek(shape)) return static_cast<std::uint32_t>(*known);
  const TopoDS_Vertex& vertex = TopoDS::Vertex(shape);
  const std::uint32_t index =
      builder_.AddVertex(ToVec3(BRep_Tool::Pnt(vertex).XYZ()), BRep_Tool::Tolerance(vertex));
  vertex_index_.Bind(shape, static_cast<int>(index));
  return index;
}

// Returns the edge of which `oriented` is a use. The edge is created when it is first met.
std::uint32_t PartConverter::EdgeIndex(const TopoDS_Edge& oriented) {
  const TopoDS_Edge shape = TopoDS::Edge(oriented.Oriented(TopAbs_FORWARD));
  if (const int* known = edge_index_.Seek(shape)) return static_cast<std::uint32_t>(*known);
  Edge edge;
  // The precision that the file states for connected entities applies to every edge.
  edge.tolerance_mm = std::fmax(BRep_Tool::Tolerance(shape), document_.unhealed_mm.value_or(0));
  edge.vertices[0] = VertexIndex(TopExp::FirstVertex(shape));
  edge.vertices[1] = VertexIndex(TopExp::LastVertex(shape));
  // Convert the curve. An edge without a curve is degenerate.
  TopLoc_Location location;
  double first = 0, last = 1;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(shape, location, first, last);
  std::vector<CurvePiece> pieces;
  if (!curve.IsNull() && !BRep_Tool::Degenerated(shape)) {
    Result<CurvePieces> found = PiecesOf(curve, first, last, kMaxArc, Parametrization::kEndsOnly);
    if (found.ok()) pieces = std::move(found.value().pieces);
    Transform(location.Transformation(), pieces);
  }
  edge.degenerate = pieces.empty();
  const std::uint32_t index = builder_.AddEdge(edge);
  for (const CurvePiece& piece : pieces) builder_.AddEdgeSegment(piece.points, piece.begin, piece.end);
  edge_index_.Bind(shape, static_cast<int>(index));
  return index;
}

// Returns the edge of each coedge, in order. OpenCASCADE may fail on an edge, so this happens before any data
// of the face are stored.
std::vector<std::uint32_t> PartConverter::EdgesOf(const FaceLoops& loops) {
  std::vector<std::uint32_t> edges;
  for (const FaceLoop& loop : loops.loops) {
    for (const LoopCoedge& use : loop.coedges)
      edges.push_back(use.edge.IsNull() ? kNoIndex : EdgeIndex(use.edge));
  }
  return edges;
}

void PartConverter::StoreLoops(const FaceLoops& loops, const std::vector<std::uint32_t>& edges) {
  auto edge = edges.begin();
  std::vector<Vec3> points;
  for (const FaceLoop& loop : loops.loops) {
    builder_.AddLoop();
    for (const LoopCoedge& use : loop.coedges) {
      Coedge coedge;
      coedge.edge = *edge++;
      coedge.reversed = use.reversed;
      coedge.from_file = use.from_file;
      coedge.gap_mm = use.gap_mm;
      builder_.AddCoedge(coedge);
      for (const LoopSegment& segment : use.segments) {
        points.clear();
        for (const Vec4& p : segment.points) points.push_back({p.x, p.y, p.w});
        builder_.AddTrimSegment(points, segment.edge_begin, segment.edge_end);
      }
    }
  }
}

void PartConverter::AddFace(std::size_t index) {
  const Member& member = members_[index];
  if (stored_[index]) return;
  std::string reason;
  try {
    OCC_CATCH_SIGNALS
    mended_edges_ = 0;
    if (const FaceOrigin* origin = OriginOf(member.face)) NoteEntity(origin->entity);
    const FaceOrigin* from = OriginOf(member.face);
    reason = TryFace(member, from != nullptr ? TorusPart(member.face, from->torus_part) : member.face);
    stored_[index] = reason.empty();
    if (reason.empty()) return;
    const TopoDS_Face mended = Mended(index);
    if (!mended.IsNull() && TryFace(member, mended).empty()) {
      const FaceOrigin* origin = OriginOf(member.face);
      Warn("Face " + FaceName(first_face_ + static_cast<std::uint32_t>(face_groups_.size()) - 1) +
           ": its loops follow edges forwards and backwards; those edges were removed.");
      for (std::size_t i = 0; i < members_.size(); ++i)
        stored_[i] = stored_[i] || i == index || (origin != nullptr && SameOrigin(members_[i].face, *origin));
      return;
    }
  } catch (const Standard_Failure& failure) {
    if (reason.empty()) reason = std::string("OpenCASCADE failed on it: ") + failure.DynamicType()->Name();
  }
  LoseFace(member.face, reason);
}

bool PartConverter::SameOrigin(const TopoDS_Face& face, const FaceOrigin& origin) const {
  const FaceOrigin* other = OriginOf(face);
  return other != nullptr && !origin.entity.empty() && other->entity == origin.entity;
}

std::string PartConverter::TryFace(const Member& member, const TopoDS_Face& shape) {
  // Convert the loops, then the part of the surface that they cover.
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(shape, location);
  if (surface.IsNull()) return "it has no surface";
  const FaceLoops* known = loops_.Seek(shape);
  Result<FaceLoops> loops =
      known != nullptr ? Result<FaceLoops>(*known) : LoopsOf(shape, document_.pcurves_in_file);
  if (!loops.ok()) return loops.error().message;
  const bool whole = loops.value().loops.empty();
  ParameterBox box = loops.value().box;
  if (whole) surface->Bounds(box.u0, box.u1, box.v0, box.v1);
  Result<PatchGrid> grid = PatchesOf(surface, box, whole, location.Transformation());
  if (!grid.ok()) return grid.error().message;
  if (model().control_points.size() + grid.value().points.size() > kMaxElements)
    return "the model would have more than 2^31 control points";
  // Store.
  Face face;
  face.reversed = shape.Orientation() == TopAbs_REVERSED;
  face.tolerance_mm = BRep_Tool::Tolerance(shape);
  if (const auto color = prototype_.colors.find(member.face.TShape().get());
      color != prototype_.colors.end()) {
    face.has_color = true;
    face.color = color->second;
  }
  const FaceOrigin* origin = OriginOf(member.face);
  if (origin != nullptr) {
    face.name = origin->name;
    face.entity = origin->entity;
  }
  const std::vector<std::uint32_t> edges = EdgesOf(loops.value());
  const std::uint32_t index = builder_.AddFace(grid.value(), std::move(face));
  StoreLoops(loops.value(), edges);
  const double deviation = grid.value().deviation;
  if (grid.value().approximated || !(deviation <= kExact * grid.value().size))
    builder_.info().approximated.push_back({index, deviation});
  faces_.push_back(shape);
  face_groups_.push_back(member.group);
  WarnOfGaps(index);
  WarnOfOpening(index, loops.value());
  WarnOfCrossings(index, loops.value(), shape);
  NoteLoops(index, origin, loops.value());
  return {};
}

TopoDS_Face PartConverter::Mended(std::size_t index) {
  // Collect the pieces into which OpenCASCADE may have split the file's face. Pieces that are already
  // converted stay as they are.
  std::vector<TopoDS_Face> pieces{members_[index].face};
  if (const FaceOrigin* origin = OriginOf(members_[index].face)) {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (i == index || members_[i].group != members_[index].group || !SameOrigin(members_[i].face, *origin))
        continue;
      if (stored_[i]) return {};
      pieces.push_back(members_[i].face);
    }
  }
  const MendedFace mended = MendFace(pieces);
  mended_edges_ = mended.left_out;
  return mended.face;
}

void PartConverter::WarnOfGaps(std::uint32_t index) {
  const Face& face = model().faces[index];
  double worst = 0;
  for (const Coedge& coedge : CoedgesOf(model(), face)) {
    if (coedge.edge != kNoIndex &&
        coedge.gap_mm > kOffSurface * PolygonLength(model(), model().edges[coedge.edge]))
      worst = std::fmax(worst, coedge.gap_mm);
  }
  if (worst == 0) return;
  char distance[32];
  std::snprintf(distance, sizeof(distance), "%.3g", worst);
  Warn("Face " + FaceName(index) + ": an edge lies " + distance + " mm off its surface.");
}

std::string PartConverter::FaceName(std::uint32_t index) const {
  const Face& face = model().faces[index];
  return face.entity.empty() ? std::to_string(index) : face.entity;
}

// Reports a line that was invented to close a loop. If it is longer than rounding and inaccurate ends
// explain, it is also listed as a loss.
void PartConverter::WarnOfOpening(std::uint32_t index, const FaceLoops& loops) {
  if (!(loops.open_share > kOpenSaid)) return;
  char distance[32];
  std::snprintf(distance, sizeof(distance), "%.3g", loops.open_mm);
  const Face& face = model().faces[index];
  const std::string what = "its loop " + std::to_string(loops.open_loop + 1) + " of " +
                           std::to_string(loops.loops.size()) + " does not close: a gap of " + distance +
                           " mm was bridged by a straight line";
  if (loops.open_share > kOpenLost) {
    builder_.info().edges_lost.push_back({index, face.name, face.entity, what});
  } else {
    Warn("Face " + FaceName(index) + ": " + what + ".");
  }
}

// Reports loops that cross, with the place of the crossing.
void PartConverter::WarnOfCrossings(std::uint32_t index, const FaceLoops& loops, const TopoDS_Face& shape) {
  for (const LoopCrossing& crossing : FindLoopCrossings(loops.loops)) {
    TopLoc_Location location;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(shape, location);
    const gp_Pnt p = surface->Value(crossing.at.x, crossing.at.y).Transformed(location.Transformation());
    char place[128];
    std::snprintf(place, sizeof(place), "(%.6g, %.6g, %.6g) mm", p.X(), p.Y(), p.Z());
    const std::string first = std::to_string(crossing.first_loop + 1);
    Warn("Face " + FaceName(index) +
         (crossing.first_loop == crossing.second_loop
              ? ": its loop " + first + " crosses itself"
              : ": its loops " + first + " and " + std::to_string(crossing.second_loop + 1) +
                    " cross each other") +
         " at " + place + "; what is enclosed twice counts as outside (even-odd rule).");
  }
}

// Records how much of the declared face has been converted, and what was repaired.
void PartConverter::NoteLoops(std::uint32_t index, const FaceOrigin* origin, const FaceLoops& loops) {
  const Face& face = model().faces[index];
  for (const std::string& repair : loops.repairs) Warn("Face " + FaceName(index) + ": " + repair + ".");
  // In STEP, bounds may go around a surface without a seam or a pole. In other formats, this means that one
  // is missing.
  if (!document_.unhealed_mm)
    for (const std::string& join : loops.joins) Warn("Face " + FaceName(index) + ": " + join + ".");
  for (std::size_t i = 0; i < loops.lost_edges.size(); ++i)
    builder_.info().edges_lost.push_back(
        {index, face.name, face.entity, "an edge has no curve on the surface and none can be computed"});
  if (origin == nullptr || origin->bounds == 0) return;
  // Pieces of one face have copies of the same origin.
  const auto [known, added] = arrived_of_.try_emplace(origin->entity, arrived_.size());
  if (added) arrived_.push_back({origin, {}, {}, 0, 0});
  Arrived* arrived = &arrived_[known->second];
  arrived->faces.push_back(index);
  arrived->loops += static_cast<int>(loops.loops.size());
  arrived->mended += mended_edges_;
  for (const FaceLoop& loop : loops.loops) {
    for (const LoopCoedge& coedge : loop.coedges) {
      if (!coedge.edge.IsNull() && !coedge.degenerate)
        arrived->edges.Add(coedge.edge.Oriented(TopAbs_FORWARD));
    }
  }
}

// Lists the bounds and edges that the file declares for a face and that none of its pieces has.
void PartConverter::CheckAgainstFile() {
  for (const Arrived& arrived : arrived_) {
    const FaceOrigin& origin = *arrived.origin;
    const std::uint32_t index = arrived.faces.front();
    const int missing_edges = std::max(0, origin.edges - arrived.edges.Extent() - arrived.mended);
    const int missing_bounds = std::max(0, origin.bounds - arrived.loops);
    // Seams may join two bounds into one loop, and may add edges, so a bound counts as missing only if edges
    // are missing. Where OpenCASCADE splits a face, it distributes the bounds among the pieces.
    if (origin.edges > 0 && missing_edges == 0) continue;
    for (int i = 0; i < missing_edges; ++i)
      builder_.info().edges_lost.push_back(
          {index, origin.name, origin.entity, "OpenCASCADE dropped one of its edges"});
    for (int i = 0; i < missing_bounds; ++i)
      builder_.info().loops_lost.push_back(
          {index, origin.name, origin.entity, "OpenCASCADE dropped one of its bounds"});
  }
}

// Returns whether a declared bound or edge of the face is missing.
bool PartConverter::HasLosses(std::uint32_t face) const {
  const auto of_face = [&](const Loss& loss) { return loss.face == face; };
  const ImportInfo& info = model().info;
  return std::any_of(info.loops_lost.begin(), info.loops_lost.end(), of_face) ||
         std::any_of(info.edges_lost.begin(), info.edges_lost.end(), of_face);
}

// Returns whether every edge with a curve has exactly two uses, of opposite sense as seen from outside the
// faces, and no edge is known to be missing. Without the last condition, a hole whose rim was lost on both
// sides would pass for closed.
bool PartConverter::IsClosed(int group) const {
  std::unordered_map<std::uint32_t, std::pair<int, int>> uses;
  for (std::size_t i = 0; i < face_groups_.size(); ++i) {
    if (face_groups_[i] != group) continue;
    if (HasLosses(first_face_ + static_cast<std::uint32_t>(i))) return false;
    const Face& face = model().faces[first_face_ + i];
    for (const Coedge& coedge : CoedgesOf(model(), face)) {
      if (coedge.edge == kNoIndex || model().edges[coedge.edge].degenerate) continue;
      auto& [along, against] = uses[coedge.edge];
      ++(coedge.reversed != face.reversed ? against : along);
    }
  }
  if (uses.empty()) return false;
  return std::all_of(uses.begin(), uses.end(),
                     [](const auto& use) { return use.second.first == 1 && use.second.second == 1; });
}

// Reports a solid whose faces look inwards. OpenCASCADE turns such solids in STEP files. In other formats it
// leaves them, and their volume is negative.
void PartConverter::WarnOfTurning(int group) {
  std::size_t turned = 0, known = 0, all = 0;
  std::uint32_t example = 0;
  TopoDS_Compound faces;
  BRep_Builder builder;
  builder.MakeCompound(faces);
  for (std::size_t i = 0; i < face_groups_.size(); ++i) {
    if (face_groups_[i] != group) continue;
    const std::uint32_t index = first_face_ + static_cast<std::uint32_t>(i);
    const FaceOrigin* origin = OriginOf(faces_[index]);
    if (all++ == 0) example = index;
    builder.Add(faces, faces_[index]);
    if (origin == nullptr || origin->sense == 0) continue;
    ++known;
    if ((origin->sense < 0) != model().faces[index].reversed) ++turned;
  }
  double volume = 0;
  if (known == 0) {
    GProp_GProps properties;
    BRepGProp::VolumeProperties(faces, properties);
    volume = properties.Mass();
  }
  const bool by_senses = known == all && turned == all;
  if (!by_senses && !(known == 0 && volume < 0)) return;
  Warn("The solid with face " + FaceName(example) + " is inside out: its faces look inwards" +
       (by_senses ? ", and were turned." : "."));
}

void PartConverter::End() {
  CheckAgainstFile();
  // Create solids from the groups: those that the file calls solids, and shells that turn out to be closed.
  std::vector<std::uint32_t> solid_of_group(groups_.size(), kNoIndex);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (std::find(face_groups_.begin(), face_groups_.end(), static_cast<int>(g)) == face_groups_.end())
      continue;
    const bool closed = IsClosed(static_cast<int>(g));
    if (!groups_[g].solid && !closed) continue;
    if (closed) WarnOfTurning(static_cast<int>(g));
    solid_of_group[g] = builder_.AddSolid(closed, groups_[g].name);
  }
  for (std::size_t i = 0; i < face_groups_.size(); ++i) {
    if (face_groups_[i] >= 0)
      builder_.SetSolid(first_face_ + static_cast<std::uint32_t>(i), solid_of_group[face_groups_[i]]);
  }
}

}  // namespace facetless
