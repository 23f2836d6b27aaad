// What the methods that clip do not promise: each case shows a weakness that the header of the method names, and that
// another method does not have it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/solve/coherent_newton.h"
#include "tests/unit/solve/clip_cases.h"

namespace facetless {
namespace {

using testing::clip::Answer;
using testing::clip::Ask;
using testing::clip::Biquadratic;
using testing::clip::Condition;
using testing::clip::Distance;
using testing::clip::DrawNet;
using testing::clip::PlainView;
using testing::clip::Prepared;
using testing::clip::RayThrough;
using testing::clip::RayTo;
using testing::clip::RootsNear;
using testing::clip::Stops;

// Patches whose pixel coordinates are given.
SolverScene SceneOf(double (*x)(double, double), double (*y)(double, double)) {
  SolverScene scene(PlainView(), {});
  scene.AddPatch(2, 2, Biquadratic(x, y));
  return scene;
}
Answer AskBy(const char* name, const SolverScene& scene, double x, double y) {
  return Ask(*Prepared(name, scene), RayThrough(scene, x, y));
}

TEST(ClippingWeaknesses, BezierClippingLosesRootsOnBorders) {
  std::mt19937_64 engine(1);
  int asked = 0, lost = 0, lost_by_robust = 0;
  for (int k = 0; k < 100; ++k) {
    SolverScene scene(testing::clip::DrawView(engine), {});
    scene.AddPatch(3, 3, DrawNet(3, 3, 0.05, 1, engine));
    const double u = k % 2, v = testing::clip::Draw(engine, 0, 1);
    if (Condition(scene, 0, u, v) < 30) continue;
    ++asked;
    const SolverRay ray = RayTo(scene, 0, u, v);
    lost += RootsNear(Ask(*Prepared("bezier-clipping", scene), ray), u, v, 1e-9) == 0;
    lost_by_robust += RootsNear(Ask(*Prepared("robust-clipping", scene), ray), u, v, 1e-9) == 0;
  }
  EXPECT_GT(asked, 50);
  // The root is rounded to one side of the border or the other.
  EXPECT_GT(lost, asked / 5);
  EXPECT_EQ(lost_by_robust, 0);
}

TEST(ClippingWeaknesses, BezierClippingInventsRootsOnASurfaceSeenEdgeOn) {
  // The plane of the patch holds the ray, and the curve u + v = 0.5 lies on it.
  const SolverScene scene =
      SceneOf([](double u, double v) { return 100 * (u + v); }, [](double, double) { return 0.0; });
  const SolverRay ray = RayThrough(scene, 50, 0);
  const Answer invented = AskBy("bezier-clipping", scene, 50, 0);
  EXPECT_EQ(Stops(invented, SolverStop::kSteps), 1u);
  ASSERT_EQ(invented.roots.size(), 8u);  // Bézout's number
  for (const SolverRoot& root : invented.roots) EXPECT_GT(Distance(scene, ray, root), 49);
  // Newton's method with coherence begins with the same.
  EXPECT_EQ(AskBy("coherent-newton", scene, 50, 0).roots.size(), 8u);
  // The robust method follows the curve until no work is left. What it finds lies on the ray.
  const Answer robust = AskBy("robust-clipping", scene, 50, 0);
  EXPECT_EQ(Stops(robust, SolverStop::kWork), 1u);
  ASSERT_FALSE(robust.roots.empty());
  for (const SolverRoot& root : robust.roots) EXPECT_LT(Distance(scene, ray, root), 1e-8);
  EXPECT_TRUE(AskBy("robust-clipping", scene, 50, 1e-9).roots.empty());
}

TEST(ClippingWeaknesses, BezierClippingReportsARootOfTwoHalvesTwice) {
  // Three roots along u lie symmetrically, so that the patch is halved at the middle one.
  SolverScene scene(PlainView(), {});
  std::vector<Vec4> points;
  for (const double y : {-45, 150, -150, 45})
    for (const double x : {-50, 50}) points.push_back({x, y, 0, 1});
  scene.AddPatch(3, 1, points);
  const Answer twice = AskBy("bezier-clipping", scene, 0, 0), once = AskBy("robust-clipping", scene, 0, 0);
  EXPECT_EQ(RootsNear(twice, 0.5, 0.5, 1e-9), 2);
  EXPECT_EQ(RootsNear(once, 0.5, 0.5, 1e-9), 1);
  EXPECT_EQ(once.roots.size(), 3u);
}

TEST(ClippingWeaknesses, ATangentRootIsLostOrReportedManyTimesByBezierClipping) {
  // The ray touches the outline of the patch at u = 0.3, up to rounding.
  const SolverScene scene = SceneOf([](double, double v) { return 100 * v; },
                                    [](double u, double) { return 100 * (u - 0.3) * (u - 0.3); });
  const double at = 30.125;
  EXPECT_NE(RootsNear(AskBy("bezier-clipping", scene, at, 0), 0.3, at / 100, 1e-6), 1);
  EXPECT_EQ(RootsNear(AskBy("robust-clipping", scene, at, 0), 0.3, at / 100, 1e-6), 1);
}

TEST(ClippingWeaknesses, BezierClippingOnlyHalvesWhereSidesCancel) {
  // A bow tie: its sides in u cancel, so that there is no line for v.
  SolverScene scene(PlainView(), {});
  scene.AddPatch(1, 1, std::vector<Vec4>{{-50, -40, 0, 1}, {50, 40, 0, 1}, {50, -40, 0, 1}, {-50, 40, 0, 1}});
  const SolverRay ray = RayTo(scene, 0, 0.3, 0.2);
  const Answer plain = Ask(*Prepared("bezier-clipping", scene), ray);
  const Answer robust = Ask(*Prepared("robust-clipping", scene), ray);
  EXPECT_EQ(RootsNear(robust, 0.3, 0.2, 1e-9), 1);
  EXPECT_GT(plain.counters.iterations, robust.counters.iterations);
}

TEST(ClippingWeaknesses, RobustClippingHitsWhatRaysMissByLessThanRounding) {
  const SolverScene scene = SceneOf([](double, double v) { return 100 * v; },
                                    [](double u, double) { return 100 * (u - 0.5) * (u - 0.5); });
  // The ray passes beside the outline.
  EXPECT_FALSE(AskBy("robust-clipping", scene, 30, -1e-16).roots.empty());
  EXPECT_TRUE(AskBy("bezier-clipping", scene, 30, -1e-16).roots.empty());
  EXPECT_TRUE(AskBy("robust-clipping", scene, 30, -1e-9).roots.empty());
}

TEST(ClippingWeaknesses, RobustClippingMergesRootsThatAreTooClose) {
  const SolverScene scene = SceneOf([](double, double v) { return 100 * v; },
                                    [](double u, double) { return 100 * (u - 0.5) * (u - 0.5); });
  // The roots are at 0.5 ± √(depth/100).
  EXPECT_EQ(AskBy("robust-clipping", scene, 30, 1e-6).roots.size(), 2u);
  EXPECT_EQ(AskBy("robust-clipping", scene, 30, 1e-14).roots.size(), 1u);
}

TEST(ClippingWeaknesses, CoherentNewtonClipsWhereverAPatchFolds) {
  const SolverScene scene = SceneOf([](double, double v) { return 100 * v; },
                                    [](double u, double) { return 100 * (u - 0.5) * (u - 0.5); });
  const auto solver = Prepared("coherent-newton", scene);
  const auto base = solver->MakeState();
  const auto& state = static_cast<const CoherentNewtonState&>(*base);
  solver->BeginRow(0, *base);
  for (int i = 0; i < 20; ++i) {
    base->BeginRay();
    solver->Solve(RayThrough(scene, 20 + 1.3 * i, 7.3), StartOf(solver->pieces()[0]), *base);
    EXPECT_EQ(base->roots.size(), 2u);
  }
  EXPECT_EQ(state.by_newton, 0u);
  EXPECT_EQ(state.obstructed, 19u);
}

TEST(ClippingWeaknesses, CoherentNewtonLosesTheFirstRootOfARowAsClippingDoes) {
  // The border u = 0 lies on the ray up to rounding: clipping loses it, and Newton's method from a neighbour finds it.
  std::mt19937_64 engine(2);
  int lost_first = 0, lost_later = 0, asked = 0;
  for (int k = 0; k < 100; ++k) {
    SolverScene scene(testing::clip::DrawView(engine), {});
    scene.AddPatch(2, 2, DrawNet(2, 2, 0.02, 1, engine));
    const double v = testing::clip::Draw(engine, 0.1, 0.9);
    if (Condition(scene, 0, 0, v) < 60) continue;
    const auto solver = Prepared("coherent-newton", scene);
    const SolverRay ray = RayTo(scene, 0, 0, v), before = RayTo(scene, 0, 0.01, v);
    const auto state = solver->MakeState();
    solver->BeginRow(0, *state);
    state->BeginRay();
    solver->Solve(before, StartOf(solver->pieces()[0]), *state);
    state->BeginRay();
    solver->Solve(ray, StartOf(solver->pieces()[0]), *state);
    ++asked;
    lost_later += RootsNear({state->roots, {}, 0}, 0, v, 1e-9) == 0;
    lost_first += RootsNear(Ask(*solver, ray), 0, v, 1e-9) == 0;
  }
  EXPECT_GT(asked, 20);
  EXPECT_GT(lost_first, 5);
  EXPECT_LT(lost_later, lost_first);
}

}  // namespace
}  // namespace facetless
