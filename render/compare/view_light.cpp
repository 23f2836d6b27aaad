#include "render/compare/view_light.h"

#include <utility>

#include "render/base/stopwatch.h"

namespace facetless {

ViewLighter::ViewLighter(const Representation& representation, const Model& model,
                         const LightOptions& options, UpAxis up, std::span<const SectionPlane> sections,
                         const Execution& execution)
    : representation_(representation), execution_(execution) {
  setting_.options = options;
  if (setting_.options.occlusion_radius_mm == 0)
    setting_.options.occlusion_radius_mm = kOcclusionShare * model.Diagonal();
  // The axis that points up is one of the model's, so the lowest corner of the bounds lies in the plane.
  setting_.plane = {model.bounds.low, RotateToUpAxis(up, {0, 0, 1})};
  setting_.sections = sections;
  setting_.first_cap = static_cast<std::uint32_t>(model.PlacedFaceCount());
}

Result<void> ViewLighter::Prepare(const std::vector<bool>& leave_out) {
  const Stopwatch stopwatch;
  Result<std::unique_ptr<SecondaryRays>> made =
      representation_.MakeRays({leave_out, setting_.options.structure}, execution_);
  if (!made.ok()) return made.error();
  rays_ = std::move(made).value();
  setting_.rays = rays_.get();
  build_ms_ = stopwatch.Milliseconds();
  return {};
}

Result<SampleLight> ViewLighter::Cast(const SampleBuffer& samples, const CameraFrame& frame) {
  return Count(CastLight(samples, frame, setting_, execution_));
}

Result<SampleLight> ViewLighter::Cast(const Refinement& refinement) {
  return Count(CastLight(refinement, setting_, execution_));
}

Result<SampleLight> ViewLighter::Count(Result<SampleLight> light) {
  if (!light.ok()) return light;
  stats_.Add(light.value().stats);
  cast_ms_ += light.value().cast_ms;
  return light;
}

ViewLight ViewLighter::Finish(SampleLight centres) const {
  return {setting_.options, std::move(centres), stats_, rays_, build_ms_, cast_ms_};
}

}  // namespace facetless
