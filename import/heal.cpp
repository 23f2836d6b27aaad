#include "import/heal.h"

#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom_Plane.hxx>
#include <Geom_Surface.hxx>
#include <Message_ProgressRange.hxx>
#include <OSD_Signal.hxx>
#include <Resource_Manager.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeProcess.hxx>
#include <ShapeProcess_OperLibrary.hxx>
#include <ShapeProcess_ShapeContext.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "import/heal_changes.h"
#include "import/loop_crossings.h"
#include "import/surface_patches.h"
#include "render/base/parallel.h"

namespace facetless {
namespace {

// An edge that is farther off its surface than this share of its length, and than the file's own precision,
// was projected to the wrong place, or is wrong in the file.
constexpr double kOffSurface = 1e-3;
// A volume that is smaller than this share of the sum of the faces' contributions is not reliably positive.
constexpr double kVolumeKnown = 0.02;
// The number of lines across a face's parameter range, and of points per stretch of a line, for the volume
// integral.
constexpr int kLines = 12, kPoints = 6;
// The number of points per segment of a loop, for the same integral.
constexpr int kChords = 6;
// The limit to which OpenCASCADE's reader lets tolerances grow, in mm.
constexpr double kMaxTolerance = 1;

using FaceMap = TopTools_DataMapOfShapeShape;

void Gather(const TopoDS_Shape& shape, std::vector<TopoDS_Shape>& bodies) {
  if (shape.IsNull()) return;
  switch (shape.ShapeType()) {
    case TopAbs_SOLID:
    case TopAbs_SHELL:
    case TopAbs_FACE:
      bodies.push_back(shape);
      return;
    case TopAbs_COMPOUND:
    case TopAbs_COMPSOLID:
      for (TopoDS_Iterator child(shape); child.More(); child.Next()) Gather(child.Value(), bodies);
      return;
    default:
      return;
  }
}

bool EdgesLieOn(const FaceLoops& loops, double precision_mm) {
  const auto length = [](const LoopCoedge& coedge) {
    double first = 0, last = 0;
    TopLoc_Location location;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(coedge.edge, location, first, last);
    if (curve.IsNull()) return 0.0;
    const gp_Pnt middle = curve->Value(0.5 * (first + last));
    return curve->Value(first).Distance(middle) + middle.Distance(curve->Value(last));
  };
  for (const FaceLoop& loop : loops.loops)
    for (const LoopCoedge& coedge : loop.coedges) {
      if (coedge.edge.IsNull() || coedge.degenerate || coedge.gap_mm <= precision_mm) continue;
      if (!(coedge.gap_mm <= kOffSurface * length(coedge))) return false;
    }
  return true;
}

// Says why a face is not sound; nullptr if it is.
const char* FaultOf(const FaceLoops& loops, double precision_mm) {
  if (!loops.lost_edges.empty()) return "it has an edge that cannot be used";
  if (!loops.repairs.empty()) return "its loops are out of order";
  if (!(loops.open_share <= kOpenSaid)) return "a loop does not close";
  if (!EdgesLieOn(loops, precision_mm)) return "an edge does not lie on its surface";
  if (!FindLoopCrossings(loops.loops).empty()) return "its loops cross";
  return nullptr;
}

// The loops' edges as chords in the parameter plane. For a face without loops, the chords are its surface's
// borders.
struct Chord {
  Vec2 from, to;
};
std::vector<Chord> ChordsOf(const FaceLoops& loops, const Handle(Geom_Surface) & surface) {
  std::vector<Chord> chords;
  for (const FaceLoop& loop : loops.loops)
    for (const LoopCoedge& coedge : loop.coedges)
      for (const LoopSegment& segment : coedge.segments) {
        const auto at = [&](int i) {
          const Vec3 uv = Cartesian(EvaluateBezier(segment.points, static_cast<double>(i) / kChords));
          return Vec2{uv.x, uv.y};
        };
        for (int i = 0; i < kChords; ++i) chords.push_back({at(i), at(i + 1)});
      }
  if (!chords.empty()) return chords;
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  surface->Bounds(u0, u1, v0, v1);
  return {{{u0, v0}, {u0, v1}}, {{u1, v0}, {u1, v1}}};
}

// Returns the contribution of a face to three times the volume, relative to `origin`.
double FluxOf(const TopoDS_Face& face, const FaceLoops& loops, const gp_Pnt& origin) {
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = Untrimmed(BRep_Tool::Surface(face, location));
  const gp_Trsf& placement = location.Transformation();
  const std::vector<Chord> chords = ChordsOf(loops, surface);
  double low = INFINITY, high = -INFINITY;
  for (const Chord& chord : chords) {
    low = std::min({low, chord.from.y, chord.to.y});
    high = std::max({high, chord.from.y, chord.to.y});
  }
  double flux = 0;
  std::vector<double> crossings;
  for (int line = 0; line < kLines; ++line) {
    const double v = low + (high - low) * (line + 0.5) / kLines;
    crossings.clear();
    for (const Chord& chord : chords)
      if ((chord.from.y <= v) != (chord.to.y <= v))
        crossings.push_back(chord.from.x +
                            (v - chord.from.y) / (chord.to.y - chord.from.y) * (chord.to.x - chord.from.x));
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const double width = (crossings[i + 1] - crossings[i]) / kPoints;
      for (int k = 0; k < kPoints; ++k) {
        gp_Pnt point;
        gp_Vec du, dv;
        surface->D1(crossings[i] + (k + 0.5) * width, v, point, du, dv);
        point.Transform(placement);
        du.Transform(placement);
        dv.Transform(placement);
        flux += gp_Vec(origin, point).Dot(du.Crossed(dv)) * width;
      }
    }
  }
  flux *= (high - low) / kLines;
  // A placement that mirrors reverses the cross product.
  const bool mirrored = placement.IsNegative();
  return (face.Orientation() == TopAbs_REVERSED) != mirrored ? -flux : flux;
}

struct Uses {
  int forward = 0, reversed = 0;
};

// Returns whether the body's faces use each of its edges at most once per direction. In a solid, each
// direction must be used exactly once.
bool EdgesMeet(const TopoDS_Shape& body, bool solid) {
  NCollection_DataMap<TopoDS_Shape, Uses, TopTools_ShapeMapHasher> uses;
  for (TopExp_Explorer edge(body, TopAbs_EDGE); edge.More(); edge.Next()) {
    if (BRep_Tool::Degenerated(TopoDS::Edge(edge.Current()))) continue;
    if (!uses.IsBound(edge.Current())) uses.Bind(edge.Current(), {});
    Uses& use = uses.ChangeFind(edge.Current());
    if (edge.Current().Orientation() == TopAbs_FORWARD) ++use.forward;
    if (edge.Current().Orientation() == TopAbs_REVERSED) ++use.reversed;
  }
  for (NCollection_DataMap<TopoDS_Shape, Uses, TopTools_ShapeMapHasher>::Iterator it(uses); it.More();
       it.Next()) {
    const Uses& use = it.Value();
    if (use.forward > 1 || use.reversed > 1) return false;
    if (solid && (use.forward != 1 || use.reversed != 1)) return false;
  }
  return true;
}

bool EnclosesVolume(const std::vector<TopoDS_Face>& faces, const std::vector<FaceLoops>& loops) {
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = Untrimmed(BRep_Tool::Surface(faces.front(), location));
  const Vec2 at = loops.front().loops.empty() ? Vec2{} : ChordsOf(loops.front(), surface).front().from;
  const gp_Pnt origin = surface->Value(at.x, at.y).Transformed(location.Transformation());
  double volume = 0, all = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double flux = FluxOf(faces[i], loops[i], origin);
    volume += flux;
    all += std::fabs(flux);
  }
  return volume > kVolumeKnown * all;
}

// Calls a face as the file does.
using NameFace = std::function<std::string(const TopoDS_Shape& face)>;

// Returns the loops of a face, or what is wrong with them. Several threads may call it for faces of one body.
Result<FaceLoops> SoundLoops(const TopoDS_Face& face, bool pcurves_in_file, double precision_mm) {
  try {
    OCC_CATCH_SIGNALS
    TopLoc_Location location;
    if (BRep_Tool::Surface(face, location).IsNull())
      return Error{ErrorCode::kFormatBroken, "it has no surface"};
    Result<FaceLoops> loops = LoopsOf(face, pcurves_in_file, MissingPcurve::kProjected);
    if (!loops.ok()) return loops;
    if (const char* fault = FaultOf(loops.value(), precision_mm))
      return Error{ErrorCode::kFormatBroken, fault};
    return loops;
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::kFormatBroken,
                 std::string("OpenCASCADE fails on it (") + failure.DynamicType()->Name() + ")"};
  }
}

// Stores the loops of the body's faces if it is sound. Otherwise it says why the body is not. OpenCASCADE may raise
// exceptions.
std::optional<std::string> StoreIfSound(const TopoDS_Shape& body, bool pcurves_in_file, double precision_mm,
                                        const NameFace& name, LoopsByFace& stored) {
  const bool solid = body.ShapeType() == TopAbs_SOLID;
  if (!EdgesMeet(body, solid)) return "its faces do not meet properly at their edges";
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer face(body, TopAbs_FACE); face.More(); face.Next())
    faces.push_back(TopoDS::Face(face.Current()));
  if (faces.empty()) return "it has no face";
  // Project the edges that have no p-curve. The faces are independent of each other. Faces after a faulty one are
  // skipped.
  std::vector<std::optional<Result<FaceLoops>>> found(faces.size());
  std::atomic<std::size_t> first_fault = faces.size();
  ParallelFor(std::size_t{0}, faces.size(), [&](std::size_t i) {
    if (i > first_fault) return;
    found[i] = SoundLoops(faces[i], pcurves_in_file, precision_mm);
    std::size_t known = first_fault;
    while (!found[i]->ok() && i < known && !first_fault.compare_exchange_weak(known, i)) continue;
  });
  std::vector<FaceLoops> loops;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!found[i]->ok()) return name(faces[i]) + ": " + found[i]->error().message;
    loops.push_back(std::move(*found[i]).value());
  }
  if (solid && !EnclosesVolume(faces, loops)) return "its faces do not enclose a positive volume";
  for (std::size_t i = 0; i < faces.size(); ++i) stored.Bind(faces[i], std::move(loops[i]));
  return std::nullopt;
}

std::optional<std::string> StoreIfSoundOrThrows(const TopoDS_Shape& body, bool pcurves_in_file,
                                                double precision_mm, const NameFace& name,
                                                LoopsByFace& stored) {
  try {
    OCC_CATCH_SIGNALS
    return StoreIfSound(body, pcurves_in_file, precision_mm, name, stored);
  } catch (const Standard_Failure& failure) {
    return std::string("OpenCASCADE fails on it (") + failure.DynamicType()->Name() + ")";
  }
}

// Returns the body as OpenCASCADE heals it, or the body itself if OpenCASCADE fails. `faces` receives the
// results of those faces that changed.
TopoDS_Shape Healed(const TopoDS_Shape& body, double precision_mm, FaceMap& faces) {
  try {
    OCC_CATCH_SIGNALS
    ShapeProcess_OperLibrary::Init();
    const Handle(ShapeProcess_ShapeContext) context = new ShapeProcess_ShapeContext(body, "STEP");
    context->ResourceManager()->SetResource("Runtime.Tolerance", precision_mm);
    context->ResourceManager()->SetResource("Runtime.MaxTolerance", kMaxTolerance);

    if (!ShapeProcess::Perform(context, "FromSTEP") || context->Result().IsNull()) return body;
    for (TopTools_DataMapIteratorOfDataMapOfShapeShape it(context->Map()); it.More(); it.Next())
      if (it.Key().ShapeType() == TopAbs_FACE) faces.Bind(it.Key(), it.Value());
    return context->Result();
  } catch (const Standard_Failure&) {
    return body;
  }
}

// Returns the result of healing a face. The map may contain the face without its placement.
TopoDS_Shape Mapped(const FaceMap& faces, const TopoDS_Shape& face) {
  if (const TopoDS_Shape* found = faces.Seek(face)) return *found;
  const TopoDS_Shape* bare = faces.Seek(face.Located(TopLoc_Location()));
  return bare == nullptr ? face : bare->Moved(face.Location());
}

// Returns one use of an edge as a B-spline in the edge's own parameter and direction; null if its segments do
// not form one.
Handle(Geom2d_BSplineCurve) PcurveOfUse(const LoopCoedge& use) {
  std::vector<const LoopSegment*> segments;
  for (const LoopSegment& segment : use.segments)
    if (segment.edge_begin != segment.edge_end) segments.push_back(&segment);
  if (use.reversed) std::reverse(segments.begin(), segments.end());
  if (segments.empty()) return {};
  const std::size_t degree = segments.front()->points.size() - 1;
  const int count = static_cast<int>(segments.size());
  TColgp_Array1OfPnt2d poles(1, count * static_cast<int>(degree) + 1);
  TColStd_Array1OfReal knots(1, count + 1);
  TColStd_Array1OfInteger multiplicities(1, count + 1);
  multiplicities.Init(static_cast<int>(degree));
  multiplicities.SetValue(1, static_cast<int>(degree) + 1);
  multiplicities.SetValue(count + 1, static_cast<int>(degree) + 1);
  for (int i = 0; i < count; ++i) {
    const LoopSegment& segment = *segments[static_cast<std::size_t>(i)];
    const double begin = use.reversed ? segment.edge_end : segment.edge_begin;
    const double end = use.reversed ? segment.edge_begin : segment.edge_end;
    if (segment.points.size() != degree + 1 || !(begin < end)) return {};
    knots.SetValue(i + 1, begin);
    knots.SetValue(i + 2, end);
    for (std::size_t k = 0; k <= degree; ++k) {
      const Vec4& p = segment.points[use.reversed ? degree - k : k];
      if (p.w != 1) return {};
      poles.SetValue(i * static_cast<int>(degree) + static_cast<int>(k) + 1, gp_Pnt2d(p.x, p.y));
    }
  }
  return new Geom2d_BSplineCurve(poles, knots, multiplicities, static_cast<int>(degree));
}

// Stores the p-curves of a face's loops in its edges where OpenCASCADE has none. Planes need no p-curves.
void StorePcurves(const TopoDS_Face& placed, const FaceLoops& loops) {
  const TopoDS_Face face = TopoDS::Face(placed.Oriented(TopAbs_FORWARD));
  TopLoc_Location location;
  if (Untrimmed(BRep_Tool::Surface(face, location))->IsKind(STANDARD_TYPE(Geom_Plane))) return;
  // A seam edge has two uses, one in each direction.
  NCollection_DataMap<TopoDS_Shape, std::pair<const LoopCoedge*, const LoopCoedge*>, TopTools_ShapeMapHasher>
      uses;
  for (const FaceLoop& loop : loops.loops)
    for (const LoopCoedge& coedge : loop.coedges) {
      if (coedge.edge.IsNull() || coedge.degenerate || coedge.from_file) continue;
      if (!uses.IsBound(coedge.edge)) uses.Bind(coedge.edge, {nullptr, nullptr});
      auto& [along, against] = uses.ChangeFind(coedge.edge);
      (coedge.reversed ? against : along) = &coedge;
    }
  const BRep_Builder builder;
  for (decltype(uses)::Iterator it(uses); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Key().Oriented(TopAbs_FORWARD));
    double first = 0, last = 0;
    Standard_Boolean stored = false;
    if (!BRep_Tool::CurveOnSurface(edge, face, first, last, &stored).IsNull() && stored) continue;
    const auto& [along, against] = it.Value();
    const Handle(Geom2d_BSplineCurve) one = PcurveOfUse(along != nullptr ? *along : *against);
    const Handle(Geom2d_BSplineCurve) other =
        along != nullptr && against != nullptr ? PcurveOfUse(*against) : Handle(Geom2d_BSplineCurve)();
    const double tolerance = BRep_Tool::Tolerance(edge);
    if (one.IsNull() || (along != nullptr && against != nullptr && other.IsNull())) continue;
    if (other.IsNull()) {
      builder.UpdateEdge(edge, one, face, tolerance);
    } else {
      builder.UpdateEdge(edge, one, other, face, tolerance);
    }
  }
}

// Gives the faces that result from healing `face` its origin and its colour.
void Inherit(const TopoDS_Shape& face, const TopoDS_Shape& healed, CadDocument& document,
             Prototype& prototype) {
  const void* before = face.TShape().get();
  for (TopExp_Explorer piece(healed, TopAbs_FACE); piece.More(); piece.Next()) {
    const void* after = piece.Current().TShape().get();
    if (after == before) continue;
    if (const auto origin = document.origins.find(before); origin != document.origins.end()) {
      const FaceOrigin copy = origin->second;
      document.origins[after] = copy;
    }
    if (const auto color = prototype.colors.find(before); color != prototype.colors.end()) {
      const Color copy = color->second;
      prototype.colors[after] = copy;
    }
  }
}

// The entity of the first face of a body that the file names; "" if it names none.
std::string FirstEntity(const TopoDS_Shape& body, const CadDocument& document) {
  for (TopExp_Explorer face(body, TopAbs_FACE); face.More(); face.Next())
    if (const auto origin = document.origins.find(face.Current().TShape().get());
        origin != document.origins.end() && !origin->second.entity.empty())
      return origin->second.entity;
  return {};
}

}  // namespace

Healing HealDocument(CadDocument& document) {
  Healing healing;
  if (!document.unhealed_mm) return healing;
  healing.precision_mm = *document.unhealed_mm;
  const NameFace name_face = [&](const TopoDS_Shape& face) {
    const std::string entity = FirstEntity(face, document);
    return entity.empty() ? std::string("a face") : "face " + entity;
  };
  for (Prototype& prototype : document.prototypes) {
    std::vector<TopoDS_Shape> bodies;
    Gather(prototype.shape, bodies);
    const Handle(ShapeBuild_ReShape) changes = new ShapeBuild_ReShape;
    bool changed = false;
    for (const TopoDS_Shape& body : bodies) {
      const std::optional<std::string> fault = StoreIfSoundOrThrows(
          body, document.pcurves_in_file, *document.unhealed_mm, name_face, healing.loops);
      if (!fault) {
        healing.sound.push_back(body);
        continue;
      }
      HealedBody entry{.name = prototype.name, .entity = FirstEntity(body, document), .reason = *fault};
      const BodyBefore before(body);
      FaceMap faces;
      const TopoDS_Shape healed = Healed(body, *document.unhealed_mm, faces);
      before.Describe(
          healed, [&](const TopoDS_Shape& face) { return Mapped(faces, face); }, entry);
      healing.healed.push_back(std::move(entry));
      if (healed.IsSame(body)) continue;
      for (TopExp_Explorer face(body, TopAbs_FACE); face.More(); face.Next())
        Inherit(face.Current(), Mapped(faces, face.Current()), document, prototype);
      changes->Replace(body, healed);
      changed = true;
    }
    if (changed) prototype.shape = changes->Apply(prototype.shape);
  }
  return healing;
}

std::vector<TopoDS_Face> HealedFaces(const std::vector<TopoDS_Face>& faces, const Healing& healing) {
  for (LoopsByFace::Iterator it(healing.loops); it.More(); it.Next())
    StorePcurves(TopoDS::Face(it.Key()), it.Value());
  FaceMap map;
  for (const TopoDS_Shape& body : healing.sound) Healed(body, healing.precision_mm, map);
  std::vector<TopoDS_Face> healed;
  for (const TopoDS_Face& face : faces) {
    const TopoDS_Shape mapped = Mapped(map, face);
    healed.push_back(mapped.ShapeType() == TopAbs_FACE ? TopoDS::Face(mapped.Oriented(face.Orientation()))
                                                       : face);
  }
  return healed;
}

}  // namespace facetless
