// Builds a model element by element.
//
//     ModelBuilder builder;
//     builder.AddPart("plate");
//     builder.AddFace({SurfaceKind::kPlane, 1, 1, {{0, 10}}, {{0, 10}}, points});
//     builder.AddLoop();
//     for (int side = 0; side < 4; ++side) {
//       builder.AddCoedge({});
//       builder.AddTrimSegment(std::array{corners[side], corners[side + 1]});
//     }
//     builder.AddInstance({});
//     Result<Model> model = std::move(builder).Finish();
//
//  1. Each element belongs to the owner that was added last: a face and a solid to the part, a loop to the
//     face, a coedge to the loop, a trim segment to the coedge, an edge segment to the edge. Edges and
//     vertices may be added at any time before they are named.
//  2. Every Add… that makes an element others can name returns its index.
//  3. The builder fills in what follows from the rest, and overwrites what the caller wrote there: all ranges
//     and first points, a face's surface, Solid::part, Edge::coedge_count, Instance::first_placed_face,
//     degrees of segments, Surface::rational where a weight is not 1, and the model's bounds unless SetBounds
//     said them.
//  4. Finish() validates: it returns a model for which Validate() holds, or Validate()'s error. kBadUsage: an
//     element was added before its owner, or a surface has more or fewer control points than its spans and
//     degrees need.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/model/model.h"

namespace facetless {

// A surface of model.h before it has a place in a model: the same laws, with vectors of its own.
struct SurfaceGrid {
  SurfaceKind kind = SurfaceKind::kBspline;
  int degree_u = 1, degree_v = 1;
  std::vector<Span> u_spans, v_spans;
  std::vector<Vec4> points;  // patch after patch, in the model's order
  bool rational = false;     // true: kept even if all weights are 1
  bool extendable_u = false, extendable_v = false;
  double period_u = 0, period_v = 0;
};

class ModelBuilder {
 public:
  ModelBuilder() = default;
  // Goes on where a finished model ends: with its last part, face and loop. Its bounds are kept.
  explicit ModelBuilder(Model model);

  ImportInfo& info() { return model_.info; }
  // What has been added so far. Its placed-face ids and bounds are those of Finish() only.
  const Model& model() const { return model_; }

  std::uint32_t AddPart(std::string name);
  // A face on a surface of its own. Of `face`, everything but the surface and the loops counts.
  std::uint32_t AddFace(const SurfaceGrid& surface, Face face = {});
  std::uint32_t AddLoop();
  std::uint32_t AddCoedge(Coedge coedge);
  // (w·u, w·v, w); the degree is one less than the number of points.
  void AddTrimSegment(std::span<const Vec3> points, double edge_begin = 0, double edge_end = 1);

  std::uint32_t AddVertex(Vec3 point, double tolerance_mm = 0);
  std::uint32_t AddEdge(Edge edge);
  void AddEdgeSegment(std::span<const Vec4> points, double begin = 0, double end = 1);

  std::uint32_t AddSolid(bool closed, std::string name = {});
  // Requires a face that was added.
  void SetSolid(std::uint32_t face, std::uint32_t solid) { model_.faces[face].solid = solid; }
  std::uint32_t AddInstance(Instance instance);

  // By default the bounds are those of the placed control points, wider by the largest gap of each face.
  void SetBounds(const Box3& bounds);

  // Law 4.
  Result<Model> Finish() &&;

 private:
  void Misused(const std::string& what);
  void Ownerless(const std::string& element, const std::string& owner);
  void PlaceInstances();
  Box3 ControlPointBounds() const;

  Model model_;
  bool bounds_are_set_ = false;
  std::string misuse_;  // the first one
};

}  // namespace facetless
