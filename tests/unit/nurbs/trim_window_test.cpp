// Windows of a trim index: a query through a window has the answer that it has without.
#include "render/nurbs/trim_window.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "render/nurbs/trim_index.h"
#include "tests/unit/nurbs/trim_models.h"

namespace facetless {
namespace {

using namespace trim_models;

// Several polygons and arcs of many pieces, some of which share heights with each other.
FaceTrim RandomTrim(Random& random, double gap_mm) {
  Model model = PlaneModel(-2, 2, -2, 2);
  const int loops = random.Integer(1, 4);
  for (int loop = 0; loop < loops; ++loop) {
    std::vector<Vec2> corners;
    const int count = random.Integer(3, 40);
    for (int i = 0; i < count; ++i) {
      Vec2 corner{random.Uniform(-1, 1), random.Uniform(-1, 1)};
      // Corners on a coarse grid give borders along the axes and ends at equal heights.
      if (random.Integer(0, 1) == 1) corner = {std::round(4 * corner.x) / 4, std::round(4 * corner.y) / 4};
      corners.push_back(corner);
    }
    AddLoop(model, Polygon(corners), gap_mm);
  }
  return FaceTrim::Build(model, 0);
}

void ExpectSame(const TrimAnswer& a, const TrimAnswer& b) {
  RC_ASSERT(a.inside == b.inside);
  RC_ASSERT(a.certain == b.certain);
  RC_ASSERT(a.coedge == b.coedge);
  RC_ASSERT(a.material_left == b.material_left);
  RC_ASSERT(a.edge_parameter == b.edge_parameter);
  RC_ASSERT(a.other_coedge == b.other_coedge);
  RC_ASSERT(a.other_is_next == b.other_is_next);
  RC_ASSERT(a.other_material_left == b.other_material_left);
  RC_ASSERT(a.other_edge_parameter == b.other_edge_parameter);
}

RC_GTEST_PROP(TrimWindow, AnswersAreThoseOfTheIndex, (std::uint32_t seed)) {
  Random random(seed);
  const FaceTrim trim = RandomTrim(random, random.Integer(0, 1) * std::pow(2, random.Uniform(-30, -4)));
  for (int w = 0; w < 40; ++w) {
    const double size = std::pow(2, random.Uniform(-16, 0));
    const double u = random.Uniform(-1.2, 1.2), v = std::round(8 * random.Uniform(-1.2, 1.2)) / 8;
    const double widest = random.Uniform(0, 64);
    const TrimWindow window = trim.WindowOf(u - size, u + size, v - size, v + size, widest);
    for (int i = 0; i < 40; ++i) {
      // Most queries lie in the window, and some at the height of a corner.
      const double x = u + 1.1 * size * random.Uniform(-1, 1);
      const double y = random.Integer(0, 3) == 0 ? v : v + 1.1 * size * random.Uniform(-1, 1);
      const double error_u = size * std::pow(2, random.Uniform(-40, -2)),
                   error_v = size * random.Uniform(0, 0.1);
      const double scale = random.Integer(0, 1) == 0 ? widest : widest * random.Uniform(0, 1.1);
      ExpectSame(trim.Query(window, x, y, error_u, error_v, scale),
                 trim.Query(x, y, error_u, error_v, scale));
    }
  }
}

// A small window beside a long loop lists few pieces, so that most queries use it.
TEST(TrimWindow, ListsThePiecesThatMeetIt) {
  Random random(1);
  std::vector<Vec2> corners;
  for (int i = 0; i < 200; ++i) {
    const double angle = 2 * 3.14159265358979 * i / 200;
    corners.push_back({std::cos(angle), std::sin(angle)});
  }
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon(corners), 0);
  const FaceTrim trim = FaceTrim::Build(model, 0);
  for (int i = 0; i < 100; ++i) {
    const double angle = random.Uniform(0, 6.28), u = std::cos(angle), v = std::sin(angle);
    const TrimWindow window = trim.WindowOf(u - 0.01, u + 0.01, v - 0.01, v + 0.01, 1);
    EXPECT_TRUE(window.Holds(u, u, v, v, 1));
    EXPECT_FALSE(window.Holds(u, u, v, v, 1.5)) << "a wider band";
    EXPECT_GE(window.piece_count, 1);
    EXPECT_LE(window.piece_count, 3);
    EXPECT_LE(window.end_count, 2);
  }
}

TEST(TrimWindow, HoldsNoQueryThatIsNotANumber) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon({{-1, -1}, {1, -1}, {0, 1}}), 0);
  const FaceTrim trim = FaceTrim::Build(model, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TrimWindow window = trim.WindowOf(-1, 1, -1, 1, 1);
  EXPECT_TRUE(window.Holds(0, 0, 0, 0, 1));
  EXPECT_FALSE(window.Holds(nan, nan, 0, 0, 1));
  EXPECT_FALSE(window.Holds(0, 0, 0, 0, nan));
  EXPECT_FALSE(trim.Query(window, nan, 0, 0, 0, 1).inside);
  EXPECT_FALSE(trim.WindowOf(nan, 1, -1, 1, 1).Holds(0, 0, 0, 0, 1));
}

}  // namespace
}  // namespace facetless
