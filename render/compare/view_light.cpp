#include "render/compare/view_light.h"

#include <utility>

#include "render/base/stopwatch.h"

namespace facetless {

ViewLighter::ViewLighter(const Representation& representation, const Model& model,
                         const LightOptions& options, UpAxis up, std::span<const SectionPlane> sections,
                         const Execution& execution)
    : representation_(representation), model_(model), up_(up), execution_(execution) {
  setting_.options = options;
  // A ground has something to catch.
  if (options.ground && options.occlusion_rays == 0) setting_.options.shadows = true;
  if (setting_.options.occlusion_radius_mm == 0)
    setting_.options.occlusion_radius_mm = kOcclusionShare * model.Diagonal();
  // The upward direction is an axis of the model, so the lower corner of the bounds lies in the ground's plane.
  setting_.plane = {model.bounds.low, RotateToUpAxis(up, {0, 0, 1})};
  setting_.sections = sections;
  setting_.first_cap = static_cast<std::uint32_t>(model.PlacedFaceCount());
}

Result<void> ViewLighter::Prepare(const std::vector<bool>& transparent, std::span<const Color> colors) {
  const Stopwatch stopwatch;
  const LightOptions& options = setting_.options;
  const auto make = [&](const std::vector<bool>& leave_out,
                        std::shared_ptr<const SecondaryRays>* rays) -> Result<void> {
    Result<std::unique_ptr<SecondaryRays>> made =
        representation_.MakeRays({leave_out, options.structure}, execution_);
    if (!made.ok()) return made.error();
    *rays = std::move(made).value();
    return {};
  };
  if (!options.materials.empty()) {
    if (!representation_.names_faces())
      return Error{ErrorCode::kBadUsage, "material: the faces of a mesh of another program are not known"};
    Result<std::vector<Material>> materials = MaterialsOfFaces(model_, options.materials);
    if (!materials.ok()) return materials.error();
    materials_ = std::move(materials).value();
    setting_.materials = materials_;
  }
  // For light, leave out the faces of glass: light passes through them without being bent.
  std::vector<bool> leave_out = transparent;
  bool has_glass = false;
  for (std::size_t face = 0; face < materials_.size(); ++face) {
    if (materials_[face].kind != MaterialKind::kGlass) continue;
    has_glass = true;
    leave_out.resize(materials_.size());
    leave_out[face] = true;
  }
  if (auto made = make(leave_out, &rays_); !made.ok()) return made;
  setting_.rays = rays_.get();
  if (!materials_.empty()) {
    seen_ = rays_;
    if (has_glass)
      if (auto made = make(transparent, &seen_); !made.ok()) return made;
    reflection_ = {seen_.get(),
                   options.shadows ? rays_.get() : nullptr,
                   materials_,
                   colors,
                   options.bounces,
                   options.panorama,
                   up_};
  }
  build_ms_ = stopwatch.Milliseconds();
  return {};
}

template <typename Samples, typename... Frame>
Result<SampleLight> ViewLighter::CastAll(const Samples& samples, const Frame&... frame) {
  Result<SampleLight> light = SampleLight();
  if (setting_.options.casts()) light = CastLight(samples, frame..., setting_, execution_);
  if (!light.ok()) return light;
  if (!materials_.empty())
    if (auto done = CastReflections(samples, frame..., reflection_, execution_, &light.value()); !done.ok())
      return done.error();
  stats_.Add(light.value().stats);
  cast_ms_ += light.value().cast_ms;
  return light;
}

Result<SampleLight> ViewLighter::Cast(const SampleBuffer& samples, const CameraFrame& frame) {
  return CastAll(samples, frame);
}

Result<SampleLight> ViewLighter::Cast(const Refinement& refinement) {
  return CastAll(refinement);
}

ViewLight ViewLighter::Finish(SampleLight centres) const {
  return {setting_.options, std::move(centres), stats_, rays_, build_ms_, cast_ms_};
}

}  // namespace facetless
