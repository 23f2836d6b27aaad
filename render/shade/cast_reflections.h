// The light that mirrors, metals and glasses show: rays are followed from the samples of a view until they leave the
// scene or meet a matte face.
//
//     if (auto done = CastReflections(samples, frame, setting, execution, &light); !done) return done.error();
//
//  1. Where a ray meets a glass, it splits into a reflected and a refracted ray (Fresnel's equations). A ray that
//     carries less than kLeastShare of a sample's light in every channel is left out.
//  2. The face that the sample shows is not counted as a bounce. A ray is followed past at most `bounces` further faces
//     that are not matte. The next such face shows the surroundings, whatever lies in front of them.
//  3. A matte face that a ray meets has the studio's light, with the shadow of the key light if shadows are cast, and
//     without occlusion. The ground is not reflected.
//  4. No random numbers are used. The result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/image/film.h"
#include "render/image/radiance_map.h"
#include "render/model/model.h"
#include "render/shade/cast_light.h"
#include "render/shade/material.h"
#include "render/view/camera.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"

namespace facetless {

inline constexpr int kMostBounces = 32;
inline constexpr double kLeastShare = 1.0 / 256;

struct ReflectionSetting {
  const SecondaryRays* rays = nullptr;          // of all faces that mirrors and glasses show
  const SecondaryRays* shadow_rays = nullptr;   // of the faces that block the key light; null: no shadows
  std::span<const Material> materials;          // by placed face
  std::span<const Color> colors;                // by placed face, sRGB
  int bounces = 0;                              // 0 … kMostBounces
  std::shared_ptr<const RadianceMap> panorama;  // the surroundings; null: the studio's
  UpAxis up = UpAxis::kZ;  // the axis of the model that is the panorama's upward direction
};

// Fills `seen` and `shows` of `light` for the samples whose face is not matte, and adds to its stats. Errors: kBadUsage
// (the number of bounces), kCancelled, kLimitExceeded (no memory).
Result<void> CastReflections(const SampleBuffer& samples, const CameraFrame& frame,
                             const ReflectionSetting& setting, const Execution& execution,
                             SampleLight* light);
// The same for the samples of refined pixels.
Result<void> CastReflections(const Refinement& refinement, const ReflectionSetting& setting,
                             const Execution& execution, SampleLight* light);

}  // namespace facetless
