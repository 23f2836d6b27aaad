// What the methods that clip promise: roots of rays through known points of patches of all degrees, in random views; the
// stated tolerance; bounded work and finite roots for hostile nets; the same answer to the same question. What they do not
// promise is in clipping_weaknesses_test.cpp.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/solve/coherent_newton.h"
#include "tests/unit/solve/clip_cases.h"

namespace facetless {
namespace {

using testing::clip::Answer;
using testing::clip::Ask;
using testing::clip::Condition;
using testing::clip::Distance;
using testing::clip::Draw;
using testing::clip::DrawDegree;
using testing::clip::DrawNet;
using testing::clip::DrawView;
using testing::clip::Prepared;
using testing::clip::RayThrough;
using testing::clip::RayTo;
using testing::clip::RootsNear;
using testing::clip::Stops;

const char* const kNames[] = {"bezier-clipping", "robust-clipping", "coherent-newton"};
// Parameters of simple roots are right to this. A patch is about 100 pixels wide, so that it is more than the tolerance.
constexpr double kParameters = 1e-9;
// The condition of a root below which it is not asked for, pixels per parameter.
constexpr double kConditioned = 5;

struct Case {
  SolverScene scene;
  double u, v;
};

// A patch of any degrees in any view, and parameters of a root that is neither at an outline nor tangent.
template <typename Parameter>
Case DrawCase(std::mt19937_64& engine, double bump, double spread, const Parameter& parameter) {
  for (;;) {
    const int m = DrawDegree(engine), n = DrawDegree(engine);
    Case drawn{SolverScene(DrawView(engine), {}), parameter(engine), parameter(engine)};
    drawn.scene.AddPatch(m, n, DrawNet(m, n, bump, spread, engine));
    if (Condition(drawn.scene, 0, drawn.u, drawn.v) > kConditioned) return drawn;
  }
}

// Anywhere, and one time in four on a border.
double DrawParameter(std::mt19937_64& engine) {
  switch (engine() % 8) {
    case 0:
      return 0;
    case 1:
      return 1;
    default:
      return Draw(engine, 0, 1);
  }
}
double DrawInside(std::mt19937_64& engine) {
  return Draw(engine, 0.01, 0.99);
}

// The law that all solvers keep, whatever the net is.
void CheckLaws(const Answer& answer) {
  RC_ASSERT(std::accumulate(answer.counters.stops.begin(), answer.counters.stops.end(), std::uint64_t{0}) ==
            1u);
  RC_ASSERT(answer.counters.solves == 1u);
  RC_ASSERT(answer.counters.roots == answer.roots.size());
  for (const SolverRoot& root : answer.roots) {
    RC_ASSERT(root.u >= -kRootBorder && root.u <= 1 + kRootBorder);
    RC_ASSERT(root.v >= -kRootBorder && root.v <= 1 + kRootBorder);
  }
}

RC_GTEST_PROP(RobustClipping, FindsEveryRootOnceWithinTheTolerance, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const double spread = engine() % 2 == 0 ? 1 : Draw(engine, 1, 300);
  const Case drawn = DrawCase(engine, Draw(engine, 0, 0.4), spread, DrawParameter);
  const SolverRay ray = RayTo(drawn.scene, 0, drawn.u, drawn.v);
  const Answer answer = Ask(*Prepared("robust-clipping", drawn.scene), ray);
  CheckLaws(answer);
  RC_ASSERT(RootsNear(answer, drawn.u, drawn.v, kParameters) == 1);
  RC_ASSERT(Stops(answer, SolverStop::kRoot) == 1u);
  RC_ASSERT(answer.counters.iterations < 2000u);
  for (const SolverRoot& root : answer.roots)
    RC_ASSERT(Distance(drawn.scene, ray, root) <= FindSolver("robust-clipping")->tolerance_px);
}

RC_GTEST_PROP(BezierClipping, FindsRootsInsideOfPatches, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const double spread = engine() % 2 == 0 ? 1 : Draw(engine, 1, 30);
  const Case drawn = DrawCase(engine, Draw(engine, 0, 0.4), spread, DrawInside);
  const SolverRay ray = RayTo(drawn.scene, 0, drawn.u, drawn.v);
  const Answer answer = Ask(*Prepared("bezier-clipping", drawn.scene), ray);
  CheckLaws(answer);
  RC_ASSERT(Stops(answer, SolverStop::kRoot) == 1u);
  RC_ASSERT(RootsNear(answer, drawn.u, drawn.v, kParameters) == 1);
  for (const SolverRoot& root : answer.roots)
    if (std::fabs(root.u - drawn.u) < kParameters && std::fabs(root.v - drawn.v) < kParameters)
      RC_ASSERT(Distance(drawn.scene, ray, root) <= FindSolver("bezier-clipping")->tolerance_px);
  RC_ASSERT(answer.counters.iterations >= 2u);
  RC_ASSERT(answer.counters.iterations < 2000u);
}

// A row of rays through a patch.
std::vector<SolverRay> RowThrough(const SolverScene& scene, double u, double v, int count) {
  std::vector<SolverRay> row;
  const SolverRay middle = RayTo(scene, 0, u, v);
  for (int i = 0; i < count; ++i) {
    SolverRay ray = RayThrough(scene, middle.x + i - count / 2, middle.y);
    ray.column = i;
    row.push_back(ray);
  }
  return row;
}

// The roots of each ray of a row.
std::vector<std::vector<SolverRoot>> SolveRow(const Solver& solver, const std::vector<SolverRay>& row,
                                              SolverState& state) {
  std::vector<std::vector<SolverRoot>> roots;
  solver.BeginRow(0, state);
  for (const SolverRay& ray : row) {
    state.BeginRay();
    solver.Solve(ray, StartOf(solver.pieces()[0]), state);
    roots.push_back(state.roots);
  }
  return roots;
}

bool SameRoots(const std::vector<std::vector<SolverRoot>>& a, const std::vector<std::vector<SolverRoot>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const SolverRoot& r, const SolverRoot& s) {
      return r.patch == s.patch && r.u == s.u && r.v == s.v;
    });
  });
}

RC_GTEST_PROP(CoherentNewton, FindsTheRootsOfARow, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const double spread = engine() % 2 == 0 ? 1 : Draw(engine, 1, 30);
  const Case drawn = DrawCase(engine, Draw(engine, 0, 0.2), spread, DrawInside);
  const auto solver = Prepared("coherent-newton", drawn.scene),
             robust = Prepared("robust-clipping", drawn.scene);
  const auto state = solver->MakeState();
  const std::vector<SolverRay> row = RowThrough(drawn.scene, drawn.u, drawn.v, 16);
  const auto rows = SolveRow(*solver, row, *state);
  int inside = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    for (const SolverRoot& root : Ask(*robust, row[i]).roots) {
      // Clipping loses roots on the border.
      if (std::min({root.u, 1 - root.u, root.v, 1 - root.v}) < 1e-6 ||
          Condition(drawn.scene, 0, root.u, root.v) < kConditioned)
        continue;
      ++inside;
      RC_ASSERT(RootsNear({rows[i], {}, 0}, root.u, root.v, kParameters) == 1);
      for (const SolverRoot& found : rows[i])
        if (std::fabs(found.u - root.u) < kParameters && std::fabs(found.v - root.v) < kParameters)
          RC_ASSERT(Distance(drawn.scene, row[i], found) <= FindSolver("coherent-newton")->tolerance_px);
    }
  }
  RC_ASSERT(inside > 0);
  const auto& coherent = static_cast<const CoherentNewtonState&>(*state);
  RC_ASSERT(coherent.missed + coherent.first + coherent.by_newton + coherent.obstructed + coherent.failed ==
            row.size());
  RC_TAG(coherent.by_newton > 0);
}

TEST(CoherentNewton, NewtonAnswersAllRaysOfARowButTheFirst) {
  std::mt19937_64 engine(1);
  SolverScene scene(testing::clip::PlainView(), {});
  std::vector<Vec4> points;
  for (int k = 0; k <= 3; ++k)
    for (int l = 0; l <= 3; ++l)
      points.push_back({30.0 * k - 45, 30.0 * l - 45 + 2 * (k % 2), Draw(engine, 0, 5), 1});
  scene.AddPatch(3, 3, points);
  const auto solver = Prepared("coherent-newton", scene);
  const auto state = solver->MakeState();
  const auto rows = SolveRow(*solver, RowThrough(scene, 0.5, 0.5, 20), *state);
  const auto& coherent = static_cast<const CoherentNewtonState&>(*state);
  for (const auto& roots : rows) EXPECT_EQ(roots.size(), 1u);
  EXPECT_EQ(coherent.first, 1u);
  EXPECT_EQ(coherent.by_newton, 19u);
  // A ray beside the patch needs neither.
  state->BeginRay();
  solver->Solve(RayThrough(scene, 100, 0), StartOf(solver->pieces()[0]), *state);
  EXPECT_EQ(coherent.missed, 1u);
  EXPECT_TRUE(state->roots.empty());
  // A new row begins with clipping.
  SolveRow(*solver, RowThrough(scene, 0.5, 0.7, 20), *state);
  EXPECT_EQ(coherent.first, 2u);
  EXPECT_EQ(coherent.by_newton, 38u);
  EXPECT_EQ(state->counters.stops[static_cast<std::size_t>(SolverStop::kRoot)], 40u);
}

RC_GTEST_PROP(ClippingSolvers, RaysBesideThePatchHaveNoRoot, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const Case drawn = DrawCase(engine, Draw(engine, 0, 0.4), Draw(engine, 1, 300), DrawInside);
  const SolverPatch& patch = drawn.scene.patches()[0];
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (int k = 0; k < patch.points(); ++k) {
    const ViewProjection::Point& p = drawn.scene.screen(patch)[k];
    RC_PRE(p.w > 0);
    low = {std::min(low.x, p.x / p.w), std::min(low.y, p.y / p.w)};
    high = {std::max(high.x, p.x / p.w), std::max(high.y, p.y / p.w)};
  }
  const double beside = std::pow(10, Draw(engine, -9, 2));
  const SolverRay rays[] = {RayThrough(drawn.scene, low.x - beside, Draw(engine, low.y, high.y)),
                            RayThrough(drawn.scene, high.x + beside, Draw(engine, low.y, high.y)),
                            RayThrough(drawn.scene, Draw(engine, low.x, high.x), low.y - beside),
                            RayThrough(drawn.scene, Draw(engine, low.x, high.x), high.y + beside)};
  for (const SolverRay& ray : rays) {
    const Answer answer = Ask(*Prepared("robust-clipping", drawn.scene), ray);
    RC_ASSERT(answer.roots.empty());
    RC_ASSERT(Stops(answer, SolverStop::kNoRoot) == 1u);
  }
}

// A net of a kind that breaks arithmetic.
std::vector<Vec4> DrawHostile(int m, int n, std::mt19937_64& engine) {
  std::vector<Vec4> points = DrawNet(m, n, 0.4, 4, engine);
  const std::size_t width = static_cast<std::size_t>(n) + 1;
  switch (engine() % 7) {
    case 0:  // all points are equal
      std::fill(points.begin(), points.end(), points[0]);
      break;
    case 1:  // huge and tiny weights
      for (Vec4& p : points) p = std::pow(10, std::round(Draw(engine, -150, 150))) * p;
      break;
    case 2:  // collapsed edges
      std::fill_n(points.begin(), width, points[0]);
      std::fill_n(points.end() - static_cast<std::ptrdiff_t>(width), width, points.back());
      break;
    case 3:  // behind the eye, and far away
      for (Vec4& p : points) p = {1e3 * p.x, 1e3 * p.y, 1e3 * p.z, p.w};
      break;
    case 4:  // a line, which is seen edge-on from everywhere
      for (std::size_t k = 0; k < points.size(); ++k)
        points[k] = {double(k / width), double(k % width), 0, 1};
      for (Vec4& p : points) p.y = 2 * p.x;
      break;
    case 5:  // the same row again and again
      for (std::size_t k = width; k < points.size(); ++k) points[k] = points[k - width];
      break;
    default:  // to and fro
      for (std::size_t k = 0; k < points.size(); ++k) points[k] = points[k % 2 == 0 ? 0 : points.size() - 1];
  }
  return points;
}

RC_GTEST_PROP(ClippingSolvers, HostileNetsEndWithinTheWorkLimit, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const int m = DrawDegree(engine), n = DrawDegree(engine);
  SolverScene scene(DrawView(engine), {});
  scene.AddPatch(m, n, DrawHostile(m, n, engine));
  // Through a point of the patch, or anywhere.
  SolverRay ray = RayTo(scene, 0, Draw(engine, 0, 1), Draw(engine, 0, 1));
  if (engine() % 2 == 0 || !std::isfinite(ray.x) || !std::isfinite(ray.y))
    ray = RayThrough(scene, Draw(engine, -100, 100), Draw(engine, -100, 100));
  for (const char* name : kNames) {
    const auto solver = Prepared(name, scene);
    const auto state = solver->MakeState();
    solver->BeginRow(0, *state);
    state->BeginRay();
    // Less than rays have, so that the test is fast.
    constexpr std::int64_t kWork = 1000;
    state->work_left = kWork;
    solver->Solve(ray, StartOf(solver->pieces()[0]), *state);
    CheckLaws({state->roots, state->counters, 0});
    const bool out = state->counters.stops[static_cast<std::size_t>(SolverStop::kWork)] == 1;
    RC_ASSERT(out == (state->work_left < 0));
    RC_ASSERT(state->counters.iterations <= static_cast<std::uint64_t>(kWork));
  }
}

RC_GTEST_PROP(ClippingSolvers, TheSameQuestionHasTheSameAnswer, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const Case drawn = DrawCase(engine, Draw(engine, 0, 0.1), Draw(engine, 1, 4), DrawInside);
  const std::vector<SolverRay> row = RowThrough(drawn.scene, drawn.u, drawn.v, 5);
  const std::vector<SolverRay> other = RowThrough(drawn.scene, 1 - drawn.u, 1 - drawn.v, 5);
  for (const char* name : kNames) {
    const auto solver = Prepared(name, drawn.scene);
    const auto fresh = solver->MakeState(), used = solver->MakeState();
    SolveRow(*solver, other, *used);
    RC_ASSERT(SameRoots(SolveRow(*solver, row, *fresh), SolveRow(*solver, row, *used)));
  }
}

TEST(ClippingSolvers, PiecesAreWholePatchesThatHoldTheSurface) {
  std::mt19937_64 engine(3);
  SolverScene scene(testing::clip::PlainView(), {7, 8, 9});
  scene.AddPatch(2, 3, DrawNet(2, 3, 0.2, 10, engine));
  scene.AddPatch(25, 1, DrawNet(25, 1, 0.2, 10, engine));
  for (const char* name : kNames) {
    const auto solver = Prepared(name, scene);
    ASSERT_EQ(solver->pieces().size(), 2u);
    EXPECT_GE(solver->bytes(), 2 * sizeof(SolverPiece));
    for (std::uint32_t i = 0; i < 2; ++i) {
      const SolverPiece& piece = solver->pieces()[i];
      EXPECT_EQ(piece.surface, i);
      EXPECT_EQ(piece.u_low, 0);
      EXPECT_EQ(piece.v_high, 1);
      const Vec4* points = scene.space(scene.patches()[i]);
      for (int k = 0; k < scene.patches()[i].points(); ++k) {
        EXPECT_GE(points[k].x / points[k].w, piece.box.low.x);
        EXPECT_LE(points[k].z / points[k].w, piece.box.high.z);
      }
    }
    EXPECT_EQ(FindSolver(name)->make(scene, sizeof(SolverPiece), {}).error().code, ErrorCode::kLimitExceeded);
    const std::atomic<bool> cancel = true;
    EXPECT_EQ(FindSolver(name)->make(scene, 0, {1, &cancel}).error().code, ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace facetless
