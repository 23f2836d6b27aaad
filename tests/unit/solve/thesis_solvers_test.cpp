// What the iterations of the thesis, and Martin's, promise: roots within the stated tolerance, bounded work, and the same
// answer to the same question. What they do not promise is in weaknesses_test.cpp.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "render/solve/flattening.h"
#include "tests/unit/solve/sheets.h"

namespace facetless {
namespace {

using testing::Ends;
using testing::MakeSheet;
using testing::MakeSolver;
using testing::PixelsOff;
using testing::PointOn;
using testing::RayThrough;
using testing::RayTo;
using testing::SceneOf;
using testing::Sheet;
using testing::SheetFrame;
using testing::StartAt;
using testing::WildSheet;

const std::vector<std::string> kNames{"newton-cramer", "gradient", "steepest-descent", "martin"};

// What tests draw: degrees from 1 to 25, each on its own, the projection and whether weights differ.
struct Drawn {
  int degree_u = *rc::gen::inRange(1, kMaxDegree + 1).as("degree u"),
      degree_v = *rc::gen::inRange(1, kMaxDegree + 1).as("degree v");
  bool perspective = *rc::gen::arbitrary<bool>().as("perspective"),
       rational = *rc::gen::arbitrary<bool>().as("rational");
  std::uint64_t seed = *rc::gen::arbitrary<std::uint32_t>().as("seed");
  double u = *rc::gen::inRange(5, 96).as("u") / 100.0, v = *rc::gen::inRange(5, 96).as("v") / 100.0;
  std::string name = *rc::gen::elementOf(kNames).as("solver");

  SolverScene Smooth() const {
    return SceneOf(SheetFrame(perspective),
                   MakeSheet(degree_u, degree_v, {0.2, 1, rational ? 2.0 : 1.0}, seed));
  }
  SolverScene Wild() const { return SceneOf(SheetFrame(perspective), WildSheet(degree_u, degree_v, seed)); }
};

std::uint64_t Stops(const SolverState& state, SolverStop stop) {
  return state.counters.stops[static_cast<std::size_t>(stop)];
}

bool Finds(const SolverState& state, double u, double v, double within) {
  return std::any_of(state.roots.begin(), state.roots.end(), [&](const SolverRoot& root) {
    return std::fabs(root.u - u) < within && std::fabs(root.v - v) < within;
  });
}

// A tolerance in pixels, as a tolerance of parameters of a sheet that covers more than a hundred pixels, with a reserve for
// places where it is denser.
double ParameterTolerance(const std::string& name) {
  return FindSolver(name)->tolerance_px;
}

// Computing with rounding takes a little away from the tolerance.
constexpr double kRounding = 1e-10;

RC_GTEST_PROP(ThesisSolvers, FindTheRootFromANearStart, ()) {
  const Drawn drawn;
  const SolverScene scene = drawn.Smooth();
  const auto solver = MakeSolver(drawn.name, scene);
  const auto state = solver->MakeState();
  state->BeginRay();
  const SolverRay ray = RayTo(scene, 0, drawn.u, drawn.v);
  solver->Solve(ray, StartAt(0, drawn.u + 0.01, drawn.v - 0.01, FindSolver(drawn.name)->takes_map), *state);
  RC_ASSERT(Stops(*state, SolverStop::kRoot) == 1u);
  RC_ASSERT(Finds(*state, drawn.u, drawn.v, ParameterTolerance(drawn.name)));
}

// From the middle of a piece, no method promises the root: where weights differ much, a step can be too long.
TEST(ThesisSolvers, FindNearlyAllRootsFromThePieces) {
  for (const std::string& name : kNames) {
    std::mt19937_64 engine(1);
    const auto number = [&](int low, int high) {
      return low + static_cast<int>(engine() % static_cast<std::uint64_t>(high - low + 1));
    };
    constexpr int kCases = 30;
    int found = 0;
    for (int k = 0; k < kCases; ++k) {
      const int degree_u = number(1, kMaxDegree), degree_v = number(1, kMaxDegree);
      const double u = number(5, 95) / 100.0, v = number(5, 95) / 100.0;
      const SolverScene scene = SceneOf(
          SheetFrame(k % 2 == 0), MakeSheet(degree_u, degree_v, {0.2, 1, k % 4 < 2 ? 2.0 : 1.0}, engine()));
      const auto solver = MakeSolver(name, scene);
      const auto state = solver->MakeState();
      state->BeginRay();
      const SolverRay ray = RayTo(scene, 0, u, v);
      for (const SolverPiece& piece : solver->pieces()) solver->Solve(ray, StartOf(piece), *state);
      found += Finds(*state, u, v, ParameterTolerance(name));
    }
    EXPECT_GE(found, kCases - 2) << name;
  }
}

RC_GTEST_PROP(ThesisSolvers, KeepTheToleranceOnAnySurface, ()) {
  const Drawn drawn;
  const SolverScene scene = drawn.Wild();
  const auto solver = MakeSolver(drawn.name, scene);
  const auto state = solver->MakeState();
  const double tolerance = FindSolver(drawn.name)->tolerance_px + kRounding;
  for (int k = 0; k < 20; ++k) {
    const SolverRay ray =
        k < 10 ? RayTo(scene, 0, drawn.u + k * 1e-3, drawn.v) : RayThrough(scene, 7 * k - 100, 100 - 9 * k);
    if (!(std::fabs(ray.x) < 1e4 && std::fabs(ray.y) < 1e4)) continue;  // in the eye plane
    state->BeginRay();
    solver->Solve(ray, StartAt(0, drawn.u, drawn.v, k % 2 == 0), *state);
    for (const SolverRoot& root : state->roots) {
      RC_ASSERT(root.u >= -kRootBorder && root.u <= 1 + kRootBorder);
      RC_ASSERT(root.v >= -kRootBorder && root.v <= 1 + kRootBorder);
      RC_ASSERT(PixelsOff(scene, ray, root) <= tolerance);
      RC_ASSERT(OnScreen(scene, PointOn(scene, root.patch, root.u, root.v)).z > 0 || !drawn.perspective);
    }
    RC_ASSERT(Ends(state->counters) == state->counters.solves);
  }
}

RC_GTEST_PROP(ThesisSolvers, FindNothingBesideTheSurface, ()) {
  const Drawn drawn;
  const SolverScene scene = drawn.Smooth();
  const auto solver = MakeSolver(drawn.name, scene);
  const auto state = solver->MakeState();
  // The sheet ends within 90 % of the half width, noise and perspective included.
  const double side = 0.5 * testing::kSheetPixels;
  for (const SolverRay& ray : {RayThrough(scene, 1.2 * side, 0), RayThrough(scene, 10, -1.3 * side),
                               RayThrough(scene, 5 * side, 4 * side)}) {
    state->BeginRay();
    solver->Solve(ray, StartAt(0, drawn.u, drawn.v, FindSolver(drawn.name)->takes_map), *state);
    RC_ASSERT(state->roots.empty());
  }
  RC_ASSERT(Stops(*state, SolverStop::kRoot) == 0u);
  RC_ASSERT(Ends(state->counters) == 3u);
}

RC_GTEST_PROP(ThesisSolvers, AnswerTheSameInAnyOrder, ()) {
  const Drawn drawn;
  const SolverScene scene = *rc::gen::arbitrary<bool>() ? drawn.Wild() : drawn.Smooth();
  const auto solver = MakeSolver(drawn.name, scene);
  std::vector<SolverRay> rays;
  for (int k = 0; k < 8; ++k) rays.push_back(RayThrough(scene, 20 * k - 70 + 0.5, 15 * k - 60 + 0.5));
  const auto trace = [&](int k, SolverState& state) {
    state.BeginRay();
    for (const SolverPiece& piece : solver->pieces().first(std::min<std::size_t>(4, solver->pieces().size())))
      solver->Solve(rays[static_cast<std::size_t>(k)], StartOf(piece), state);
    return state.roots;
  };
  const auto first = solver->MakeState(), second = solver->MakeState();
  std::vector<std::vector<SolverRoot>> forwards(rays.size());
  for (int k = 0; k < 8; ++k) forwards[static_cast<std::size_t>(k)] = trace(k, *first);
  for (int k = 7; k >= 0; --k) {
    const auto again = trace(k, *second);
    const auto& before = forwards[static_cast<std::size_t>(k)];
    RC_ASSERT(again.size() == before.size());
    for (std::size_t i = 0; i < again.size(); ++i) {
      RC_ASSERT(again[i].u == before[i].u);
      RC_ASSERT(again[i].v == before[i].v);
    }
  }
  RC_ASSERT(first->counters.iterations == second->counters.iterations);
}

RC_GTEST_PROP(ThesisSolvers, StopWhenTheRayHasNoWorkLeft, ()) {
  const Drawn drawn;
  const SolverScene scene = *rc::gen::arbitrary<bool>() ? drawn.Wild() : drawn.Smooth();
  const auto solver = MakeSolver(drawn.name, scene);
  const auto state = solver->MakeState();
  state->BeginRay();
  const int work = *rc::gen::inRange(0, 3);
  state->work_left = work;
  const SolverRay ray = RayTo(scene, 0, drawn.u, drawn.v);
  if (!(std::fabs(ray.x) < 1e4 && std::fabs(ray.y) < 1e4)) return;
  int solves = 0;
  for (; state->work_left >= 0 && solves < 1000; ++solves)
    solver->Solve(ray, StartAt(0, 1 - drawn.u, drawn.v, false), *state);
  RC_ASSERT(Stops(*state, SolverStop::kWork) == 1u);
  RC_ASSERT(state->work_left == -1);
  RC_ASSERT(solves <= work + 1);
  RC_ASSERT(state->counters.iterations <= static_cast<std::uint64_t>(work));
}

RC_GTEST_PROP(Flattening, PiecesCoverTheSurfaceAndHoldIt, ()) {
  const Drawn drawn;
  const SolverScene scene = *rc::gen::arbitrary<bool>() ? drawn.Wild() : drawn.Smooth();
  const auto pieces = FlattenedPieces(scene, SolverUnit::kPatch, 0, {}).value();
  RC_ASSERT(pieces.size() >= 1u);
  RC_ASSERT(pieces.size() <= std::size_t{kMostPieces} * kMostPieces);
  double area = 0;
  const std::size_t some = std::max<std::size_t>(1, pieces.size() / 16);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const SolverPiece& piece = pieces[k];
    area += (piece.u_high - piece.u_low) * (piece.v_high - piece.v_low);
    if (k % some != 0) continue;
    for (const double s : {0.0, 0.4, 1.0})
      for (const double t : {0.0, 0.7, 1.0}) {
        const auto p = PointOn(scene, 0, piece.u_low + s * (piece.u_high - piece.u_low),
                               piece.v_low + t * (piece.v_high - piece.v_low));
        const Box3& box = piece.box;
        RC_ASSERT(box.low.x <= p.x && p.x <= box.high.x && box.low.y <= p.y && p.y <= box.high.y &&
                  box.low.z <= p.z && p.z <= box.high.z);
      }
  }
  RC_ASSERT(std::fabs(area - 1) < 1e-9);
}

TEST(Flattening, FollowsTheBend) {
  const auto count = [](double bend) {
    Sheet sheet{2, 1, {}};
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 2; ++l)
        sheet.points.push_back({20.0 * k - 20, k == 1 ? bend : 0, 20.0 * l - 10, 1});
    const SolverScene scene = SceneOf(SheetFrame(false), sheet);
    return FlattenedPieces(scene, SolverUnit::kPatch, 0, {}).value().size();
  };
  EXPECT_EQ(count(0), 1u) << "a plane is one piece";
  EXPECT_GT(count(20), count(5));
  EXPECT_GT(count(5), 1u);
}

TEST(Flattening, DoesNotDependOnTheUnit) {
  const auto count = [](double scale) {
    Sheet sheet = MakeSheet(5, 3, {0.3, 2, 1}, 7);
    for (Vec4& p : sheet.points) p = {scale * p.x, scale * p.y, scale * p.z, 1};
    return FlattenedPieces(SceneOf(SheetFrame(false), sheet), SolverUnit::kPatch, 0, {}).value().size();
  };
  EXPECT_EQ(count(1), count(0x1p-10));
  EXPECT_EQ(count(1), count(0x1p+10));
}

TEST(Flattening, SaysWhenThePiecesAreTooMany) {
  const SolverScene scene = SceneOf(SheetFrame(false), WildSheet(20, 20, 3));
  const auto pieces = FlattenedPieces(scene, SolverUnit::kPatch, 10 * sizeof(SolverPiece), {});
  ASSERT_FALSE(pieces.ok());
  EXPECT_EQ(pieces.error().code, ErrorCode::kLimitExceeded);
  const std::atomic<bool> stop = true;
  const auto cancelled = FlattenedPieces(scene, SolverUnit::kPatch, 0, {1, &stop});
  ASSERT_FALSE(cancelled.ok());
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
}

TEST(ThesisSolvers, AreRegistered) {
  for (const std::string& name : kNames) {
    const SolverInfo* info = FindSolver(name);
    ASSERT_NE(info, nullptr) << name;
    EXPECT_FALSE(info->source.empty());
    EXPECT_FALSE(info->does_not.empty());
    EXPECT_EQ(info->max_degree, kMaxDegree);
    EXPECT_TRUE(info->takes_map || info->starts == SolverStarts::kPieces);
  }
}

}  // namespace
}  // namespace facetless
