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

  // Makes the rays. `leave_out`: placed faces that block no light; may be empty. Errors: those of MakeRays.
  Result<void> Prepare(const std::vector<bool>& leave_out);
  // Casts the light of samples. Errors: those of CastLight. Require Prepare.
  Result<SampleLight> Cast(const SampleBuffer& samples, const CameraFrame& frame);
  Result<SampleLight> Cast(const Refinement& refinement);

  Vec3 ground_up() const { return setting_.plane.up; }
  // The sums so far, with the light of the pixel centres.
  ViewLight Finish(SampleLight centres) const;

 private:
  Result<SampleLight> Count(Result<SampleLight> light);

  const Representation& representation_;
  const Execution& execution_;
  std::shared_ptr<const SecondaryRays> rays_;
  LightSetting setting_;
  LightStats stats_;
  double build_ms_ = 0, cast_ms_ = 0;
};

}  // namespace facetless
