// The oracle's own even-odd rule, on faces whose shape is known.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/nurbs/trim_models.h"
#include "tests/verify/oracle/oracle.h"

namespace facetless::oracle {
namespace {

using trim_models::AddLoop;
using trim_models::HalfCylinderModel;
using trim_models::Outline;
using trim_models::PlaneModel;
using trim_models::Polygon;
using trim_models::Reversed;

// A vertical ray, downwards through (x, y).
ViewRay Down(double x, double y) {
  View view;
  view.target = {x, y, 0};
  view.eye = {x, y, 8};
  view.up = {0, 1, 0};
  return ViewPixelRay(view, 0.5, 0.5);
}

Standing StandingAt(const Model& model, double x, double y) {
  const std::vector<Crossing> crossings = Oracle(model).Crossings(Down(x, y), -INFINITY);
  return crossings.size() == 1 ? crossings[0].standing : Standing::kUnsure;
}

// A circle of radius 1 in quarters with integer coefficients, which are exact.
Outline ExactCircle() {
  Outline outline(1);
  double c = 1, s = 0;
  for (int quarter = 0; quarter < 4; ++quarter) {
    outline[0].emplace_back();
    for (const Vec3 p : {Vec3{1, 0, 1}, Vec3{1, 1, 1}, Vec3{0, 2, 2}})
      outline[0].back().push_back({c * p.x - s * p.y, s * p.x + c * p.y, p.z});
    const double turned = -s;
    s = c;
    c = turned;
  }
  return outline;
}

TEST(OracleTrim, ACircleToTheLastBit) {
  Model model = PlaneModel(-4, 4, -4, 4);
  AddLoop(model, Polygon({{-3, -3}, {3, -3}, {3, 3}, {-3, 3}}));
  AddLoop(model, Reversed(ExactCircle()));
  EXPECT_EQ(StandingAt(model, 0, 0), Standing::kOutside);
  EXPECT_EQ(StandingAt(model, 2, 0), Standing::kInside);
  EXPECT_EQ(StandingAt(model, 3.5, 0), Standing::kOutside);
  EXPECT_EQ(StandingAt(model, 0.6, 0.8 + 0x1p-52), Standing::kInside)
      << "the rounding of 0.6 and 0.8 is smaller than that";
  for (double size = 0x1p-1; size > 0x1p-52; size /= 2) {
    EXPECT_EQ(StandingAt(model, 1 + size, 0), Standing::kInside) << size;
    EXPECT_EQ(StandingAt(model, 1 - size, 0), Standing::kOutside) << size;
    EXPECT_EQ(StandingAt(model, 0, -1 - size), Standing::kInside) << size;
    EXPECT_EQ(StandingAt(model, 0, -1 + size), Standing::kOutside) << size;
  }
}

RC_GTEST_PROP(OracleTrim, ACircleAnywhere, ()) {
  Model model = PlaneModel(-4, 4, -4, 4);
  AddLoop(model, ExactCircle());
  const auto number = [] { return *rc::gen::inRange(-1200000, 1200001) * 1e-6; };
  const double x = number(), y = number();
  const Real square = Real(x) * x + Real(y) * y;
  RC_PRE(square != 1);
  RC_ASSERT(StandingAt(model, x, y) == (square < 1 ? Standing::kInside : Standing::kOutside));
  const std::vector<Crossing> crossings = Oracle(model).Crossings(Down(x, y), -INFINITY);
  const double distance = Oracle(model).TrimDistance(crossings[0], 10);
  RC_ASSERT(std::fabs(distance - std::fabs(1 - static_cast<double>(Sqrt(square)))) <=
            1e-5 * distance + 1e-14);
}

TEST(OracleTrim, AnglesStayAngles) {
  // A rectangle in angle and height on half a cylinder. A ray through its wall is inside if and only if its
  // angle is. The model's weight cos 45° is rounded, which moves points by 1e-16, but the rays miss the
  // border by more.
  const double low = 0.3, high = 1.9;
  Model model = HalfCylinderModel(2, 5);
  AddLoop(model, Polygon({{low, 1}, {high, 1}, {high, 4}, {low, 4}}));
  for (const double off : {1e-1, 1e-4, 1e-8, 1e-13}) {
    for (const double angle : {low, high}) {
      for (const double way : {-1.0, 1.0}) {
        const double u = angle + way * off;
        View view;
        view.eye = {0, 0, 2.5};
        view.target = {std::cos(u), std::sin(u), 2.5};
        view.up = {0, 0, 1};
        const std::vector<Crossing> crossings = Oracle(model).Crossings(ViewPixelRay(view, 0.5, 0.5), 0);
        ASSERT_EQ(crossings.size(), 1u);
        EXPECT_NEAR(static_cast<double>(crossings[0].u), u, 1e-15);
        EXPECT_EQ(crossings[0].standing, u > low && u < high ? Standing::kInside : Standing::kOutside) << u;
      }
    }
  }
}

TEST(OracleTrim, TheEdgeIsMeasuredAcrossTheRay) {
  Model model = PlaneModel(-4, 4, -4, 4);
  AddLoop(model, Polygon({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}), 0.25);
  const Oracle oracle(model);
  const EdgeContact contact = oracle.NearestEdge(Down(1.125, 0.5), 0, 8, 0, 1);
  ASSERT_NE(contact.coedge, kNoIndex);
  EXPECT_NEAR(contact.distance_mm, 0.125, 1e-7);
  EXPECT_EQ(contact.gap_mm, 0.25);
  EXPECT_NEAR(contact.depth, 8, 1e-12);
  EXPECT_EQ(oracle.NearestEdge(Down(1.5, 0.5), 0, 8, 0, 1).coedge, kNoIndex) << "beyond the gap";
  EXPECT_EQ(oracle.NearestEdge(Down(1.125, 0.5), 0, 5, 0, 1).coedge, kNoIndex) << "at another depth";
}

}  // namespace
}  // namespace facetless::oracle
