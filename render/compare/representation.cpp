#include "render/compare/representation.h"

#include <utility>

#include "render/compare/see_through.h"

namespace facetless {

Result<TracedView> ExactSurfaces::Trace(const Camera& camera, const TraceRequest& request,
                                        const Execution& execution) const {
  DirectOptions options = options_;
  options.uv = request.uv;
  options.depth_error = request.depth_error;
  options.audit = request.audit;
  options.leave_out = request.leave_out;
  options.refine = request.refine;
  if (!request.certificates) options.accuracy.check = CheckLevel::kNone;
  options.execution = execution;
  Result<DirectResult> traced = TraceDirect(scene_, camera, options);
  if (!traced.ok()) return traced.error();
  TracedView view;
  view.frame = traced.value().frame;
  view.samples = std::move(traced.value().samples);
  DirectStats& stats = traced.value().stats;
  view.refinement = std::move(traced.value().refinement);
  view.counters = {stats.prepare_ms, stats.trace_ms, stats.rays, stats.hits, stats.refine_ms};
  view.structure_bytes = stats.scene_bytes + stats.refine_bytes;
  view.direct = std::move(stats);
  return view;
}

Triangles::Triangles(const BaselineScene& scene, const Model& model, std::span<const SectionPlane> sections,
                     std::uint64_t max_bytes)
    : scene_(scene), sections_(sections), max_bytes_(max_bytes) {
  if (!sections.empty()) solids_.emplace(model);
}

std::vector<RepresentationFact> Triangles::facts() const {
  return {{"triangles", static_cast<double>(scene_.triangles())}};
}

Result<TracedView> Triangles::Trace(const Camera& camera, const TraceRequest& request,
                                    const Execution& execution) const {
  TracedView view;
  const BaselineScene* scene = &scene_;
  Mesh rest;
  std::optional<BaselineScene> rest_scene;
  if (request.leave_out != nullptr) {
    rest = OpaqueMesh(scene_.mesh(), *request.leave_out);
    Result<BaselineScene> built = BaselineScene::Build(rest, execution, false, max_bytes_);
    if (!built.ok()) {
      if (built.error().code != ErrorCode::kNothingUsable) return built.error();
      view.samples.Resize(camera.width_px, camera.height_px);  // no face is shown
      return view;
    }
    rest_scene.emplace(std::move(built).value());
    scene = &*rest_scene;
  }
  Result<BaselineResult> traced =
      TraceBaseline(*scene, camera, {execution, sections_, solids_ ? &*solids_ : nullptr, request.refine});
  if (!traced.ok()) return traced.error();
  view.frame = traced.value().frame;
  view.samples = std::move(traced.value().samples);
  view.structure_bytes = scene->mesh_bytes() + scene->bvh_peak_bytes();
  const BaselineStats& stats = traced.value().stats;
  view.refinement = std::move(traced.value().refinement);
  view.counters = {0, stats.trace_ms, stats.rays, stats.hits, stats.refine_ms};
  return view;
}

}  // namespace facetless
