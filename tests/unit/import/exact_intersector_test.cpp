#include "import/exact_intersector.h"

#include <gtest/gtest.h>
#include <BRepPrimAPI_MakeSphere.hxx>

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

constexpr double kRadius = 10;

std::vector<TopoDS_Face> BallFaces() {
  static Conversion ball = ConvertShape(BRepPrimAPI_MakeSphere(kRadius).Shape()).value();
  return PlacedFaces(ball);
}

TEST(ExactIntersector, FindsTheNearestHit) {
  ExactIntersector ball(BallFaces());
  // The depth is relative to the length of the direction.
  const ExactHit hit = ball.Nearest({3, 4, 50}, {0, 0, -2}, -INFINITY);
  EXPECT_EQ(hit.face, 0);
  EXPECT_FALSE(hit.failed);
  EXPECT_NEAR(hit.depth, (50 - std::sqrt(75)) / 2, 1e-9);
  EXPECT_EQ(ball.Nearest({9, 9, 50}, {0, 0, -1}, -INFINITY).face, -1);
  EXPECT_LE(ball.box(0).low.x, -kRadius);
}

TEST(ExactIntersector, LinesHaveNoBeginningButNear) {
  ExactIntersector ball(BallFaces());
  // From inside, the far side is the hit, unless hits behind the origin are allowed.
  EXPECT_NEAR(ball.Nearest({0, 0, 0}, {1, 0, 0}, -INFINITY).depth, -kRadius, 1e-9);
  EXPECT_NEAR(ball.Nearest({0, 0, 0}, {1, 0, 0}, 1e-6).depth, kRadius, 1e-9);
}

TEST(ExactIntersector, TimesRaysFromAFile) {
  const TemporaryFolder folder;
  const double rays[2][6] = {{3, 4, 50, 0, 0, -1}, {9, 9, 50, 0, 0, -1}};
  const std::string path = folder.Write("rays", {reinterpret_cast<const char*>(rays), sizeof rays});
  const Result<ExactTiming> timing =
      TimeExactIntersector(BallFaces(), path, folder.File("depths"), -INFINITY, /*seconds=*/60);
  ASSERT_TRUE(timing.ok()) << timing.error().message;
  EXPECT_EQ(timing.value().rays, 2u);
  std::ifstream in(folder.File("depths"), std::ios::binary);
  double depths[2] = {};
  ASSERT_TRUE(in.read(reinterpret_cast<char*>(depths), sizeof depths));
  EXPECT_NEAR(depths[0], 50 - std::sqrt(75), 1e-9);
  EXPECT_EQ(depths[1], INFINITY);
  EXPECT_EQ(TimeExactIntersector(BallFaces(), folder.File("absent"), folder.File("d"), 0, 1).error().code,
            ErrorCode::kFileUnreadable);
}

}  // namespace
}  // namespace facetless
