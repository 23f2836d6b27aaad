// Places of leaves: the rectangle that follows from the halvings is bitwise equal to the splitter's.
#include "render/nurbs/leaf_place.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace facetless {
namespace {

TEST(LeafPlace, AWholePatchIsItsBounds) {
  const ParameterRect rect = RectOf({}, {-0.125, 1, 0, 1.0625});
  EXPECT_EQ(rect.U(-1), -0.125);
  EXPECT_EQ(rect.U(1), 1);
  EXPECT_EQ(rect.V(-1), 0);
  EXPECT_EQ(rect.V(1), 1.0625);
}

TEST(LeafPlace, HalvingsOfOneDirectionLeaveTheOtherAlone) {
  LeafPlace place{0, 7, 0, 0};
  place = Halved(place, Direction::kV, true);   // v in [1/2, 1]
  place = Halved(place, Direction::kU, false);  // u in [0, 1/2]
  place = Halved(place, Direction::kU, true);   // u in [1/4, 1/2]
  place = Halved(place, Direction::kV, false);  // v in [1/2, 3/4]
  EXPECT_EQ(place.patch, 7u);
  const ParameterRect rect = RectOf(place, {});
  EXPECT_EQ(rect.U(-1), 0.25);
  EXPECT_EQ(rect.U(1), 0.5);
  EXPECT_EQ(rect.V(-1), 0.5);
  EXPECT_EQ(rect.V(1), 0.75);
}

// The bounds have no short binary fraction, so that every step rounds. The halvings reach the last level,
// also in one direction only.
RC_GTEST_PROP(LeafPlace, TheRectangleIsThatOfHalvingStepByStep, ()) {
  const double tenth = 0.1 / 3;
  const PatchBounds bounds{-*rc::gen::element(0.0, tenth), 1 + *rc::gen::element(0.0, tenth),
                           -*rc::gen::element(0.0, tenth), 1 + *rc::gen::element(0.0, tenth)};
  const int halvings = *rc::gen::inRange(0, kMostPatchHalvings + 1);
  const int in_u = *rc::gen::element(0, 1, 2);  // one of three values
  LeafPlace place;
  ParameterRect rect = RectOf(place, bounds);
  for (int k = 0; k < halvings; ++k) {
    const bool along_u = *rc::gen::inRange(0, 2) < in_u, upper = *rc::gen::arbitrary<bool>();
    place = Halved(place, along_u ? Direction::kU : Direction::kV, upper);
    double& half = along_u ? rect.u_half : rect.v_half;
    double& mid = along_u ? rect.u_mid : rect.v_mid;
    half = half / 2;
    mid = upper ? mid + half : mid - half;
  }
  const ParameterRect found = RectOf(place, bounds);
  RC_ASSERT(found.u_mid == rect.u_mid && found.u_half == rect.u_half);
  RC_ASSERT(found.v_mid == rect.v_mid && found.v_half == rect.v_half);
}

}  // namespace
}  // namespace facetless
