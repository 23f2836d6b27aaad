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
//  2. Every Add… function whose element other elements can refer to returns the index of the element.
//  3. The builder fills in the fields that follow from the others, and overwrites the caller's values there:
//     all ranges and first points, Face::surface, Solid::part, Edge::coedge_count,
//     Instance::first_placed_face, the degrees of segments, Surface::rational if a weight is not 1, and the
//     model's bounds unless SetBounds was called.
//  4. Finish() validates the model. It returns a model for which Validate() holds, or the error of
//     Validate(). It returns kBadUsage if an element was added before its owner, or if the number of control
//     points of a surface does not match its spans and degrees.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/model/model.h"

namespace facetless {

// A surface that is not yet part of a model. The laws of model.h apply; the vectors belong to the grid.
struct SurfaceGrid {
  SurfaceKind kind = SurfaceKind::kBspline;
  int degree_u = 1, degree_v = 1;
  std::vector<Span> u_spans, v_spans;
  std::vector<Vec4> points;  // patch by patch, in the order of Model::control_points
  bool rational = false;     // true: the surface stays rational even if all weights are 1
  bool extendable_u = false, extendable_v = false;
  double period_u = 0, period_v = 0;
};

class ModelBuilder {
 public:
  ModelBuilder() = default;
  // Continues a finished model after its last part, face and loop. The bounds of the model are kept.
  explicit ModelBuilder(Model model);

  ImportInfo& info() { return model_.info; }
  // The elements added so far. Placed-face ids and bounds are not valid before Finish().
  const Model& model() const { return model_; }

  std::uint32_t AddPart(std::string name);
  // Adds a face with a surface of its own. The surface and the loops in `face` are ignored.
  std::uint32_t AddFace(const SurfaceGrid& surface, Face face = {});
  std::uint32_t AddLoop();
  std::uint32_t AddCoedge(Coedge coedge);
  // Adds a segment with control points (w·u, w·v, w). Its degree is one less than the number of points.
  void AddTrimSegment(std::span<const Vec3> points, double edge_begin = 0, double edge_end = 1);

  std::uint32_t AddVertex(Vec3 point, double tolerance_mm = 0);
  std::uint32_t AddEdge(Edge edge);
  void AddEdgeSegment(std::span<const Vec4> points, double begin = 0, double end = 1);

  std::uint32_t AddSolid(bool closed, std::string name = {});
  // Requires a face that has been added.
  void SetSolid(std::uint32_t face, std::uint32_t solid) { model_.faces[face].solid = solid; }
  std::uint32_t AddInstance(Instance instance);

  // Sets the model's bounds. Without this call, the bounds are the box of the placed control points, enlarged
  // by the largest gap of each face.
  void SetBounds(const Box3& bounds);

  // Completes and validates the model (law 4).
  Result<Model> Finish() &&;

 private:
  void Misused(const std::string& what);
  void Ownerless(const std::string& element, const std::string& owner);
  void PlaceInstances();
  Box3 ControlPointBounds() const;

  Model model_;
  bool bounds_are_set_ = false;
  std::string misuse_;  // the first misuse of the builder; empty if there was none
};

}  // namespace facetless
