#include "render/compare/representation.h"

#include <algorithm>
#include <utility>

#include "render/baseline/mesh_rays.h"
#include "render/compare/see_through.h"
#include "render/rays/exact_rays.h"

namespace facetless {
namespace {

// The rays of a mesh without the faces that were left out. The object owns that mesh and its scene.
class RaysOfPart final : public SecondaryRays {
 public:
  RaysOfPart(std::unique_ptr<const Mesh> mesh, BaselineScene scene)
      : mesh_(std::move(mesh)), scene_(std::move(scene)), rays_(scene_) {}
  void FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<RayPassage> passages) const override {
    rays_.FindBlocked(starts, rays, passages);
  }
  void FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<SecondaryHit> hits) const override {
    rays_.FindNearest(starts, rays, hits);
  }
  std::string structure() const override { return rays_.structure(); }
  double build_ms() const override { return scene_.build_ms(); }
  std::uint64_t bytes() const override { return scene_.bvh_bytes(); }
  double lift_mm() const override { return rays_.lift_mm(); }

 private:
  std::unique_ptr<const Mesh> mesh_;
  BaselineScene scene_;
  MeshRays rays_;
};

// The rays of a mesh of which all faces were left out: no ray meets anything.
class EmptySpace final : public SecondaryRays {
 public:
  void FindBlocked(std::span<const RayStart>, std::span<const SecondaryRay>,
                   std::span<RayPassage> passages) const override {
    std::fill(passages.begin(), passages.end(), RayPassage{});
  }
  void FindNearest(std::span<const RayStart>, std::span<const SecondaryRay>,
                   std::span<SecondaryHit> hits) const override {
    std::fill(hits.begin(), hits.end(), SecondaryHit{});
  }
  std::string structure() const override { return "none"; }
  double build_ms() const override { return 0; }
  std::uint64_t bytes() const override { return 0; }
};

}  // namespace

Result<std::unique_ptr<SecondaryRays>> Representation::MakeRays(const SecondaryRaysRequest&,
                                                                const Execution&) const {
  return Error{ErrorCode::kBadUsage,
               title() +
                   " has no rays that start on surfaces; leave out --shadows, --ambient-occlusion and "
                   "--material"};
}

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

Result<std::unique_ptr<SecondaryRays>> ExactSurfaces::MakeRays(const SecondaryRaysRequest& request,
                                                               const Execution& execution) const {
  ExactRaysOptions options;
  options.structure = request.structure;
  if (!request.leave_out.empty()) options.leave_out = &request.leave_out;
  options.max_bytes = options_.accuracy.max_bytes;
  Result<std::unique_ptr<ExactRays>> made = ExactRays::Build(scene_, options, execution);
  if (!made.ok()) return made.error();
  return std::unique_ptr<SecondaryRays>(std::move(made).value());
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

Result<std::unique_ptr<SecondaryRays>> Triangles::MakeRays(const SecondaryRaysRequest& request,
                                                           const Execution& execution) const {
  if (request.leave_out.empty()) return std::unique_ptr<SecondaryRays>(std::make_unique<MeshRays>(scene_));
  auto rest = std::make_unique<const Mesh>(OpaqueMesh(scene_.mesh(), request.leave_out));
  Result<BaselineScene> built = BaselineScene::Build(*rest, execution, false, max_bytes_);
  if (!built.ok()) {
    if (built.error().code != ErrorCode::kNothingUsable) return built.error();
    return std::unique_ptr<SecondaryRays>(std::make_unique<EmptySpace>());
  }
  return std::unique_ptr<SecondaryRays>(
      std::make_unique<RaysOfPart>(std::move(rest), std::move(built).value()));
}

}  // namespace facetless
