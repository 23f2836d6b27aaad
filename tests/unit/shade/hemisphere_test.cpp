// The directions of ambient occlusion cover the hemisphere evenly by the cosine, and differ between neighbours.
#include "render/shade/hemisphere.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

namespace facetless {
namespace {

Vec3 AnyUnitVector() {
  Vec3 v{};
  while (!(Length(v) > 0.1)) {
    const auto part = [] { return *rc::gen::inRange(-1000, 1001) / 1000.0; };
    v = {part(), part(), part()};
  }
  return Normalized(v);
}

TEST(Hemisphere, DirectionsAreUnitVectorsAboveTheHorizon) {
  for (int count = 1; count <= 1024; count = count * 3 / 2 + 1) {
    const Hemisphere hemisphere(count);
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) {
        const auto set = hemisphere.Set(column, row);
        ASSERT_EQ(set.size(), static_cast<std::size_t>(count));
        for (const Vec3 d : set) {
          EXPECT_NEAR(Length(d), 1, 1e-15);
          EXPECT_GT(d.z, 0);
        }
        // The sets repeat every 4 samples.
        EXPECT_EQ(set.data(), hemisphere.Set(column + 4, row + 8).data());
      }
    }
  }
}

TEST(Hemisphere, NeighboursHaveOtherDirections) {
  const Hemisphere hemisphere(16);
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < i; ++j)
      EXPECT_GT(Length(hemisphere.Set(i % 4, i / 4)[0] - hemisphere.Set(j % 4, j / 4)[0]), 1e-3);
}

TEST(Hemisphere, TheShareOfDirectionsIsTheIntegralOfTheCosine) {
  // The sky that a wall along the y axis hides up to the elevation e is (1 − cos e) / 2 of the whole, weighted by the
  // cosine; half of the directions lie on its side.
  EXPECT_TRUE(rc::check("a wall of any height, in any direction", [] {
    const int count = *rc::gen::inRange(16, 1025);
    const double turn = *rc::gen::inRange(0, 6283) / 1000.0, elevation = *rc::gen::inRange(1, 1570) / 1000.0;
    const int column = *rc::gen::inRange(0, 4), row = *rc::gen::inRange(0, 4);
    const Hemisphere hemisphere(count);
    int hidden = 0;
    for (const Vec3 d : hemisphere.Set(column, row)) {
      const double across = d.x * std::cos(turn) + d.y * std::sin(turn);
      // The wall is infinitely long, so only the angle in the plane across it matters.
      hidden += across > 0 && d.z < std::tan(elevation) * across;
    }
    const double expected = (1 - std::cos(elevation)) / 2;
    // The lattice's error falls faster than that of random directions.
    RC_ASSERT(std::fabs(static_cast<double>(hidden) / count - expected) <
              2.0 / std::sqrt(count * std::sqrt(count)));
  }));
}

TEST(LocalFrame, IsOrthonormalAndRightHandedAroundAnyAxis) {
  const auto check = [](Vec3 axis) {
    const LocalFrame frame(axis);
    for (const double product : {Dot(frame.x, frame.y), Dot(frame.x, frame.z), Dot(frame.y, frame.z)})
      RC_ASSERT(std::fabs(product) < 1e-14);
    RC_ASSERT(Length(Cross(frame.x, frame.y) - frame.z) < 1e-14);
    RC_ASSERT(Length(frame.ToWorld({0, 0, 1}) - axis) < 1e-15);
  };
  EXPECT_TRUE(rc::check("any axis", [&] { check(AnyUnitVector()); }));
  EXPECT_TRUE(rc::check("the axes of the model", [&] {
    for (const Vec3 axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}})
      check(axis);
  }));
}

}  // namespace
}  // namespace facetless
