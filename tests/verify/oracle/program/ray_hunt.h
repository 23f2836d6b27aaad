// Rays from random hits of a view, judged by the oracle: one towards the light, one at random in the half space above
// the surface, and one at random below it.
#pragma once

#include <cstdint>
#include <string>

#include "render/trace/direct.h"
#include "render/view/camera.h"
#include "tests/verify/oracle/aim.h"
#include "tests/verify/oracle/oracle.h"

namespace facetless::oracle {

struct RayHuntOptions {
  std::size_t starts = 2000;
  std::string structure = "blocks";
  int list = 20;
};

// Prints a table of what is certified and right, and returns the number of certified answers that are wrong. Requires
// samples with parameters.
Result<std::uint64_t> HuntRays(const std::string& title, const Scene& scene, const Oracle& oracle,
                               const Camera& camera, const DirectResult& direct,
                               const RayHuntOptions& options, Random& random);

}  // namespace facetless::oracle
