// The exact model: what the importer makes of a CAD file and what every renderer reads.
//
//  1. Lengths are millimetres, angles radians. The file's own unit is recorded, never used again.
//  2. A model is flat: parts own consecutive faces, faces own consecutive loops, loops own consecutive
//     coedges, coedges own consecutive trim segments. Cross-references are indices into the vectors of Model.
//  3. Geometry is exact: every surface is a grid of (rational) Bézier patches, every p-curve a chain of
//     (rational) Bézier segments in the surface's *native* parameters (an angle stays an angle), every edge a
//     chain of 3D Bézier segments. What could only be approximated says so with a measured deviation.
//  4. Instances place parts. A face of an instance is a *placed face*; its id is Instance::first_placed_face
//     + the face's index within its part. Placed-face ids are dense: 0 … placed_face_count − 1.
//  5. Validate() holds for every Model that leaves ReadModel or enters WriteModel: indices in range, numbers
//     finite, weights positive, loops closed in order, spans increasing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/base/vec.h"

namespace facetless {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

// The highest degree of a surface, a p-curve or an edge: the most that OpenCASCADE, with which the importer
// reads, accepts (Geom_BSplineSurface::MaxDegree).
inline constexpr int kMaxDegree = 25;

// A half-open run [first, first + count) of one of Model's vectors.
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

// How a span's Bézier parameter t ∈ [0,1] runs through its native interval [begin, end].
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

// A tensor-product grid of u_spans.count × v_spans.count Bézier patches of one bidegree. Patch (i, j) spans
// u_spans[i] × v_spans[j]; its control points lie at
//   first_control_point + ((i·v_spans.count + j)·(degree_u+1) + k)·(degree_v+1) + l,   k along u, l along v.
// Consecutive spans abut; interior borders may be only C0. Only spans that the face's loops can reach are
// kept.
struct Surface {
  SurfaceKind kind = SurfaceKind::kBspline;
  std::uint8_t degree_u = 1, degree_v = 1;
  bool rational = false;      // false: every w is exactly 1
  bool extendable_u = false;  // the patches reach beyond the face's loops on both ends of u, or close upon
  bool extendable_v = false;  // themselves; false: the loops may run along the patch border itself
  double period_u = 0, period_v = 0;  // 0: not periodic in native parameters
  Range u_spans, v_spans;             // into Model::spans
  std::uint32_t first_control_point = 0;
  std::uint32_t PatchCount() const { return u_spans.count * v_spans.count; }
  std::uint32_t PointsPerPatch() const { return (degree_u + 1u) * (degree_v + 1u); }
};

// A rational Bézier segment of a p-curve: degree + 1 points (w·u, w·v, w) in Model::trim_points. [edge_begin,
// edge_end] is the matching stretch of the coedge's edge parameter, linear in the segment's own parameter in
// [0,1]; edge_begin > edge_end where the coedge runs against its edge.
struct TrimSegment {
  std::uint8_t degree = 1;
  std::uint32_t first_point = 0;
  double edge_begin = 0, edge_end = 1;
};

// One use of an edge by a loop. Segments run in loop order: the face lies on the left of the p-curve in (u,v)
// if the face is not `reversed`… and also if it is: loops are stored for the *surface's* own orientation,
// material on the left.
struct Coedge {
  std::uint32_t edge = kNoIndex;  // kNoIndex: no 3D edge is known (a natural border made for the face)
  bool reversed = false;          // runs against its edge
  bool from_file = false;         // the p-curve is the file's; false: computed from the 3D edge
  Range segments;                 // into Model::trim_segments
  double gap_mm = 0;              // largest measured distance of the p-curve on the surface to the 3D edge
};

struct Loop {
  Range coedges;  // into Model::coedges
};

// A rational Bézier segment of an edge's 3D curve: degree + 1 homogeneous points in Model::edge_points, over
// the edge parameter [begin, end], linear in the segment's own parameter.
struct EdgeSegment {
  std::uint8_t degree = 1;
  std::uint32_t first_point = 0;
  double begin = 0, end = 1;
};

struct Edge {
  Range segments;  // into Model::edge_segments; empty for a degenerate (collapsed) edge
  std::uint32_t vertices[2] = {kNoIndex, kNoIndex};  // into Model::vertices; equal for a closed edge
  double tolerance_mm = 0;                           // as recorded in the file or by the importer
  bool degenerate = false;                           // collapsed to a point: has p-curves only
  std::uint32_t coedge_count = 0;  // uses by all faces of the part: 2 in the interior of a closed shell
  std::string entity;              // "#123" where known
};

struct Vertex {
  Vec3 point;
  double tolerance_mm = 0;
};

struct Face {
  std::uint32_t surface = 0;       // into Model::surfaces; each face has its own
  Range loops;                     // into Model::loops; none: the whole patch grid is the face
  bool reversed = false;           // outward normal = −(Su × Sv)
  std::uint32_t solid = kNoIndex;  // into Model::solids
  bool has_color = false;
  Color color;
  double tolerance_mm = 0;
  std::string name;    // from the file, or ""
  std::string entity;  // "#123", "D57": where the file defines it
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
  bool has_color = false;  // overrides where a face has no colour of its own
  Color color;
  std::string name;  // path of occurrence names, "car/wheel:2"
  std::uint32_t first_placed_face = 0;
  bool hidden = false;  // the file says that it is not to be shown; arrangements leave it out unless asked
};

// Something that the file declares and the model does not hold.
struct Loss {
  std::uint32_t face =
      kNoIndex;  // index into Model::faces of the face that lost a loop or an edge; kNoIndex: the face itself
  std::string name, entity, reason;
};
struct Approximation {
  std::uint32_t face = 0;
  double deviation_mm = 0;  // measured, of the patches to the surface that they stand for
};

struct ImportInfo {
  std::string file, sha256;                              // base name; lower-case hex of the file's bytes
  std::string format;                                    // "STEP AP214", "IGES", "BREP"
  std::string unit;                                      // "millimetre", "inch", … as the file says
  double unit_mm = 1;                                    // one file unit in mm
  std::uint64_t faces_declared = 0, faces_imported = 0;  // entities in the file, prototypes
  std::vector<Loss> faces_lost, loops_lost, edges_lost;
  std::vector<Approximation> approximated;
  std::vector<std::string> warnings;  // repairs that were made, one sentence each
  double read_ms = 0, transfer_ms = 0, convert_ms = 0;
  std::uint64_t peak_bytes = 0;  // of the importer process until the model was written
  double max_edge_gap_mm = 0;    // the largest Coedge::gap_mm, and where
  std::string max_edge_gap_entity;
};

struct Model {
  ImportInfo info;
  Box3 bounds;  // of the trimmed, placed geometry, conservative
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
  // The instance that holds placed face `id`, by binary search. Requires id < PlacedFaceCount().
  std::uint32_t InstanceOf(std::uint32_t id) const;
  // The index into `faces` of placed face `id`.
  std::uint32_t FaceOf(std::uint32_t id) const;
  // A face's name, made up from the instance's, the face's and its entity where the file gives none. Never
  // empty.
  std::string PlacedFaceName(std::uint32_t id) const;
  // The face's colour, else the instance's, else the default.
  Color PlacedFaceColor(std::uint32_t id) const;
  double Diagonal() const { return bounds.diagonal(); }
};

// Law 5 above. kFormatBroken (index, order), kNotFinite: the message names the vector, the index and the
// face.
Result<void> Validate(const Model& model);

}  // namespace facetless
