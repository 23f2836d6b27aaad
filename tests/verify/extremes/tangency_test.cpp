#include "tests/verify/extremes/tangency.h"

#include <gtest/gtest.h>

#include "tests/verify/extremes/extreme.h"

namespace facetless::extremes {
namespace {

// Below this offset, in units of the radius (and here of a sample), no proof is promised: the pieces in which
// the two roots could be separated are almost as small as kFloorSamples, at which the fallback solver stops.
constexpr double kPromised = 1e-9;

TEST(Tangency, NothingCertifiedIsWrongAndHitOrMissIsProvenDownToRounding) {
  for (const TangentRays& rays : MeasureTangency()) {
    for (std::size_t p = 0; p < kPrecisions.size(); ++p) {
      SCOPED_TRACE(rays.surface + (rays.inside ? ", inside by " : ", outside by ") +
                   std::to_string(rays.offset) + " radii, " + kPrecisionNames[p]);
      EXPECT_EQ(rays.counts[p].certified_wrong, 0u);
      if (rays.offset < kPromised) continue;
      // A ray through a seam without an edge is in doubt because of the border of its face.
      EXPECT_GE(rays.counts[p].certified, rays.counts[p].rays - 1) << rays.offset;
      EXPECT_EQ(rays.counts[p].certified + rays.counts[p].doubtful_right, rays.counts[p].rays) << rays.offset;
    }
  }
}

}  // namespace
}  // namespace facetless::extremes
