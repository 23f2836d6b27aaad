// FaceTrim::FindLine: what the line says of a rectangle is what the trim index says of each of its points.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "render/nurbs/trim_index.h"
#include "tests/unit/nurbs/trim_models.h"

namespace facetless {
namespace {

using trim_models::Random;

// A plate with a star-shaped polygon and a round hole.
Model Plate(double gap_mm, Random& random) {
  Model model = trim_models::PlaneModel(-10, 10, -10, 10);
  std::vector<Vec2> corners;
  const int count = random.Integer(3, 12);
  for (int i = 0; i < count; ++i) {
    const double angle = 6.283185307179586 * i / count, radius = random.Uniform(4, 9);
    corners.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  trim_models::AddLoop(model, trim_models::Polygon(corners), gap_mm);
  trim_models::AddLoop(
      model, trim_models::Circle({random.Uniform(-1, 1), random.Uniform(-1, 1)}, random.Uniform(0.2, 1)),
      gap_mm);
  return model;
}

RC_GTEST_PROP(FaceTrimFindLine, SaysWhatTheTrimIndexSays, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const double gap_mm = *rc::gen::element(0.0, 0.001, 0.05);
  const Model model = Plate(gap_mm, random);
  const FaceTrim trim = FaceTrim::Build(model, 0);
  for (int i = 0; i < 60; ++i) {
    const double half = std::pow(10.0, random.Uniform(-3, 0.7));
    const Vec2 middle{random.Uniform(-9, 9), random.Uniform(-9, 9)};
    const double half_u = half * random.Uniform(0.2, 1), half_v = half * random.Uniform(0.2, 1);
    const TrimLine line =
        trim.FindLine(middle.x - half_u, middle.x + half_u, middle.y - half_v, middle.y + half_v, 9);
    for (int k = 0; k < 40; ++k) {
      const double s = random.Uniform(-1, 1), t = random.Uniform(-1, 1);
      const double value = line.a * s + line.b * t + line.c;
      if (std::fabs(value) <= line.w) continue;
      const TrimAnswer answer = trim.Query(middle.x + s * half_u, middle.y + t * half_v, 0, 0, 9);
      RC_ASSERT(answer.inside == (value > 0));
      // And no edge has a say there, with bands that are nine times as wide.
      RC_ASSERT(answer.certain);
      RC_ASSERT(answer.coedge == kNoIndex);
    }
  }
}

// A straight border needs no width, and a rectangle without a border is whole or nothing.
TEST(FaceTrimFindLine, IsExactForStraightBorders) {
  Model model = trim_models::PlaneModel(-10, 10, -10, 10);
  trim_models::AddLoop(model, trim_models::Polygon({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}));
  const FaceTrim trim = FaceTrim::Build(model, 0);
  const TrimLine border = trim.FindLine(3, 6, -1, 1, 9);
  EXPECT_LT(border.w, 1e-9);
  EXPECT_NEAR(border.a / border.c, -3, 1e-6);  // s = 1/3 is u = 5, and the face is on the left
  EXPECT_GT(border.c, 0);
  const TrimLine whole = trim.FindLine(-1, 1, -1, 1, 9);
  EXPECT_EQ(whole.w, 0);
  EXPECT_GT(whole.c, 0);
  const TrimLine nothing = trim.FindLine(6, 7, 6, 7, 9);
  EXPECT_EQ(nothing.w, 0);
  EXPECT_LT(nothing.c, 0);
  // A corner has no line that is narrow.
  EXPECT_GT(trim.FindLine(4, 6, 4, 6, 9).w, 0.3);
}

}  // namespace
}  // namespace facetless
