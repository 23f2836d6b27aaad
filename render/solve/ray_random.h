// Random numbers for the solvers whose sources use them. They follow from the ray and the start alone, so that a picture
// is the same for any number of threads (law 3 of solver.h).
//
//     RayRandom random(ray, start);
//     const double u = random.Next();  // in [0,1)
#pragma once

#include <bit>
#include <cstdint>

#include "render/solve/solver.h"

namespace facetless {

class RayRandom {
 public:
  RayRandom(const SolverRay& ray, const SolverStart& start) {
    for (const std::uint64_t part :
         {std::uint64_t{static_cast<std::uint32_t>(ray.column)} << 32 | static_cast<std::uint32_t>(ray.row),
          std::uint64_t{start.surface}, std::bit_cast<std::uint64_t>(start.u),
          std::bit_cast<std::uint64_t>(start.v)})
      state_ = Mixed(state_ ^ part);
  }

  double Next() {
    state_ += kStep;
    return static_cast<double>(Mixed(state_) >> 11) * 0x1p-53;
  }

 private:
  // G. L. Steele et al., "Fast splittable pseudorandom number generators" (2014): SplitMix64.
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15;
  static std::uint64_t Mixed(std::uint64_t z) {
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
  }

  std::uint64_t state_ = kStep;
};

}  // namespace facetless
