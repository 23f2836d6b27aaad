#include "render/model/builder.h"

#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "render/model/walk.h"

namespace facetless {
namespace {

std::uint32_t Size(std::size_t size) {
  return static_cast<std::uint32_t>(size);
}

// Degrees are 8 bits wide in the model. A degree that does not fit is replaced by one that Validate()
// refuses.
std::uint8_t Degree(std::int64_t degree) {
  return static_cast<std::uint8_t>(degree < 0 || degree > 255 ? 255 : degree);
}

template <typename T>
std::uint32_t Append(std::vector<T>& vector, T element) {
  vector.push_back(std::move(element));
  return Size(vector.size()) - 1;
}

template <typename T>
Range AppendAll(std::vector<T>& vector, std::span<const T> elements) {
  const Range range{Size(vector.size()), Size(elements.size())};
  vector.insert(vector.end(), elements.begin(), elements.end());
  return range;
}

// An empty range at the end of `vector`.
template <typename T>
Range Next(const std::vector<T>& vector) {
  return {Size(vector.size()), 0};
}

// Extends `range` for the next element of `vector`.
template <typename T>
void Grow(Range& range, const std::vector<T>& vector) {
  if (range.count == 0) range = Next(vector);
  ++range.count;
}

}  // namespace

ModelBuilder::ModelBuilder(Model model) : model_(std::move(model)), bounds_are_set_(true) {}

void ModelBuilder::Misused(const std::string& what) {
  if (misuse_.empty()) misuse_ = what;
}

void ModelBuilder::Ownerless(const std::string& element, const std::string& owner) {
  Misused("The model has " + element + " that was added before " + owner + ": add " + owner + " first.");
}

std::uint32_t ModelBuilder::AddPart(std::string name) {
  Part part;
  part.name = std::move(name);
  part.faces = Next(model_.faces);
  part.solids = Next(model_.solids);
  return Append(model_.parts, std::move(part));
}

std::uint32_t ModelBuilder::AddFace(const SurfaceGrid& grid, Face face) {
  Surface surface;
  surface.kind = grid.kind;
  surface.degree_u = Degree(grid.degree_u);
  surface.degree_v = Degree(grid.degree_v);
  surface.rational = grid.rational;
  for (const Vec4& p : grid.points) surface.rational = surface.rational || p.w != 1;
  surface.extendable_u = grid.extendable_u;
  surface.extendable_v = grid.extendable_v;
  surface.period_u = grid.period_u;
  surface.period_v = grid.period_v;
  surface.u_spans = AppendAll<Span>(model_.spans, grid.u_spans);
  surface.v_spans = AppendAll<Span>(model_.spans, grid.v_spans);
  surface.first_control_point = AppendAll<Vec4>(model_.control_points, grid.points).first;
  if (const std::size_t needed = std::size_t{surface.PatchCount()} * surface.PointsPerPatch();
      needed != grid.points.size())
    Misused("The surface of faces[" + std::to_string(model_.faces.size()) + "] has " +
            std::to_string(grid.points.size()) + " control points; its spans and degrees need " +
            std::to_string(needed) + ".");
  face.surface = Append(model_.surfaces, surface);
  face.loops = Next(model_.loops);
  if (model_.parts.empty()) {
    Ownerless("a face", "a part");
  } else {
    Grow(model_.parts.back().faces, model_.faces);
  }
  return Append(model_.faces, std::move(face));
}

std::uint32_t ModelBuilder::AddLoop() {
  if (model_.faces.empty()) {
    Ownerless("a loop", "a face");
  } else {
    Grow(model_.faces.back().loops, model_.loops);
  }
  return Append(model_.loops, Loop{Next(model_.coedges)});
}

std::uint32_t ModelBuilder::AddCoedge(Coedge coedge) {
  coedge.segments = Next(model_.trim_segments);
  if (model_.loops.empty()) {
    Ownerless("a coedge", "a loop");
  } else {
    Grow(model_.loops.back().coedges, model_.coedges);
  }
  // Validate() refuses an edge that does not exist.
  if (coedge.edge < model_.edges.size()) ++model_.edges[coedge.edge].coedge_count;
  return Append(model_.coedges, coedge);
}

void ModelBuilder::AddTrimSegment(std::span<const Vec3> points, double edge_begin, double edge_end) {
  if (model_.coedges.empty()) {
    Ownerless("a trim segment", "a coedge");
  } else {
    Grow(model_.coedges.back().segments, model_.trim_segments);
  }
  const std::uint32_t first = AppendAll(model_.trim_points, points).first;
  model_.trim_segments.push_back({Degree(std::ssize(points) - 1), first, edge_begin, edge_end});
}

std::uint32_t ModelBuilder::AddVertex(Vec3 point, double tolerance_mm) {
  return Append(model_.vertices, Vertex{point, tolerance_mm});
}

std::uint32_t ModelBuilder::AddEdge(Edge edge) {
  edge.segments = Next(model_.edge_segments);
  edge.coedge_count = 0;
  return Append(model_.edges, std::move(edge));
}

void ModelBuilder::AddEdgeSegment(std::span<const Vec4> points, double begin, double end) {
  if (model_.edges.empty()) {
    Ownerless("an edge segment", "an edge");
  } else {
    Grow(model_.edges.back().segments, model_.edge_segments);
  }
  const std::uint32_t first = AppendAll(model_.edge_points, points).first;
  model_.edge_segments.push_back({Degree(std::ssize(points) - 1), first, begin, end});
}

std::uint32_t ModelBuilder::AddSolid(bool closed, std::string name) {
  if (model_.parts.empty()) {
    Ownerless("a solid", "a part");
  } else {
    Grow(model_.parts.back().solids, model_.solids);
  }
  return Append(model_.solids, Solid{Size(model_.parts.size()) - 1, closed, std::move(name)});
}

std::uint32_t ModelBuilder::AddInstance(Instance instance) {
  return Append(model_.instances, std::move(instance));
}

void ModelBuilder::SetBounds(const Box3& bounds) {
  model_.bounds = bounds;
  bounds_are_set_ = true;
}

// Assigns dense placed-face ids (law 4 of model.h). Validate() refuses instances of parts that do not exist.
void ModelBuilder::PlaceInstances() {
  std::uint32_t next = 0;
  for (Instance& instance : model_.instances) {
    instance.first_placed_face = next;
    if (instance.part < model_.parts.size()) next += FacesOf(model_, instance).count;
  }
}

Box3 ModelBuilder::ControlPointBounds() const {
  Box3 bounds;
  for (const Instance& instance : model_.instances) {
    for (const std::uint32_t f : Indices(FacesOf(model_, instance))) {
      const Face& face = model_.faces[f];
      Box3 box;
      for (const Vec4& p : PointsOf(model_, model_.surfaces[face.surface])) {
        const Vec3 placed = instance.placement.Point({p.x / p.w, p.y / p.w, p.z / p.w});
        // A box cannot contain such a point. Return an empty box, which Validate() refuses.
        if (!std::isfinite(placed.x + placed.y + placed.z)) return {};
        box.Add(placed);
      }
      if (box.empty()) continue;
      const double gap = LargestGap(model_, face);
      bounds.Add(box.low - Vec3{gap, gap, gap});
      bounds.Add(box.high + Vec3{gap, gap, gap});
    }
  }
  return bounds;
}

Result<Model> ModelBuilder::Finish() && {
  if (!misuse_.empty()) return Error{ErrorCode::kBadUsage, misuse_};
  PlaceInstances();
  // Validate with placeholder bounds first, because computing the bounds requires valid indices.
  if (!bounds_are_set_) model_.bounds = {{0, 0, 0}, {0, 0, 0}};
  if (const Result<void> valid = Validate(model_); !valid) return valid.error();
  if (!bounds_are_set_) {
    model_.bounds = ControlPointBounds();
    const bool sound = !model_.bounds.empty() && std::isfinite(model_.bounds.diagonal());
    if (const Result<void> valid = sound ? Result<void>() : Validate(model_); !valid) return valid.error();
  }
  return std::move(model_);
}

}  // namespace facetless
