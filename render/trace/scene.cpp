#include "render/trace/scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace facetless {
namespace {

FaceData MakeFaceData(const Model& model, std::uint32_t index) {
  const Face& face = model.faces[index];
  const Surface& surface = model.surfaces[face.surface];
  FaceData data{FaceTrim::Build(model, index), {}, {}, 0};
  const std::size_t count = std::size_t(surface.PatchCount()) * surface.PointsPerPatch();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec4& p = model.control_points[surface.first_control_point + i];
    data.bounds.Add({p.x / p.w, p.y / p.w, p.z / p.w});
  }
  data.patches.reserve(surface.PatchCount());
  for (std::uint32_t i = surface.u_spans.first; i < surface.u_spans.end(); ++i) {
    for (std::uint32_t j = surface.v_spans.first; j < surface.v_spans.end(); ++j) {
      const Span &u = model.spans[i], &v = model.spans[j];
      data.patches.push_back(data.trim.Classify(u.begin, u.end, v.begin, v.end));
    }
  }
  for (std::uint32_t l = face.loops.first; l < face.loops.end(); ++l) {
    const Range coedges = model.loops[l].coedges;
    for (std::uint32_t c = coedges.first; c < coedges.end(); ++c)
      data.extend_mm = std::max(data.extend_mm, model.coedges[c].gap_mm);
  }
  return data;
}

}  // namespace

std::size_t Scene::Data::bytes() const {
  std::size_t sum = faces.capacity() * sizeof(FaceData) + spans.capacity() * sizeof(SpanParameter);
  for (const FaceData& face : faces) sum += face.trim.bytes() + face.patches.capacity() * sizeof(RectClass);
  return sum;
}

Scene::Scene(const Model& model) : data_(std::make_unique<Data>()) {
  data_->model = &model;
  data_->faces.resize(model.faces.size());
  tbb::parallel_for(std::size_t{0}, model.faces.size(), [&](std::size_t i) {
    data_->faces[i] = MakeFaceData(model, static_cast<std::uint32_t>(i));
  });
  data_->spans.reserve(model.spans.size());
  for (const Span& span : model.spans) data_->spans.emplace_back(span);
  data_->has_closed_solid =
      std::any_of(model.solids.begin(), model.solids.end(), [](const Solid& s) { return s.closed; });
}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
const Model& Scene::model() const {
  return *data_->model;
}

}  // namespace facetless
