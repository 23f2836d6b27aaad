// The cost model of bounding volumes against the clock: what a ray costs in a plain list if all objects have
// boxes, if all have spheres, and if the model chooses (render/accel/volume_choice.h).
//
//     const std::vector<VolumeCheck> checks = CheckVolumeModel(boxes, rays);
//
//  1. Objects are the boxes themselves, so V(o), B(v) and I(o) are known: I(o) is the time of a box's entry,
//     repeated kLightObject or kHeavyObject times, where the latter stands for an intersection with a
//     surface. All times are measured on the spot.
//  2. Rays ask every object whose volume they meet, also behind the nearest hit, as the model counts.
#pragma once

#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"
#include "render/accel/volume_choice.h"

namespace facetless {

inline constexpr int kLightObject = 1, kHeavyObject = 30;

struct VolumeCheck {
  double intersect_ns = 0;             // I(o)
  std::size_t boxes = 0, spheres = 0;  // that the model chose
  struct Cost {
    double predicted_ns = 0, measured_ns = 0;  // per ray
  };
  Cost all_boxes, all_spheres, chosen;
};

// Requires boxes and rays.
std::vector<VolumeCheck> CheckVolumeModel(const std::vector<Box3>& boxes, std::span<const RaySegment> rays);

Table VolumeTable(const std::string& scene, const std::vector<VolumeCheck>& checks);
nlohmann::json VolumeJson(const std::vector<VolumeCheck>& checks);

}  // namespace facetless
