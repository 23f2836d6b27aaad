// RawRays: asks Embree whether rays that start on surfaces are blocked, without any other work. For measurements.
//
//     const RawRays rays(scene, starts, shadow_rays);
//     const std::uint64_t blocked = rays.CountBlocked(16);
//
//  1. The constructor lifts the starts, as MeshRays does, and rounds the rays to float32, so that a timed CountBlocked
//     consists of little but Embree's work.
//  2. Rays that Embree must not trace (scene_data.h, law 3) are left out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/baseline/tracer.h"
#include "render/view/secondary_rays.h"

namespace facetless {

class RawRays {
 public:
  // `scene` must outlive the object.
  RawRays(const BaselineScene& scene, std::span<const RayStart> starts, std::span<const SecondaryRay> rays);

  // Returns the number of blocked rays. Embree traces `width` rays at a time: 1, 8 or 16.
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
