// How the rays of a view become rays of Embree. Private to render/baseline. Everything here is inline, because
// it is called for each ray.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/baseline/scene_data.h"
#include "render/view/camera.h"

namespace facetless {

inline constexpr int kTile = 32;   // side of the tile that one task traces, pixels
inline constexpr int kPacket = 4;  // side of a packet of 16 rays, pixels

// Rays start before the bounds of the mesh by this share of its diagonal, which is far above the rounding of
// float32.
inline constexpr double kLeadIn = 1e-3;

// Directions have a length of about 1. A coordinate below this value is set to 0, because it moves a ray by
// less than float32 resolves. Embree 3.13 replaces a coordinate below 1e-18 by a positive one, but chooses
// the near sides of boxes by its original sign, so coherent packets lose hits if the coordinate is negative.
// Together with kLeastEntry of scene.cpp, this limit keeps all coordinates in the space of instances away
// from 1e-18.
inline constexpr float kLeastCoordinate = 1e-9f;

// Returns a coordinate of a ray's direction as Embree may see it.
inline float Coordinate(float direction) {
  return std::fabs(direction) >= kLeastCoordinate ? direction : 0.0f;
}

// Returns the depth at which rays start. It is just before the mesh, where float32 has the best resolution.
inline double StartDepth(const BaselineScene::Data& data, const CameraFrame& frame) {
  double nearest = INFINITY;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? data.bounds.high.x : data.bounds.low.x,
                      i & 2 ? data.bounds.high.y : data.bounds.low.y,
                      i & 4 ? data.bounds.high.z : data.bounds.low.z};
    nearest = std::min(nearest, Dot(corner - frame.eye, frame.forward));
  }
  nearest -= kLeadIn * data.bounds.diagonal();
  return frame.projection == Projection::kOrthographic ? nearest : std::max(nearest, frame.near_mm);
}

// Returns false for rays that miss the mesh by far, which Embree must not trace (scene_data.h, law 3).
inline bool Reaches(const BaselineScene::Data& data, Vec3 origin, Vec3 direction) {
  const auto within = [](Vec3 v, double limit) {
    return std::fabs(v.x) <= limit && std::fabs(v.y) <= limit && std::fabs(v.z) <= limit;
  };
  return within(origin, data.reach) && within(direction, kSteepestRay);
}

}  // namespace facetless
