// The exact model, which the importer makes from a CAD file and which every renderer reads.
//
//     Result<Model> model = ReadModel("model.flm");  // render/model/model_file.h
//     for (std::uint32_t id = 0; id < model.value().PlacedFaceCount(); ++id)
//       Print(model.value().PlacedFaceName(id));
//
//  1. Lengths are in millimetres and angles in radians. The unit of the file is recorded but never used
//     again.
//  2. A model is flat: parts own consecutive faces, faces own consecutive loops, loops own consecutive
//     coedges, coedges own consecutive trim segments. Cross-references are indices into the vectors of Model.
//  3. Geometry is exact: every surface is a grid of (rational) Bézier patches, every p-curve a chain of
//     (rational) Bézier segments in the surface's *native* parameters (an angle stays an angle), every edge a
//     chain of 3D Bézier segments. Surfaces that could only be approximated are listed in
//     ImportInfo::approximated with their measured deviations.
//  4. Instances place parts. A face of an instance is a *placed face*; its id is Instance::first_placed_face
//     + the face's index within its part. Placed-face ids are dense: 0 … placed_face_count − 1.
//  5. Validate() succeeds for every Model that ReadModel returns or WriteModel writes: indices are in range,
//     numbers are finite, weights are positive, loops are ordered and closed, and spans increase.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/base/vec.h"

namespace facetless {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

// The highest degree of a surface, a p-curve or an edge. It is the highest that OpenCASCADE, which the
// importer uses, accepts (Geom_BSplineSurface::MaxDegree).
inline constexpr int kMaxDegree = 25;

// A half-open range [first, first + count) of indices into one of Model's vectors.
struct Range {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t end() const { return first + count; }
};

struct Color {  // sRGB-encoded, 0 … 1
  float r = 0.7f, g = 0.7f, b = 0.72f;
  float a = 1;  // opacity
};

enum class SurfaceKind : std::uint8_t {
  kPlane,
  kCylinder,
  kCone,
  kSphere,
  kTorus,
  kRevolution,
  kExtrusion,
  kBezier,
  kBspline,
  kOffset,
  kOther,
};
const char* SurfaceKindName(SurfaceKind kind);  // "plane", "cylinder", …: the keys of report.json

// The map from the Bézier parameter t ∈ [0,1] of a span to its native interval [begin, end].
enum class SpanMap : std::uint8_t {
  kLinear,  // native = begin + t·(end − begin)
  // NURBS arc: with m the centre and h half the width, (2t − 1)·tan(h/2) = tan((native − m)/2); h < π/2
  kHalfAngle,
};

// One knot span of a surface in one direction, in native parameters; begin < end.
struct Span {
  double begin = 0, end = 1;
  SpanMap map = SpanMap::kLinear;
};

// A tensor-product grid of u_spans.count × v_spans.count Bézier patches of one bidegree. Patch (i, j) covers
// u_spans[i] × v_spans[j]. The index of its control point (k, l) is
//   first_control_point + ((i·v_spans.count + j)·(degree_u+1) + k)·(degree_v+1) + l,   k along u, l along v.
// Consecutive spans share an end. Interior borders may be only C0. The grid holds only the spans that the
// loops of the face can reach.
struct Surface {
  SurfaceKind kind = SurfaceKind::kBspline;
  std::uint8_t degree_u = 1, degree_v = 1;
  bool rational = false;  // false: every w is exactly 1
  // true: the patch grid extends beyond the loops of the face at both ends of the direction, or is closed in
  // that direction; false: the loops may run along the border of the grid.
  bool extendable_u = false, extendable_v = false;
  double period_u = 0, period_v = 0;  // 0: not periodic in native parameters
  Range u_spans, v_spans;             // into Model::spans
  std::uint32_t first_control_point = 0;
  std::uint32_t PatchCount() const { return u_spans.count * v_spans.count; }
  std::uint32_t PointsPerPatch() const { return (degree_u + 1u) * (degree_v + 1u); }
};

// A rational Bézier segment of a p-curve, with degree + 1 control points (w·u, w·v, w) in Model::trim_points.
// [edge_begin, edge_end] is the corresponding interval of the edge's parameter, which depends linearly on the
// segment's parameter in [0,1]. edge_begin > edge_end if the coedge runs against its edge.
struct TrimSegment {
  std::uint8_t degree = 1;
  std::uint32_t first_point = 0;
  double edge_begin = 0, edge_end = 1;
};

// One use of an edge by a loop. The segments are in loop order. Loops are stored in the orientation of the
// *surface*: the face lies to the left of the p-curve in (u,v), whether or not Face::reversed is set.
struct Coedge {
  std::uint32_t edge = kNoIndex;  // kNoIndex: no 3D edge is known (a natural border that the importer added)
  bool reversed = false;          // the coedge runs against its edge
  bool from_file = false;  // true: the file contains the p-curve; false: it was computed from the 3D edge
  Range segments;          // into Model::trim_segments
  double gap_mm = 0;       // largest measured distance between the p-curve on the surface and the 3D edge
};

struct Loop {
  Range coedges;  // into Model::coedges
};

// A rational Bézier segment of the 3D curve of an edge, with degree + 1 homogeneous control points in
// Model::edge_points. It covers [begin, end] of the edge's parameter, which depends linearly on the segment's
// parameter in [0,1].
struct EdgeSegment {
  std::uint8_t degree = 1;
  std::uint32_t first_point = 0;
  double begin = 0, end = 1;
};

struct Edge {
  Range segments;  // into Model::edge_segments; empty for a degenerate (collapsed) edge
  std::uint32_t vertices[2] = {kNoIndex, kNoIndex};  // into Model::vertices; equal for a closed edge
  double tolerance_mm = 0;                           // as recorded in the file or by the importer
  bool degenerate = false;                           // the edge is collapsed to a point and has p-curves only
  std::uint32_t coedge_count = 0;  // uses by all faces of the part: 2 in the interior of a closed shell
  std::string entity;              // "#123" where known
};

struct Vertex {
  Vec3 point;
  double tolerance_mm = 0;
};

struct Face {
  std::uint32_t surface = 0;       // into Model::surfaces; each face has its own
  Range loops;                     // into Model::loops; empty: the face is the whole patch grid
  bool reversed = false;           // outward normal = −(Su × Sv)
  std::uint32_t solid = kNoIndex;  // into Model::solids
  bool has_color = false;
  Color color;
  double tolerance_mm = 0;
  std::string name;    // from the file, or ""
  std::string entity;  // where the file defines the face: "#123" (STEP), "D57" (IGES)
};

struct Solid {
  std::uint32_t part = 0;
  bool closed = false;  // every non-degenerate edge has exactly two coedges of opposite sense
  std::string name;
};

struct Part {  // a prototype
  std::string name;
  Range faces;   // into Model::faces
  Range solids;  // into Model::solids
};

struct Instance {
  std::uint32_t part = 0;
  Placement placement;
  bool has_color = false;  // `color` applies to the faces that have no colour of their own
  Color color;
  std::string name;  // path of occurrence names, "car/wheel:2"
  std::uint32_t first_placed_face = 0;
  bool hidden = false;  // the file hides this instance; arrangements leave it out unless show_hidden is set
};

// An element that the file declares but the model does not contain.
struct Loss {
  std::uint32_t face =
      kNoIndex;  // index into Model::faces of the face that lost a loop or an edge; kNoIndex: the face itself
  std::string name, entity, reason;
};
struct Approximation {
  std::uint32_t face = 0;
  double deviation_mm = 0;  // measured deviation of the patches from the surface that they approximate
};

// A body that is not shown as the file has it, because OpenCASCADE healed it. A body is a solid, a shell or a face
// (import/heal.h).
struct HealedBody {
  std::string name, entity;                            // of its part; of its first face that the file names
  std::string reason;                                  // why it was healed
  std::uint64_t faces = 0;                             // before
  std::uint64_t faces_changed = 0, edges_changed = 0;  // those that were replaced or removed
  std::uint64_t pcurves_changed = 0;                   // those that were replaced or added
  double moved_mm =
      0;  // the largest distance of a replaced edge from the one before, measured at points of it
};

struct ImportInfo {
  std::string file, sha256;  // base name of the file; hash of its bytes in lower-case hexadecimal
  std::string format;        // "STEP AP214", "IGES", "BREP"
  std::string unit;          // "millimetre", "inch", … as the file states it
  double unit_mm = 1;        // one file unit in mm
  std::uint64_t faces_declared = 0,
                faces_imported = 0;  // number of face entities in the file; number of faces of all prototypes
  std::vector<Loss> faces_lost, loops_lost, edges_lost;
  std::vector<Approximation> approximated;
  std::vector<HealedBody> healed;     // of STEP files; other formats do not tell
  std::vector<std::string> warnings;  // one sentence for each repair that was made
  double read_ms = 0, transfer_ms = 0, convert_ms = 0;
  std::uint64_t peak_bytes = 0;  // peak memory of the importer process until the model was written
  double max_edge_gap_mm = 0;    // the largest Coedge::gap_mm; the next field names its edge
  std::string max_edge_gap_entity;
};

struct Model {
  ImportInfo info;
  Box3 bounds;  // conservative bounds of the trimmed, placed geometry, mm
  std::vector<Vec4> control_points;
  std::vector<Span> spans;
  std::vector<Surface> surfaces;
  std::vector<Vec3> trim_points;  // (w·u, w·v, w)
  std::vector<TrimSegment> trim_segments;
  std::vector<Coedge> coedges;
  std::vector<Loop> loops;
  std::vector<Vec4> edge_points;
  std::vector<EdgeSegment> edge_segments;
  std::vector<Edge> edges;
  std::vector<Vertex> vertices;
  std::vector<Face> faces;
  std::vector<Solid> solids;
  std::vector<Part> parts;
  std::vector<Instance> instances;

  std::uint32_t PlacedFaceCount() const;
  // The index of the instance that owns placed face `id`, by binary search. Requires id < PlacedFaceCount().
  std::uint32_t InstanceOfPlacedFace(std::uint32_t id) const;
  // The index into `faces` of placed face `id`.
  std::uint32_t FaceOfPlacedFace(std::uint32_t id) const;
  // The name of a placed face, composed of the names of the instance and the face, or of the entity if the
  // file gives no name. It is never empty.
  std::string PlacedFaceName(std::uint32_t id) const;
  // The colour of the face, or else that of the instance, or else the default colour.
  Color PlacedFaceColor(std::uint32_t id) const;
  double Diagonal() const { return bounds.diagonal(); }
};

// Checks law 5. Errors: kFormatBroken (an index or an order is wrong), kNotFinite. The message names the
// vector, the index and the face.
Result<void> Validate(const Model& model);

}  // namespace facetless
