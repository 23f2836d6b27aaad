// What the iterations of the thesis, and Martin's, do not promise, each shown by a case in which it happens.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"
#include "tests/unit/solve/sheets.h"

namespace facetless {
namespace {

using testing::MakeSolver;
using testing::RayThrough;
using testing::SceneOf;
using testing::Sheet;
using testing::SheetFrame;
using testing::StartAt;

std::uint64_t Stops(const SolverState& state, SolverStop stop) {
  return state.counters.stops[static_cast<std::size_t>(stop)];
}

// A half pipe that is seen from its side: x = 40 − 160·(u − ½)², so the outline is at u = ½, x = 40 mm.
SolverScene Pipe() {
  Sheet sheet{2, 1, {}};
  for (const double z : {-20.0, 20.0}) sheet.points.push_back({0, -20, z, 1});
  for (const double z : {-20.0, 20.0}) sheet.points.push_back({80, 0, z, 1});
  for (const double z : {-20.0, 20.0}) sheet.points.push_back({0, 20, z, 1});
  return SceneOf(SheetFrame(false), sheet);
}

// The pixel coordinate of an x in mm.
double Column(const SolverScene& scene, double x) {
  return (x - scene.frame().eye.x) * scene.frame().right.x / scene.frame().pixel_x;
}

TEST(NewtonCramer, LosesARootFromABadStartAtAnOutline) {
  const SolverScene scene = Pipe();
  const auto solver = MakeSolver("newton-cramer", scene);
  const auto state = solver->MakeState();
  // The ray passes inside the outline, at u = ½ ± 1/4. The start is almost on the outline, where a step is far too long.
  const SolverRay ray = RayThrough(scene, Column(scene, 30), 0.25);
  state->BeginRay();
  solver->Solve(ray, StartAt(0, 0.5 + 1e-3, 0.5, true), *state);
  EXPECT_TRUE(state->roots.empty());
  EXPECT_EQ(Stops(*state, SolverStop::kLeft), 1u);
  // From a value of the map that is right to within a pixel, the root is found.
  solver->Solve(ray, StartAt(0, 0.74, 0.5, true), *state);
  ASSERT_EQ(state->roots.size(), 1u);
  EXPECT_NEAR(state->roots[0].u, 0.75, 1e-9);
}

TEST(NewtonCramer, FindsTheRootOfItsStartWhichNeedNotBeTheNearest) {
  const SolverScene scene = Pipe();
  const auto solver = MakeSolver("newton-cramer", scene);
  const auto state = solver->MakeState();
  const SolverRay ray = RayThrough(scene, Column(scene, 30), 0.25);
  for (const double start : {0.2, 0.8}) {
    state->BeginRay();
    solver->Solve(ray, StartAt(0, start, 0.5, true), *state);
    ASSERT_EQ(state->roots.size(), 1u);
    EXPECT_NEAR(state->roots[0].u, start < 0.5 ? 0.25 : 0.75, 1e-9);
  }
}

TEST(NewtonMethods, DoNotFindATangentRoot) {
  const SolverScene scene = Pipe();
  for (const char* name : {"newton-cramer", "martin"}) {
    SCOPED_TRACE(name);
    const auto solver = MakeSolver(name, scene);
    const auto state = solver->MakeState();
    state->BeginRay();
    solver->Solve(RayThrough(scene, Column(scene, 40), 0.25), StartAt(0, 0.75, 0.5, false), *state);
    EXPECT_TRUE(state->roots.empty());
    EXPECT_EQ(Stops(*state, SolverStop::kSteps), 1u);
    EXPECT_EQ(state->counters.iterations, 8u);
  }
}

TEST(NewtonMethods, SayThatTheJacobianIsSingularAtTheStart) {
  const SolverScene scene = Pipe();
  for (const char* name : {"newton-cramer", "martin"}) {
    SCOPED_TRACE(name);
    const auto solver = MakeSolver(name, scene);
    const auto state = solver->MakeState();
    state->BeginRay();
    solver->Solve(RayThrough(scene, Column(scene, 30), 0.25), StartAt(0, 0.5, 0.5, false), *state);
    EXPECT_TRUE(state->roots.empty());
    EXPECT_EQ(Stops(*state, SolverStop::kSingular), 1u);
  }
}

TEST(WholeFaceMethods, MoveOverTheWholeFace) {
  // The two sides of a roof are two patches of one face, and the search begins on the wrong one.
  const Model roof = testing::ModelOf({testing::Roof()});
  const Camera camera = NamedView("top", roof.bounds, Projection::kOrthographic, 100, 100).value();
  const CameraFrame frame = MakeFrame(camera, roof.Diagonal()).value();
  for (const bool trimmed : {false, true}) {
    SolverScene scene(frame, {0, 0, 0});
    const std::vector<RectClass> classes{RectClass::kInside, RectClass::kOutside};
    scene.AddFace(roof, 0, {}, 0, nullptr, trimmed ? classes : std::vector<RectClass>{});
    ASSERT_EQ(scene.patches().size(), trimmed ? 1u : 2u);
    for (const char* name : {"newton-cramer", "steepest-descent", "martin"}) {
      SCOPED_TRACE(name);
      const auto solver = MakeSolver(name, scene);
      const auto state = solver->MakeState();
      state->BeginRay();
      const SolverRay ray = RayThrough(scene, 0.5 / frame.pixel_x, 3);
      solver->Solve(ray, StartAt(0, 0.5, 0.5, false), *state);
      if (trimmed) {
        EXPECT_TRUE(state->roots.empty()) << "there is no surface";
        EXPECT_EQ(Stops(*state, SolverStop::kLeft), 1u);
        // Nor can a search begin there.
        solver->Solve(ray, StartAt(0, 1.5, 0.5, false), *state);
        EXPECT_EQ(Stops(*state, SolverStop::kLeft), 2u);
        continue;
      }
      ASSERT_EQ(state->roots.size(), 1u);
      EXPECT_EQ(state->roots[0].patch, 1u);
      EXPECT_NEAR(state->roots[0].u, 0.5, FindSolver(name)->tolerance_px);
    }
  }
}

TEST(Descents, StopInAMinimumThatIsNoRoot) {
  // x climbs to about 23 mm, falls, and climbs again to 40 mm. The search begins before the first climb.
  Sheet sheet{3, 1, {}};
  for (const double x : {0.0, 60.0, -20.0, 40.0})
    for (const double z : {-20.0, 20.0}) sheet.points.push_back({x, 0, z, 1});
  const SolverScene scene = SceneOf(SheetFrame(false), sheet);
  const SolverRay ray = RayThrough(scene, Column(scene, 35), 0.25);
  for (const char* name : {"gradient", "steepest-descent"}) {
    SCOPED_TRACE(name);
    const auto solver = MakeSolver(name, scene);
    const auto state = solver->MakeState();
    state->BeginRay();
    solver->Solve(ray, StartAt(0, 0.1, 0.5, true), *state);
    EXPECT_TRUE(state->roots.empty());
    EXPECT_EQ(Stops(*state, SolverStop::kDiverged), 1u);
    // There is a root, which is found from the other side.
    solver->Solve(ray, StartAt(0, 0.95, 0.5, true), *state);
    EXPECT_EQ(state->roots.size(), 1u);
  }
}

TEST(Descents, AreImpreciseWhereTheSurfaceIsSteep) {
  // Almost at the outline of a pipe, a thousandth of a pixel is much in parameters and in depth.
  const SolverScene scene = Pipe();
  const SolverRay ray = RayThrough(scene, Column(scene, 40 - 160 * 1e-4), 0.25);  // u = ½ ± 1/100
  const auto depth_error = [&](const char* name) {
    const auto solver = MakeSolver(name, scene);
    const auto state = solver->MakeState();
    state->BeginRay();
    solver->Solve(ray, StartAt(0, 0.49 - 2e-3, 0.5, true), *state);
    EXPECT_EQ(state->roots.size(), 1u) << name;
    return state->roots.empty() ? 0 : 40 * std::fabs(state->roots[0].u - 0.49);
  };
  EXPECT_LT(depth_error("newton-cramer"), 1e-7);
  EXPECT_GT(depth_error("gradient"), 1e-4);
  EXPECT_GT(depth_error("steepest-descent"), 1e-5);
}

TEST(Descents, RunOutOfStepsOnLongPatches) {
  // 80 mm long and 0.8 mm wide: the Jacobian has singular values in the ratio of 100 to 1.
  Sheet sheet{1, 1, {}};
  for (const double x : {-40.0, 40.0})
    for (const double z : {-0.4, 0.4}) sheet.points.push_back({x, 0, z, 1});
  const SolverScene scene = SceneOf(SheetFrame(false), sheet);
  const SolverRay ray = testing::RayTo(scene, 0, 0.5, 0.5);
  for (const char* name : {"gradient", "newton-cramer"}) {
    const auto solver = MakeSolver(name, scene);
    const auto state = solver->MakeState();
    state->BeginRay();
    solver->Solve(ray, StartAt(0, 0.45, 0.9, true), *state);
    EXPECT_EQ(Stops(*state, SolverStop::kSteps), name == std::string("gradient") ? 1u : 0u) << name;
    EXPECT_EQ(state->roots.size(), name == std::string("gradient") ? 0u : 1u) << name;
  }
}

TEST(Gradient, SearchesRandomPointsOnlyWithoutAMap) {
  const SolverScene scene = SceneOf(SheetFrame(false), testing::MakeSheet(3, 3, {}, 9));
  const auto solver = MakeSolver("gradient", scene);
  const auto state = solver->MakeState();
  const SolverRay ray = testing::RayTo(scene, 0, 0.3, 0.6);
  std::int64_t work[2];
  for (const bool from_map : {false, true}) {
    state->BeginRay();
    solver->Solve(ray, StartAt(0, 0.31, 0.61, from_map), *state);
    EXPECT_GE(state->roots.size(), 1u);
    work[from_map] = kMostRayWork - state->work_left;
  }
  EXPECT_GT(work[0], work[1] + 24) << "24 random points";
}

}  // namespace
}  // namespace facetless
