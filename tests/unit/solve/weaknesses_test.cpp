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

TEST(NewtonMethods, MoveOverTheWholeFace) {
  // The two sides of a roof are two patches of one face, and the search begins on the wrong one.
  const Model roof = testing::ModelOf({testing::Roof()});
  const Camera camera = NamedView("top", roof.bounds, Projection::kOrthographic, 100, 100).value();
  const CameraFrame frame = MakeFrame(camera, roof.Diagonal()).value();
  for (const bool trimmed : {false, true}) {
    SolverScene scene(frame, {0, 0, 0});
    const std::vector<RectClass> classes{RectClass::kInside, RectClass::kOutside};
    scene.AddFace(roof, 0, {}, 0, nullptr, trimmed ? classes : std::vector<RectClass>{});
    ASSERT_EQ(scene.patches().size(), trimmed ? 1u : 2u);
    for (const char* name : {"newton-cramer", "martin"}) {
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
      EXPECT_NEAR(state->roots[0].u, 0.5, 1e-9);
    }
  }
}

}  // namespace
}  // namespace facetless
