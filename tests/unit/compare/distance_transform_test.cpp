#include "render/compare/distance_transform.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace facetless {
namespace {

TEST(SquaredDistances, AgreesWithTheDefinition) {
  EXPECT_TRUE(rc::check("every pixel against every set pixel", [] {
    const int width = *rc::gen::inRange(1, 24), height = *rc::gen::inRange(1, 24);
    const int one_in = *rc::gen::element(1, 2, 5, 40, 400);
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(width) * height);
    for (auto& set : mask) set = *rc::gen::inRange(0, one_in) == 0;
    const std::vector<std::int64_t> distances = SquaredDistances(mask, width, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        std::int64_t nearest = -1;
        for (int v = 0; v < height; ++v)
          for (int u = 0; u < width; ++u) {
            const std::int64_t d = std::int64_t{x - u} * (x - u) + std::int64_t{y - v} * (y - v);
            if (mask[v * width + u] && (nearest < 0 || d < nearest)) nearest = d;
          }
        RC_ASSERT(distances[y * width + x] == nearest);
      }
  }));
}

TEST(SquaredDistances, ReachesAcrossTheLargestPictures) {
  std::vector<std::uint8_t> mask(65536, 0);
  mask[0] = 1;
  EXPECT_EQ(SquaredDistances(mask, 65536, 1).back(), std::int64_t{65535} * 65535);
  EXPECT_EQ(SquaredDistances(mask, 1, 65536).back(), std::int64_t{65535} * 65535);
}

}  // namespace
}  // namespace facetless
