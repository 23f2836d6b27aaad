// SolverScene: the surfaces of a view, as solvers (solver.h) read them: Bézier patches in space and projected, and how
// they form faces.
//
//     SolverScene scene(frame, model.bounds.center());
//     scene.AddFace(model, face, placement, placed_face, &trim, classes);
//     const SolverPatch& patch = scene.patches()[0];
//     const PatchJet<3> jet = EvaluatePatch<3>(&scene.screen(patch)->x, patch.degree_u, patch.degree_v, u, v);
//
//  1. Points in space are homogeneous, (w·x, w·y, w·z, w), in model axes and mm, relative to `origin`, so that a model far
//     from its origin loses no precision. Projected points are those of ViewProjection: a ray through pixel
//     coordinates (x, y), relative to the image centre, is X − x·W = 0 and Y − y·W = 0. Both nets have
//     (degree_u+1)·(degree_v+1) points, and the index of v varies fastest.
//  2. Weights in space are positive. Projected W is not positive behind the eye of a perspective view.
//  3. The patches of a face form a grid, row by row along v. Patches that are proven to be trimmed away have no place in
//     `patches`; the grid has kNoIndex for them.
//  4. Parameters of a patch lie in [0,1]; FaceParameters maps them to the native parameters of the face.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/vec.h"
#include "render/model/model.h"
#include "render/nurbs/angle_map.h"
#include "render/nurbs/trim_index.h"
#include "render/view/camera.h"
#include "render/view/projection.h"

namespace facetless {

struct SolverPatch {
  int degree_u = 1, degree_v = 1;
  bool rational = false;
  std::uint32_t face = 0;      // index into SolverScene::faces
  std::uint32_t i = 0, j = 0;  // its place in the grid of the face
  std::uint64_t first_point = 0;
  int points() const { return (degree_u + 1) * (degree_v + 1); }
};

struct SolverFace {
  std::uint32_t placed_face = 0;
  const Face* face = nullptr;      // null: an untrimmed patch without a model
  const FaceTrim* trim = nullptr;  // null: untrimmed
  double outward = 1;  // the outward normal is this times Su × Sv of the placed surface: 1 or −1
  std::uint32_t columns = 1, rows = 1;     // patches along u and along v
  std::uint64_t first_patch = 0;           // into the grid: patch (i, j) is grid[first_patch + i·rows + j]
  std::uint64_t first_u = 0, first_v = 0;  // into the span maps
};

class SolverScene {
 public:
  // `origin`: the point to which points in space are relative, mm.
  SolverScene(const CameraFrame& frame, Vec3 origin) : frame_(frame), origin_(origin) {}

  // Adds a placed face. `trim` and the model must outlive the scene. `classes` has the class of each patch against the
  // trimming; empty: none is proven to be trimmed away.
  void AddFace(const Model& model, std::uint32_t face, const Placement& placement, std::uint32_t placed_face,
               const FaceTrim* trim, std::span<const RectClass> classes);
  // Adds an untrimmed face of a single patch. `points` are homogeneous, in model axes, not relative to the origin.
  void AddPatch(int degree_u, int degree_v, std::span<const Vec4> points);

  const CameraFrame& frame() const { return frame_; }
  Vec3 origin() const { return origin_; }
  std::span<const SolverPatch> patches() const { return patches_; }
  std::span<const SolverFace> faces() const { return faces_; }
  const Vec4* space(const SolverPatch& patch) const { return space_.data() + patch.first_point; }
  const ViewProjection::Point* screen(const SolverPatch& patch) const {
    return screen_.data() + patch.first_point;
  }
  // The index into patches() of patch (i, j) of a face; kNoIndex if it is trimmed away.
  std::uint32_t PatchAt(const SolverFace& face, std::uint32_t i, std::uint32_t j) const {
    return grid_[face.first_patch + std::uint64_t{i} * face.rows + j];
  }
  // Maps parameters of a patch to native parameters.
  Vec2 Native(const SolverPatch& patch, double u, double v) const;
  // The native ends of the spans of a face: columns + 1 values along u, rows + 1 along v.
  std::vector<double> NativeBreaks(const SolverFace& face, bool along_u) const;

  std::uint64_t bytes() const;

 private:
  void AddPoints(std::span<const Vec4> points, const ViewProjection& projection, const Placement& placement);

  CameraFrame frame_;
  Vec3 origin_;
  std::vector<SolverPatch> patches_;
  std::vector<SolverFace> faces_;
  std::vector<std::uint32_t> grid_;
  std::vector<SpanParameter> maps_;
  std::vector<Vec4> space_;
  std::vector<ViewProjection::Point> screen_;
};

}  // namespace facetless
