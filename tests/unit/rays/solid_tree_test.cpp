// Traces rays in any direction from inside the material, and compares the hits with the sign changes of a
// torus' equation.
#include "render/rays/solid_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

constexpr double kMajor = 20, kMinor = 6;

// Returns the distance to the centre line less the tube's radius, in mm; it is below 0 inside the tube.
double Outside(Vec3 p) {
  const double ring = std::sqrt(p.x * p.x + p.y * p.y) - kMajor;
  return std::sqrt(ring * ring + p.z * p.z) - kMinor;
}

class TorusTree : public ::testing::Test {
 protected:
  TorusTree()
      : model_(testing::ModelOf({testing::Torus({0, 0, 0}, kMajor, kMinor)})),
        scene_(model_),
        surfaces_{SurfaceEval(model_, 0)},
        tree_(scene_, surfaces_, {0}) {}

  Model model_;
  Scene scene_;
  std::vector<SurfaceEval> surfaces_;
  SolidTree tree_;
};

TEST_F(TorusTree, ARayLeavesWhereTheEquationSays) {
  constexpr unsigned kSeed = 11;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 engine(kSeed);
  const auto number = [&] { return double(engine() >> 11) * 0x1p-52 - 1; };
  for (int n = 0; n < 3000; ++n) {
    const double around = std::numbers::pi * number(), tube = std::numbers::pi * number();
    // Half of the rays start so close to the surface that many pass it at a grazing angle.
    const double depth = n % 2 == 0 ? 0.999 : 0.9 * std::fabs(number());
    const double ring = kMajor + depth * kMinor * std::cos(tube);
    const Vec3 origin{ring * std::cos(around), ring * std::sin(around), depth * kMinor * std::sin(tube)};
    const Vec3 direction = (2 + number()) * Normalized({number(), number(), number()});
    const std::optional<SolidHit> hit = tree_.Nearest(origin, direction, 0);
    ASSERT_TRUE(hit) << n;
    EXPECT_NEAR(Outside(origin + hit->t * direction), 0, 1e-11) << n;
    // March along the ray: no crossing that the steps find may come before the answer.
    constexpr double kStep = 0.01;
    for (double t = 0; t < hit->t - kStep; t += kStep)
      ASSERT_LT(Outside(origin + t * direction), 1e-9) << n << ": " << t << " of " << hit->t;
  }
}

TEST_F(TorusTree, TheStartItselfIsNoCrossing) {
  const Vec3 on_surface{kMajor + kMinor, 0, 0};
  const std::optional<SolidHit> hit = tree_.Nearest(on_surface, {-1, 0, 0}, 1e-6);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 2 * kMinor, 1e-12);
  EXPECT_FALSE(tree_.Nearest(on_surface, {1, 0, 0}, 1e-6)) << "an outward ray must not hit anything";
}

}  // namespace
}  // namespace facetless
