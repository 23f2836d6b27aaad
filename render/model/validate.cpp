// Validate checks law 5 of model.h, with one function per kind of element. Each function returns the first
// violation as a sentence.
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "render/model/model.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

// The range of a patch's largest weight. Outside of it, products with coordinates and with errors of one unit
// roundoff leave the range in which a double has full precision.
constexpr double kLeastWeight = 1e-250, kGreatestWeight = 1e250;

// The tolerance with which consecutive trim segments must meet: a few ulp of the largest coordinate involved,
// for the rounding of the division by the weight and of one shift by a period.
constexpr double kLoopClosureUlps = 64 * std::numeric_limits<double>::epsilon();

using Violation = std::optional<Error>;

Error Broken(const std::string& where, const std::string& what) {
  return Error{ErrorCode::kFormatBroken, where + ": " + what};
}

Error NotFinite(const std::string& where) {
  return Error{ErrorCode::kNotFinite, where + ": a number is not finite"};
}

std::string At(const char* vector, std::size_t index) {
  return std::string(vector) + "[" + std::to_string(index) + "]";
}

template <typename T>
bool InRange(Range range, const std::vector<T>& vector) {
  return std::uint64_t{range.first} + range.count <= vector.size();
}

bool Finite(Vec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}
bool Finite(Vec4 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w);
}

Violation CheckColor(const std::string& where, const Color& color) {
  for (float channel : {color.r, color.g, color.b}) {
    if (!(channel >= 0 && channel <= 1)) return Broken(where, "a colour is outside 0 … 1");
  }
  return {};
}

Violation CheckSpans(const Model& model, const std::string& where, Range range) {
  if (range.count == 0 || !InRange(range, model.spans)) return Broken(where, "its spans are out of range");
  for (const std::uint32_t i : Indices(range)) {
    const Span& span = model.spans[i];
    if (!std::isfinite(span.begin) || !std::isfinite(span.end))
      return NotFinite(where + " " + At("spans", i));
    if (!(span.begin < span.end)) return Broken(where, At("spans", i) + " does not increase");
    if (i > range.first && span.begin != model.spans[i - 1].end)
      return Broken(where, At("spans", i) + " does not abut");
    if (span.map == SpanMap::kHalfAngle && !(span.end - span.begin < std::numbers::pi))
      return Broken(where, At("spans", i) + " is an arc of half a turn or more");
  }
  return {};
}

Violation CheckSurface(const Model& model, std::size_t index, const std::string& owner) {
  const Surface& surface = model.surfaces[index];
  const std::string where = At("surfaces", index) + owner;
  if (surface.degree_u < 1 || surface.degree_v < 1 || surface.degree_u > kMaxDegree ||
      surface.degree_v > kMaxDegree)
    return Broken(where, "its degree is not 1 … 25");
  if (!(surface.period_u >= 0) || !(surface.period_v >= 0) ||
      !std::isfinite(surface.period_u + surface.period_v))
    return Broken(where, "its period is not a number from 0");
  if (Violation bad = CheckSpans(model, where, surface.u_spans)) return bad;
  if (Violation bad = CheckSpans(model, where, surface.v_spans)) return bad;
  // Compare by division, because a product could overflow: both counts may be up to 2^32, and a patch may
  // have 26² points.
  const std::uint64_t available = surface.first_control_point <= model.control_points.size()
                                      ? model.control_points.size() - surface.first_control_point
                                      : 0;
  const std::uint64_t patches = std::uint64_t{surface.u_spans.count} * surface.v_spans.count;
  if (patches > available / surface.PointsPerPatch())
    return Broken(where, "its control points are out of range");
  const std::uint64_t count = patches * surface.PointsPerPatch();
  for (std::uint64_t i = surface.first_control_point; i < surface.first_control_point + count; ++i) {
    const Vec4& point = model.control_points[i];
    if (!Finite(point)) return NotFinite(where + " " + At("control_points", i));
    if (!(point.w > 0)) return Broken(where, At("control_points", i) + " has a weight that is not positive");
    if (!surface.rational && point.w != 1)
      return Broken(where, At("control_points", i) + " has a weight on a polynomial surface");
  }
  for (std::uint64_t patch = 0; surface.rational && patch < patches; ++patch) {
    double largest = 0;
    for (const Vec4& point : PatchPoints(model, surface, static_cast<std::uint32_t>(patch)))
      largest = std::fmax(largest, point.w);
    if (!(largest >= kLeastWeight && largest <= kGreatestWeight))
      return Broken(where, "all weights of a patch are below 1e-250, or one is above 1e250; scale them");
  }
  return {};
}

Vec2 Start(const Model& model, const TrimSegment& segment) {
  const Vec3& p = model.trim_points[segment.first_point];
  return {p.x / p.z, p.y / p.z};
}

Vec2 End(const Model& model, const TrimSegment& segment) {
  const Vec3& p = model.trim_points[segment.first_point + segment.degree];
  return {p.x / p.z, p.y / p.z};
}

Violation CheckTrimSegment(const Model& model, std::size_t index, const std::string& owner) {
  const TrimSegment& segment = model.trim_segments[index];
  const std::string where = At("trim_segments", index) + owner;
  if (segment.degree < 1 || segment.degree > kMaxDegree) return Broken(where, "its degree is not 1 … 25");
  if (!InRange({segment.first_point, segment.degree + 1u}, model.trim_points))
    return Broken(where, "its points are out of range");
  if (!std::isfinite(segment.edge_begin) || !std::isfinite(segment.edge_end)) return NotFinite(where);
  for (std::uint32_t i = segment.first_point; i <= segment.first_point + segment.degree; ++i) {
    if (!Finite(model.trim_points[i])) return NotFinite(where + " " + At("trim_points", i));
    if (!(model.trim_points[i].z > 0))
      return Broken(where, At("trim_points", i) + " has a weight that is not positive");
  }
  return {};
}

Violation CheckLoop(const Model& model, std::size_t index, const std::string& owner) {
  const Loop& loop = model.loops[index];
  const std::string where = At("loops", index) + owner;
  if (loop.coedges.count == 0 || !InRange(loop.coedges, model.coedges))
    return Broken(where, "its coedges are out of range");
  // Check each coedge and gather the loop's segments in order.
  std::vector<std::uint32_t> segments;
  for (const std::uint32_t i : Indices(loop.coedges)) {
    const Coedge& coedge = model.coedges[i];
    const std::string coedge_where = At("coedges", i) + owner;
    if (coedge.edge != kNoIndex && coedge.edge >= model.edges.size())
      return Broken(coedge_where, "its edge is out of range");
    if (coedge.segments.count == 0 || !InRange(coedge.segments, model.trim_segments))
      return Broken(coedge_where, "its segments are out of range");
    if (!(coedge.gap_mm >= 0) || !std::isfinite(coedge.gap_mm)) return NotFinite(coedge_where);
    for (const std::uint32_t s : Indices(coedge.segments)) {
      if (Violation bad = CheckTrimSegment(model, s, owner)) return bad;
      segments.push_back(s);
    }
  }
  // Find the largest coordinate of the loop, to which rounding errors are relative.
  double size = 0;
  for (std::uint32_t s : segments) {
    const Vec2 end = End(model, model.trim_segments[s]);
    size = std::fmax(size, std::fmax(std::fabs(end.x), std::fabs(end.y)));
  }
  // Each segment must start where the previous one ends, and the first where the last one ends.
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Vec2 end = End(model, model.trim_segments[segments[i]]);
    const Vec2 start = Start(model, model.trim_segments[segments[(i + 1) % segments.size()]]);
    if (!(std::fabs(end.x - start.x) <= kLoopClosureUlps * size &&
          std::fabs(end.y - start.y) <= kLoopClosureUlps * size))
      return Broken(where, At("trim_segments", segments[i]) + " does not end where the next one starts");
  }
  return {};
}

Violation CheckEdge(const Model& model, std::size_t index) {
  const Edge& edge = model.edges[index];
  const std::string where = At("edges", index);
  if (!InRange(edge.segments, model.edge_segments)) return Broken(where, "its segments are out of range");
  if (edge.degenerate != (edge.segments.count == 0))
    return Broken(where, "it must have a curve unless it is degenerate");
  if (!(edge.tolerance_mm >= 0) || !std::isfinite(edge.tolerance_mm)) return NotFinite(where);
  for (std::uint32_t vertex : edge.vertices) {
    if (vertex != kNoIndex && vertex >= model.vertices.size())
      return Broken(where, "a vertex is out of range");
  }
  for (const std::uint32_t s : Indices(edge.segments)) {
    const EdgeSegment& segment = model.edge_segments[s];
    const std::string segment_where = At("edge_segments", s);
    if (segment.degree < 1 || segment.degree > kMaxDegree)
      return Broken(segment_where, "its degree is not 1 … 25");
    if (!InRange({segment.first_point, segment.degree + 1u}, model.edge_points))
      return Broken(segment_where, "its points are out of range");
    if (!std::isfinite(segment.begin) || !std::isfinite(segment.end)) return NotFinite(segment_where);
    if (!(segment.begin < segment.end)) return Broken(segment_where, "its parameter does not increase");
    for (std::uint32_t i = segment.first_point; i <= segment.first_point + segment.degree; ++i) {
      if (!Finite(model.edge_points[i])) return NotFinite(segment_where + " " + At("edge_points", i));
      if (!(model.edge_points[i].w > 0))
        return Broken(segment_where, At("edge_points", i) + " has a weight that is not positive");
    }
  }
  return {};
}

Violation CheckFace(const Model& model, std::size_t index) {
  const Face& face = model.faces[index];
  const std::string where = At("faces", index);
  const std::string owner = " of " + where + (face.entity.empty() ? "" : " (" + face.entity + ")");
  if (face.surface >= model.surfaces.size()) return Broken(where, "its surface is out of range");
  if (face.solid != kNoIndex && face.solid >= model.solids.size())
    return Broken(where, "its solid is out of range");
  if (!InRange(face.loops, model.loops)) return Broken(where, "its loops are out of range");
  if (!(face.tolerance_mm >= 0) || !std::isfinite(face.tolerance_mm)) return NotFinite(where);
  if (Violation bad = CheckColor(where, face.color)) return bad;
  if (Violation bad = CheckSurface(model, face.surface, owner)) return bad;
  for (const std::uint32_t i : Indices(face.loops)) {
    if (Violation bad = CheckLoop(model, i, owner)) return bad;
  }
  return {};
}

// Checks that parts own consecutive faces and solids, that every face and solid has an owner, and that
// placed-face ids are dense.
Violation CheckStructure(const Model& model) {
  std::uint64_t next_face = 0, next_solid = 0;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const Part& part = model.parts[i];
    if (part.faces.first != next_face || part.solids.first != next_solid)
      return Broken(At("parts", i), "its faces or solids do not follow those of the part before");
    next_face += part.faces.count;
    next_solid += part.solids.count;
    if (next_face > model.faces.size() || next_solid > model.solids.size())
      return Broken(At("parts", i), "its faces or solids are out of range");
    for (std::uint64_t s = part.solids.first; s < next_solid; ++s) {
      if (model.solids[s].part != i) return Broken(At("solids", s), "it names another part than its own");
    }
    for (std::uint64_t f = part.faces.first; f < next_face; ++f) {
      const std::uint32_t solid = model.faces[f].solid;
      if (solid != kNoIndex && (solid < part.solids.first || solid >= next_solid))
        return Broken(At("faces", f), "its solid belongs to another part");
    }
  }
  if (next_face != model.faces.size()) return Broken("faces", "some belong to no part");
  if (next_solid != model.solids.size()) return Broken("solids", "some belong to no part");
  std::uint64_t next_placed = 0;
  for (std::size_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    const std::string where = At("instances", i);
    if (instance.part >= model.parts.size()) return Broken(where, "its part is out of range");
    if (instance.first_placed_face != next_placed)
      return Broken(where, "its placed faces do not follow those of the one before");
    next_placed += model.parts[instance.part].faces.count;
    if (next_placed >= kNoIndex) return Broken(where, "there are more than 2^32 placed faces");
    for (const auto& row : instance.placement.m) {
      for (double value : row) {
        if (!std::isfinite(value)) return NotFinite(where);
      }
    }
    const double determinant = instance.placement.Determinant();
    if (!std::isfinite(determinant) || determinant == 0) return Broken(where, "its placement is singular");
    if (Violation bad = CheckColor(where, instance.color)) return bad;
  }
  return {};
}

Violation CheckInfo(const Model& model) {
  const ImportInfo& info = model.info;
  for (const auto* losses : {&info.faces_lost, &info.loops_lost, &info.edges_lost}) {
    for (const Loss& loss : *losses) {
      if (loss.face != kNoIndex && loss.face >= model.faces.size())
        return Broken("info", "a loss names a face out of range");
    }
  }
  for (const Approximation& approximation : info.approximated) {
    if (approximation.face >= model.faces.size())
      return Broken("info", "an approximation names a face out of range");
    if (!(approximation.deviation_mm >= 0) || !std::isfinite(approximation.deviation_mm))
      return NotFinite("info");
  }
  for (const HealedBody& body : info.healed)
    if (!(body.moved_mm >= 0) || !std::isfinite(body.moved_mm)) return NotFinite("info");
  for (double value : {info.unit_mm, info.read_ms, info.transfer_ms, info.convert_ms, info.max_edge_gap_mm}) {
    if (!std::isfinite(value)) return NotFinite("info");
  }
  return {};
}

Violation FirstViolation(const Model& model) {
  if (Violation bad = CheckStructure(model)) return bad;
  for (std::size_t i = 0; i < model.vertices.size(); ++i) {
    if (!Finite(model.vertices[i].point) || !(model.vertices[i].tolerance_mm >= 0))
      return NotFinite(At("vertices", i));
  }
  for (std::size_t i = 0; i < model.edges.size(); ++i) {
    if (Violation bad = CheckEdge(model, i)) return bad;
  }
  for (std::size_t i = 0; i < model.faces.size(); ++i) {
    if (Violation bad = CheckFace(model, i)) return bad;
  }
  if (model.PlacedFaceCount() > 0 &&
      (model.bounds.empty() || !Finite(model.bounds.low) || !Finite(model.bounds.high)))
    return Broken("bounds", "they are empty or infinite");
  return CheckInfo(model);
}

}  // namespace

Result<void> Validate(const Model& model) {
  if (Violation bad = FirstViolation(model)) return *bad;
  return {};
}

}  // namespace facetless
