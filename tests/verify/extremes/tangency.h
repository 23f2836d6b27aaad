// Rays that approach a silhouette: when is a hit or a miss still proven, and is it right?
//
//  1. Each ray is an image of one pixel. It is parallel to a tangent of the surface, with an offset to the
//     inside or to the outside, in units of the radius. Offsets below 1e-15 are affected by rounding; the
//     oracle judges the rounded ray.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace facetless::extremes {

struct TangentRays {
  std::string surface;
  double offset = 0;
  bool inside = false;
  struct Count {
    std::uint64_t rays = 0, certified = 0, certified_wrong = 0;
    std::uint64_t certified_undecided = 0;  // the oracle cannot decide: the two roots are equal to 113 bits
    std::uint64_t doubtful_right = 0;
  };
  std::array<Count, 3> counts;  // by kPrecisions
};

// For each surface, measures offsets of 1e-1 to 1e-16, first inside, then outside.
std::vector<TangentRays> MeasureTangency();

}  // namespace facetless::extremes
