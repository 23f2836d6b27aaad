// Tests the oracle itself: its numbers, its closed forms, and its subdivision on the same surfaces as
// patches.
#include "tests/verify/oracle/closed_forms.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"
#include "tests/verify/oracle/oracle.h"

namespace facetless::oracle {
namespace {

double AsDouble(Real x) {
  return static_cast<double>(x);
}

TEST(Real, PiHasItsDigits) {
  // π is a sum of three doubles, from its published digits.
  const Real digits =
      Real(3.141592653589793116) + Real(1.2246467991473532e-16) - Real(2.9947698097183397e-33);
  EXPECT_LE(AsDouble(Abs(Pi() - digits)), 1e-33);
}

TEST(Real, SquareRootsAndTangentsInvert) {
  for (double x = 0.001; x < 1000; x *= 1.37) {
    const Real root = Sqrt(x);
    EXPECT_LE(AsDouble(Abs(root * root - x)), 1e-33 * x);
  }
  for (double x = -3.9; x <= 3.9; x += 0.173) EXPECT_LE(AsDouble(Abs(Tan(Atan(x)) - x)), 1e-30) << x;
  EXPECT_LE(AsDouble(Abs(4 * Atan(1) - Pi())), 1e-32);
}

TEST(PolynomialRoots, FindsWhatWasMultipliedTogether) {
  // (t − 1)(t + 2)(t − 3)(t − 3.5) = t⁴ − 5.5t³ + 1.5t² + 24t − 21.
  const std::vector<Real> roots = PolynomialRoots({-21, 23.5, 2, -5.5, 1});
  ASSERT_EQ(roots.size(), 4u);
  const double expected[4] = {-2, 1, 3, 3.5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LE(AsDouble(Abs(roots[i] - expected[i])), 1e-30);
  EXPECT_TRUE(PolynomialRoots({1, 0, 1}).empty());
  EXPECT_EQ(PolynomialRoots({1, -2, 1}).size(), 1u) << "a double root";
}

// Quarter circles whose coefficients are small integers: x = 1 − t², y = 2t, w = 1 + t². They are exact in
// double, so that the closed form and the patch are the same surface to the last bit of Real.
struct QuarterPoint {
  double x, y, w;
};
std::vector<std::vector<QuarterPoint>> Quarters(int first, int count) {
  std::vector<std::vector<QuarterPoint>> arcs;
  for (int q = first; q < first + count; ++q) {
    arcs.emplace_back();
    for (const QuarterPoint p : {QuarterPoint{1, 0, 1}, {1, 1, 1}, {0, 2, 2}}) {
      const double c = q % 4 == 0 ? 1 : q % 4 == 2 ? -1 : 0, s = q % 4 == 1 ? 1 : q % 4 == 3 ? -1 : 0;
      arcs.back().push_back({c * p.x - s * p.y, s * p.x + c * p.y, p.w});
    }
  }
  return arcs;
}

// Rotates profile points (radius, height, weight) about z.
Model Turned(const std::vector<std::vector<QuarterPoint>>& profile) {
  testing::PatchGrid grid;
  grid.degree_u = 2;
  grid.degree_v = static_cast<int>(profile[0].size()) - 1;
  for (const auto& turn : Quarters(0, 4)) {
    for (const auto& arc : profile)
      for (const QuarterPoint& a : turn)
        for (const QuarterPoint& b : arc) grid.points.push_back({a.x * b.x, a.y * b.x, a.w * b.y, a.w * b.w});
    grid.u_spans.push_back({double(grid.u_spans.size()), double(grid.u_spans.size() + 1)});
  }
  for (std::size_t i = 0; i < profile.size(); ++i) grid.v_spans.push_back({double(i), double(i + 1)});
  return testing::ModelOf({grid});
}

Model ExactSphere() {
  return Turned(Quarters(3, 2));
}
Model ExactTorus(double major) {
  auto profile = Quarters(0, 4);
  for (auto& arc : profile)
    for (QuarterPoint& p : arc) p.x += major * p.w;
  return Turned(profile);
}
// Radius 1 and height 2.
Model ExactCylinder() {
  return Turned({{{1, -1, 1}, {1, 1, 1}}});
}
// The apex is the origin; both halves, slope 1.
Model ExactCone() {
  return Turned({{{0, 0, 1}, {1, 1, 1}}, {{0, 0, 1}, {1, -1, 1}}});
}

// Returns a ray that passes the origin within `reach`, from any side.
ViewRay AnyRay(double reach) {
  const auto number = [](double size) { return size * (*rc::gen::inRange(-1000000, 1000001) * 1e-6); };
  View view;
  view.target = {number(reach), number(reach), number(reach)};
  view.eye = view.target + Vec3{number(5), number(5), 5 + number(1)};
  view.up = {0, 1, 0};
  view.perspective = *rc::gen::arbitrary<bool>();
  return ViewPixelRay(view, 0.5, 0.5);
}

// Checks for the same crossings, in the same order, to the last digits. `keep` selects the closed form's
// roots that lie on the patch.
template <typename Keep>
void ExpectSame(const Model& model, const ViewRay& ray, const std::vector<Real>& roots, const Keep& keep) {
  const std::vector<Crossing> crossings = Oracle(model).Crossings(ray, -INFINITY);
  std::vector<Real> expected;
  for (const Real root : roots)
    if (keep(ray.At(root))) expected.push_back(root);
  RC_ASSERT(crossings.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    RC_ASSERT(crossings[i].proven);
    RC_ASSERT(crossings[i].standing == Standing::kInside);
    RC_ASSERT(Abs(crossings[i].depth - expected[i]) * crossings[i].cosine <= 1e-29);
  }
}
bool Always(Real3) {
  return true;
}

RC_GTEST_PROP(ClosedForm, SphereIsItsPatches, ()) {
  const ViewRay ray = AnyRay(1.1);
  ExpectSame(ExactSphere(), ray, LineSphere({ray.origin, ray.direction}, {}, 1), Always);
}

RC_GTEST_PROP(ClosedForm, TorusIsItsPatches, ()) {
  const double major = *rc::gen::inRange(2, 6);
  const ViewRay ray = AnyRay(major);
  ExpectSame(ExactTorus(major), ray, LineTorus({ray.origin, ray.direction}, {}, {0, 0, 1}, major, 1), Always);
}

RC_GTEST_PROP(ClosedForm, CylinderIsItsPatches, ()) {
  const ViewRay ray = AnyRay(1.1);
  ExpectSame(ExactCylinder(), ray, LineCylinder({ray.origin, ray.direction}, {}, {0, 0, 1}, 1),
             [](Real3 p) { return Abs(p.z) <= 1; });
}

RC_GTEST_PROP(ClosedForm, ConeIsItsPatches, ()) {
  const ViewRay ray = AnyRay(1.1);
  ExpectSame(ExactCone(), ray, LineCone({ray.origin, ray.direction}, {}, {0, 0, 1}, 1),
             [](Real3 p) { return Abs(p.z) <= 1; });
}

// Rays that meet two or four patches at once, or meet a patch where it has no normal.
ViewRay RayThrough(Vec3 point, Vec3 direction) {
  View view;
  view.target = point;
  view.eye = point - 8 * direction;
  view.up = std::fabs(direction.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return ViewPixelRay(view, 0.5, 0.5);
}

TEST(Oracle, SeamsGiveOneCrossing) {
  const Model model = ExactSphere();
  for (const Vec3 direction : {Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0.6, 0.8}}) {
    const ViewRay ray = RayThrough({0, 0, 0}, direction);
    const std::vector<Crossing> crossings = Oracle(model).Crossings(ray, -INFINITY);
    const std::vector<Real> expected = LineSphere({ray.origin, ray.direction}, {}, 1);
    ASSERT_EQ(crossings.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(crossings[i].standing, Standing::kInside);
      EXPECT_LE(AsDouble(Abs(crossings[i].depth - expected[i])), 1e-29);
    }
  }
}

// Two patches meet in a ridge, seen horizontally: just below the ridge, a ray enters one and leaves the
// other.
TEST(Oracle, ARidgeSeenFromTheSideIsCrossedTwice) {
  const Model model = facetless::testing::ModelOf({facetless::testing::Roof()});
  for (const double below : {1e-3, 1e-9, 1e-13, 1e-20}) {
    const std::vector<Crossing> crossings =
        Oracle(model).Crossings(RayThrough({0, 0.1, -below}, {1, 0, 0}), -INFINITY);
    ASSERT_EQ(crossings.size(), 2u) << below;
    EXPECT_NEAR(AsDouble(crossings[1].depth - crossings[0].depth) / (0.4 * below), 1, 1e-9);
    for (const Crossing& crossing : crossings) EXPECT_EQ(crossing.standing, Standing::kInside);
  }
  EXPECT_TRUE(Oracle(model).Crossings(RayThrough({0, 0.1, 1e-9}, {1, 0, 0}), -INFINITY).empty());
}

TEST(Oracle, PolesAreDoubtsAtTheRightDepth) {
  const Model model = ExactSphere();
  for (const double way : {1.0, -1.0}) {
    const std::vector<Crossing> crossings =
        Oracle(model).Crossings(RayThrough({0, 0, 0}, {0, 0, way}), -INFINITY);
    ASSERT_EQ(crossings.size(), 2u);
    for (const Crossing& crossing : crossings) EXPECT_FALSE(crossing.proven);
    EXPECT_LE(AsDouble(Abs(crossings[0].depth - 7)), 1e-15);
    EXPECT_LE(AsDouble(Abs(crossings[1].depth - 9)), 1e-15);
  }
}

TEST(Oracle, TangentsAreOneDoubtAndNeighboursArePairsOrNothing) {
  const Model model = ExactSphere();
  const Vec3 direction{0, 0.6, 0.8};
  const auto crossings = [&](double x) {
    return Oracle(model).Crossings(RayThrough({x, 0, 0}, direction), -INFINITY);
  };
  ASSERT_EQ(crossings(1).size(), 1u);
  EXPECT_FALSE(crossings(1)[0].proven);
  EXPECT_NEAR(AsDouble(crossings(1)[0].depth), 8, 1e-7);
  EXPECT_EQ(crossings(1 + 0x1p-50).size(), 0u);
  const ViewRay ray = RayThrough({1 - 0x1p-50, 0, 0}, direction);
  const std::vector<Crossing> pair = crossings(1 - 0x1p-50);
  const std::vector<Real> expected = LineSphere({ray.origin, ray.direction}, {}, 1);
  ASSERT_EQ(pair.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(pair[i].proven);
    EXPECT_LE(AsDouble(Abs(pair[i].depth - expected[i])), 1e-22);
  }
}

TEST(Oracle, APlaneSeenEdgeOnIsADoubt) {
  const Model model = testing::ModelOf({testing::Rectangle({0, 0, 0}, {1, 0.25, 0}, {0.5, 1, 0})});
  const std::vector<Crossing> crossings =
      Oracle(model).Crossings(RayThrough({0.5, 0.5, 0}, {0.6, 0.8, 0}), -INFINITY);
  ASSERT_EQ(crossings.size(), 1u);
  EXPECT_FALSE(crossings[0].proven);
  EXPECT_GT(AsDouble(crossings[0].half_depth), 0.25);
  EXPECT_TRUE(Oracle(model).Crossings(RayThrough({0.5, 0.5, 0x1p-80}, {0.6, 0.8, 0}), -INFINITY).empty());
}

}  // namespace
}  // namespace facetless::oracle
