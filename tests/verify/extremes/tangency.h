// Rays beside a silhouette, nearer and nearer: when is hit or miss still proven, and is it right?
//
//  1. Each ray is an image of one pixel of its own, parallel to a tangent of the surface and an offset inside
//     or outside of it, in units of the radius. Offsets below 1e-15 are what doubles make of them; the oracle
//     judges the very ray.
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
    std::uint64_t certified_undecided = 0;  // the oracle can't tell: the two roots are one to 113 bits
    std::uint64_t doubtful_right = 0;
  };
  std::array<Count, 3> counts;  // by kPrecisions
};

// For each surface, offsets of 1e-1 to 1e-16, first inside, then outside.
std::vector<TangentRays> MeasureTangency();

}  // namespace facetless::extremes
