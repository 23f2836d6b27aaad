// The light that reaches the samples of a view, as secondary rays find it: the share of the key light (shadows) and the
// share of the ambient light (occlusion).
//
//     LightSetting setting{.rays = rays.get()};
//     setting.options = {.shadows = true, .occlusion_rays = 64, .occlusion_radius_mm = 20};
//     Result<SampleLight> light = CastLight(samples, frame, setting, execution);
//     if (light) film = Shade(samples, frame, colors, {.light = &light.value()});
//
//  1. The key light is the studio's (shade.h, law 3): its direction is fixed relative to the camera, and it has no
//     extent. If the normal of a sample faces away from the key light, no shadow ray is cast for the sample, and none
//     of the key light arrives there.
//  2. For occlusion, `occlusion_rays` rays are cast per sample, in directions around its normal on the viewer's side.
//     The occlusion is the share of these rays that meet a surface within `occlusion_radius_mm`.
//  3. The ground is a plane below the model that only catches shadow and occlusion: a ray of the view that misses the
//     model and meets the plane from above gets the light of that point. It blocks nothing, and a camera below it does
//     not see it.
//  4. A sample is certified if its hit is certified, and if the answers of all its rays are (view/secondary_rays.h,
//     law 3). LightStats::doubts counts samples by the doubts of their rays; the doubts of their hits are not in it.
//  5. Section planes cut the rays as they cut the view: the removed parts of the model block no ray, and a ray may
//     leave through a cap. The ground cannot be combined with sections.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/image/radiance_map.h"
#include "render/shade/material.h"
#include "render/view/camera.h"
#include "render/view/doubt.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"
#include "render/view/secondary_rays.h"
#include "render/view/section.h"

namespace facetless {

inline constexpr int kMostOcclusionRays = 1024;

// A plane that catches shadows.
struct Ground {
  Vec3 point;  // mm, model axes
  Vec3 up;     // unit normal
};

struct LightOptions {
  bool shadows = false;
  int occlusion_rays = 0;                   // per sample, 0 … kMostOcclusionRays; 0: no occlusion
  double occlusion_radius_mm = 0;           // above 0 or infinite if CastLight casts occlusion rays
  bool ground = false;                      // law 3; a view without occlusion then has shadows, too
  std::string structure = kUsualStructure;  // the structure that finds candidates on exact surfaces
  std::vector<MaterialRule> materials;
  int bounces = 6;  // cast_reflections.h, law 2
  // The panorama that mirrors, metals and glasses show; null: the built-in studio. `environment` is the name of its
  // file.
  std::shared_ptr<const RadianceMap> panorama;
  std::string environment;

  // Whether shadows or occlusion are cast.
  bool casts() const { return shadows || occlusion_rays > 0 || ground; }
  // Whether any secondary ray is needed.
  bool any() const { return casts() || !materials.empty(); }
};

struct LightStats {
  std::uint64_t samples = 0;    // hits and points of the ground, also those that need no ray
  std::uint64_t certified = 0;  // certified samples (law 4)
  // Rays; those of them that ask what blocks the light and are blocked; those whose answer is certified.
  std::uint64_t rays = 0, blocked = 0, certified_rays = 0;
  // For each bit of Doubt, the number of samples with a ray that has it.
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};

  void Add(const LightStats& other);
};

// One entry per sample, in the order of the samples.
struct SampleLight {
  std::vector<float> key;   // share of the key light that arrives, 0 or 1; empty without shadows
  std::vector<float> open;  // share of the ambient light that arrives, 0 … 1; empty without occlusion
  // 1: the sample missed the model, and its light is that of the ground.
  std::vector<std::uint8_t> ground;  // empty without a ground
  // For samples on faces that are not matte (cast_reflections.h): `seen` has the linear light that the face shows, red,
  // green and blue, and `shows` is 1. Both are empty unless CastReflections filled them.
  std::vector<std::array<float, 3>> seen;
  std::vector<std::uint8_t> shows;
  LightStats stats;
  double cast_ms = 0;

  bool Shows(std::size_t i) const { return !shows.empty() && shows[i] != 0; }
};

// The input of CastLight, apart from the samples.
struct LightSetting {
  const SecondaryRays* rays = nullptr;
  LightOptions options;
  Ground plane;                            // used if options.ground
  std::span<const SectionPlane> sections;  // the planes that cut the view
  std::uint32_t first_cap = kNoIndex;      // face ids from here on are caps of sections
  // By placed face: no light is cast for faces that are not matte. Empty: all faces are matte.
  std::span<const Material> materials;
};

// Casts the rays of all samples of a view. Samples of exact surfaces need uv and depth_error. Errors: kBadUsage (the
// number of rays, the radius, a ground with sections), kCancelled, kLimitExceeded (no memory).
Result<SampleLight> CastLight(const SampleBuffer& samples, const CameraFrame& frame,
                              const LightSetting& setting, const Execution& execution);
// The same for the samples of refined pixels.
Result<SampleLight> CastLight(const Refinement& refinement, const LightSetting& setting,
                              const Execution& execution);

// The start of the rays of sample i, which must be a hit; the view's ray through (x, y) found it. The normal of the
// start points to the viewer.
RayStart StartOfSample(const SampleBuffer& samples, const CameraFrame& frame, std::size_t i, double x,
                       double y);

// The direction towards the key light of a view, unit vector in model axes.
Vec3 TowardKeyLight(const CameraFrame& frame);

}  // namespace facetless
