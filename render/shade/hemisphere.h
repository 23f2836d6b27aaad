// Directions that cover a hemisphere, for ambient occlusion: a Fibonacci lattice on the unit disc, lifted onto the
// sphere (Malley's method), so that the density of directions is proportional to the cosine of the angle to the axis.
// The share of these rays that meet nothing is then the share of the light of an evenly bright sky that arrives.
//
//     const Hemisphere hemisphere(64);
//     const LocalFrame frame(normal);
//     for (const Vec3 d : hemisphere.Set(column, row)) Cast(frame.ToWorld(d));
//
//  1. Neighbouring samples use different sets of directions. There are kSets sets, which repeat every 4 × 4 samples.
//     The errors of neighbouring samples therefore differ, and appear as fine grain instead of as false edges. No
//     random numbers are used.
//  2. The code uses only sums, products, quotients and square roots of doubles, in a fixed order.
#pragma once

#include <span>
#include <vector>

#include "render/base/vec.h"

namespace facetless {

class Hemisphere {
 public:
  static constexpr int kSide = 4, kSets = kSide * kSide;
  // Makes kSets sets of `count` unit vectors around the z axis. Requires count ≥ 1.
  explicit Hemisphere(int count);

  // The set for the sample at a column and a row, both at least 0.
  std::span<const Vec3> Set(int column, int row) const {
    const int set = (row & (kSide - 1)) * kSide + (column & (kSide - 1));
    return {directions_.data() + static_cast<std::size_t>(set) * count_, count_};
  }

 private:
  std::size_t count_;
  std::vector<Vec3> directions_;  // the directions of the first set, then of the second, and so on
};

// An orthonormal frame whose third axis is a given unit vector. Source: Duff et al., "Building an Orthonormal Basis,
// Revisited", Journal of Computer Graphics Techniques 6 (2017).
struct LocalFrame {
  Vec3 x, y, z;
  explicit LocalFrame(Vec3 axis);
  Vec3 ToWorld(Vec3 v) const { return v.x * x + v.y * y + v.z * z; }
};

}  // namespace facetless
