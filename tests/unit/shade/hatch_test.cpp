// Hatching: all lines have the same width and distance, and each solid has a direction of its own.
#include "render/shade/hatch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace facetless {
namespace {

TEST(Hatch, CoversTheShareThatItsLinesHave) {
  double sum = 0;
  const int size = 450;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) sum += HatchCover(x + 0.5, y + 0.5, 2);
  EXPECT_NEAR(sum / (size * size), kHatchWidth / kHatchSpacing, 0.01);
}

TEST(Hatch, RunsAlongItsOwnDirectionOnly) {
  // The lines of the first solid run downwards to the left at 45°, so nothing changes in this direction.
  for (int i = 0; i < 50; ++i) {
    EXPECT_NEAR(HatchCover(i, 50 - i, 0), HatchCover(0, 50, 0), 1e-5);
    EXPECT_NEAR(HatchCover(i, i, 1), HatchCover(0, 0, 1), 1e-5);
  }
  bool differs = false;
  for (int i = 0; i < 50; ++i)
    differs = differs || std::fabs(HatchCover(i, 0, 0) - HatchCover(0, 0, 0)) > 0.5;
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace facetless
