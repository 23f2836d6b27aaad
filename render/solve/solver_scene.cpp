#include "render/solve/solver_scene.h"

#include "render/model/walk.h"

namespace facetless {

void SolverScene::AddPoints(std::span<const Vec4> points, const ViewProjection& projection,
                            const Placement& placement) {
  for (const Vec4& p : points) {
    const Vec3 placed = placement.Point({p.x / p.w, p.y / p.w, p.z / p.w}) - origin_;
    space_.push_back({p.w * placed.x, p.w * placed.y, p.w * placed.z, p.w});
    screen_.push_back(projection(p));
  }
}

void SolverScene::AddFace(const Model& model, std::uint32_t face, const Placement& placement,
                          std::uint32_t placed_face, const FaceTrim* trim,
                          std::span<const RectClass> classes) {
  const Surface& surface = model.surfaces[model.faces[face].surface];
  const ViewProjection projection(frame_, placement);
  SolverFace out;
  out.placed_face = placed_face;
  out.face = &model.faces[face];
  out.trim = trim;
  out.outward = (out.face->reversed ? -1 : 1) * (placement.Determinant() < 0 ? -1 : 1);
  out.columns = surface.u_spans.count;
  out.rows = surface.v_spans.count;
  out.first_patch = grid_.size();
  out.first_u = maps_.size();
  out.first_v = maps_.size() + surface.u_spans.count;
  for (const Range& spans : {surface.u_spans, surface.v_spans})
    for (std::uint32_t s = spans.first; s < spans.end(); ++s) maps_.emplace_back(model.spans[s]);
  for (std::uint32_t i = 0; i < out.columns; ++i)
    for (std::uint32_t j = 0; j < out.rows; ++j) {
      const std::uint32_t index = i * out.rows + j;
      if (!classes.empty() && classes[index] == RectClass::kOutside) {
        grid_.push_back(kNoIndex);
        continue;
      }
      grid_.push_back(static_cast<std::uint32_t>(patches_.size()));
      patches_.push_back({surface.degree_u, surface.degree_v, surface.rational,
                          static_cast<std::uint32_t>(faces_.size()), i, j, space_.size()});
      AddPoints(PatchPoints(model, surface, index), projection, placement);
    }
  faces_.push_back(out);
}

void SolverScene::AddPatch(int degree_u, int degree_v, std::span<const Vec4> points) {
  SolverFace out;
  out.placed_face = static_cast<std::uint32_t>(faces_.size());
  out.first_patch = grid_.size();
  out.first_u = maps_.size();
  out.first_v = maps_.size() + 1;
  maps_.resize(maps_.size() + 2);
  bool rational = false;
  for (const Vec4& p : points) rational = rational || p.w != 1;
  grid_.push_back(static_cast<std::uint32_t>(patches_.size()));
  patches_.push_back(
      {degree_u, degree_v, rational, static_cast<std::uint32_t>(faces_.size()), 0, 0, space_.size()});
  AddPoints(points, ViewProjection(frame_, Placement{}), Placement{});
  faces_.push_back(out);
}

Vec2 SolverScene::Native(const SolverPatch& patch, double u, double v) const {
  const SolverFace& face = faces_[patch.face];
  return {maps_[face.first_u + patch.i].ToNative(u), maps_[face.first_v + patch.j].ToNative(v)};
}

std::vector<double> SolverScene::NativeBreaks(const SolverFace& face, bool along_u) const {
  const std::uint64_t first = along_u ? face.first_u : face.first_v;
  const std::uint32_t count = along_u ? face.columns : face.rows;
  std::vector<double> breaks{maps_[first].ToNative(0)};
  for (std::uint32_t s = 0; s < count; ++s) breaks.push_back(maps_[first + s].ToNative(1));
  return breaks;
}

std::uint64_t SolverScene::bytes() const {
  return patches_.size() * sizeof(SolverPatch) + faces_.size() * sizeof(SolverFace) +
         grid_.size() * sizeof(grid_[0]) + maps_.size() * sizeof(SpanParameter) +
         space_.size() * sizeof(Vec4) + screen_.size() * sizeof(ViewProjection::Point);
}

}  // namespace facetless
