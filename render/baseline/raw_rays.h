// Embree alone on rays that start on surfaces: whether anything blocks them, and nothing else. Starts are lifted and
// everything is rounded to float32 beforehand, so that only Embree's work is timed. For measurements.
//
//     const RawRays rays(scene, starts, shadow_rays);
//     const std::uint64_t blocked = rays.CountBlocked(16);
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/baseline/tracer.h"
#include "render/view/secondary_rays.h"

namespace facetless {

class RawRays {
 public:
  // The lift is that of MeshRays. Rays that Embree must not trace (scene_data.h, law 3) are left out.
  RawRays(const BaselineScene& scene, std::span<const RayStart> starts, std::span<const SecondaryRay> rays);

  // Asks Embree for one ray at a time, or for packets of 8 or 16. Requires `width` of 1, 8 or 16.
  std::uint64_t CountBlocked(int width) const;

 private:
  template <typename Packet, int kLanes, typename Ask>
  std::uint64_t CountPackets(const Ask& ask) const;

  const BaselineScene& scene_;
  std::size_t count_ = 0;
  // One entry per ray, and room for a packet behind the last one.
  std::vector<float> origin_[3], direction_[3], length_;
};

}  // namespace facetless
