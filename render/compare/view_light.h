// The secondary rays of one view: makes the rays of a representation, casts the light of its samples, and adds up what
// was found.
//
//     ViewLighter lighter(representation, model, options.light, options.up, options.sections, execution);
//     if (auto made = lighter.Prepare(transparent); !made) return made.error();
//     Result<SampleLight> light = lighter.Cast(samples, frame);
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/base/execution.h"
#include "render/compare/representation.h"
#include "render/model/model.h"
#include "render/shade/cast_light.h"
#include "render/shade/cast_reflections.h"
#include "render/view/camera.h"
#include "render/view/section.h"

namespace facetless {

// What secondary rays found in a view.
struct ViewLight {
  LightOptions options;  // with the radius that was used
  SampleLight centres;   // parallel to the samples of the pixel centres
  LightStats stats;      // of all samples, those of the colour included
  std::shared_ptr<const SecondaryRays> rays;
  double build_ms = 0, cast_ms = 0;
};

inline constexpr double kOcclusionShare = 0.25;

class ViewLighter {
 public:
  // An occlusion without a radius gets kOcclusionShare of the model's diagonal. All arguments must outlive the object. `up` is the axis of the model that points up: the ground touches the bounds
  // of the model from below.
  ViewLighter(const Representation& representation, const Model& model, const LightOptions& options,
              UpAxis up, std::span<const SectionPlane> sections, const Execution& execution);

  // Makes the rays. `transparent`: placed faces that rays ignore; may be empty. `colors`: by placed face; they must outlive
  // the object. Errors: those of MakeRays and MaterialsOfFaces; kBadUsage (materials for a representation that names no
  // faces).
  Result<void> Prepare(const std::vector<bool>& transparent, std::span<const Color> colors);
  // Casts the light of samples, and their reflections. Errors: those of CastLight and CastReflections. Require Prepare.
  Result<SampleLight> Cast(const SampleBuffer& samples, const CameraFrame& frame);
  Result<SampleLight> Cast(const Refinement& refinement);

  Vec3 ground_up() const { return setting_.plane.up; }
  // The sums so far, with the light of the pixel centres.
  ViewLight Finish(SampleLight centres) const;

 private:
  template <typename Samples, typename... Frame>
  Result<SampleLight> CastAll(const Samples& samples, const Frame&... frame);

  const Representation& representation_;
  const Model& model_;
  const UpAxis up_;
  const Execution& execution_;
  std::shared_ptr<const SecondaryRays> rays_;  // of light: glass blocks none
  std::shared_ptr<const SecondaryRays> seen_;  // of what is seen in mirrors and through glass
  std::vector<Material> materials_;            // by placed face; empty if all are matte
  LightSetting setting_;
  ReflectionSetting reflection_;
  LightStats stats_;
  double build_ms_ = 0, cast_ms_ = 0;
};

}  // namespace facetless
