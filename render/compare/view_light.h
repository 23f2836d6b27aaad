// The secondary rays of one view: makes the rays of a representation, casts the light of its samples, and adds up the
// counts and times.
//
//     ViewLighter lighter(representation, model, options.light, options.up, options.sections, execution);
//     if (auto made = lighter.Prepare(transparent, colors); !made) return made.error();
//     Result<SampleLight> light = lighter.Cast(samples, frame);
//     if (light) view.light = lighter.Finish(std::move(light).value());
//
//  1. The ground touches the bounds of the model from below.
//  2. An occlusion with a radius of 0 gets a radius of kOcclusionShare of the model's diagonal.
//  3. Faces that are transparent in the model are ignored by all rays. Faces of glass block no light, but are seen in
//     mirrors and through other glass. If there are any, a second SecondaryRays without them is made for light.
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

// The results of the secondary rays of a view.
struct ViewLight {
  LightOptions options;                       // with the radius that was used (law 2)
  SampleLight centres;                        // one entry for each sample of the pixel centres
  LightStats stats;                           // sums over the pixel centres and the samples of the colour
  std::shared_ptr<const SecondaryRays> rays;  // the rays of light (law 3)
  double build_ms = 0;                        // time for making all rays
  double cast_ms = 0;                         // time for casting them
};

inline constexpr double kOcclusionShare = 0.25;

class ViewLighter {
 public:
  // `up` is the axis of the model that points up. All arguments except `options` must outlive the object.
  ViewLighter(const Representation& representation, const Model& model, const LightOptions& options,
              UpAxis up, std::span<const SectionPlane> sections, const Execution& execution);

  // Makes the rays. `transparent` is indexed by placed face and marks the faces that rays ignore; it may be empty.
  // `colors` has the colour of each placed face and must outlive the object. Errors: those of MakeRays and
  // MaterialsOfFaces; kBadUsage (materials for a representation whose samples do not have the faces of the model).
  Result<void> Prepare(const std::vector<bool>& transparent, std::span<const Color> colors);
  // Cast the light of samples, and their reflections. Prepare must have succeeded before. Errors: those of CastLight
  // and CastReflections.
  Result<SampleLight> Cast(const SampleBuffer& samples, const CameraFrame& frame);
  Result<SampleLight> Cast(const Refinement& refinement);

  Vec3 ground_up() const { return setting_.plane.up; }
  // Returns the sums over all calls of Cast so far, together with the light of the pixel centres.
  ViewLight Finish(SampleLight centres) const;

 private:
  template <typename Samples, typename... Frame>
  Result<SampleLight> CastAll(const Samples& samples, const Frame&... frame);

  const Representation& representation_;
  const Model& model_;
  const UpAxis up_;
  const Execution& execution_;
  std::shared_ptr<const SecondaryRays> rays_;  // for light: without faces of glass
  std::shared_ptr<const SecondaryRays> seen_;  // for reflection and refraction: with faces of glass
  std::vector<Material> materials_;            // by placed face; empty if all are matte
  LightSetting setting_;
  ReflectionSetting reflection_;
  LightStats stats_;
  double build_ms_ = 0, cast_ms_ = 0;
};

}  // namespace facetless
