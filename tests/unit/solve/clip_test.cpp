// The parts that the variants of Bézier clipping share.
#include "render/solve/clip.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/solve/coherent_newton.h"
#include "render/solve/patch_cells.h"
#include "render/solve/patch_jet.h"
#include "tests/unit/solve/clip_cases.h"

namespace facetless {
namespace {

using testing::clip::Draw;
using testing::clip::DrawDegree;
using testing::clip::DrawNet;
using testing::clip::DrawView;
using testing::clip::RayThrough;

// The crossings of all segments between two points of the band with the axis: the hull's border consists of such segments.
ClipInterval ByAllSegments(const DistanceBand& band, double slack) {
  ClipInterval roots;
  const auto add = [&](double t) {
    roots =
        roots.empty() ? ClipInterval{t, t} : ClipInterval{std::min(roots.low, t), std::max(roots.high, t)};
  };
  std::vector<Vec2> points;
  for (int i = 0; i <= band.degree; ++i) {
    points.push_back({double(i) / band.degree, band.low[i] - slack});
    points.push_back({double(i) / band.degree, band.high[i] + slack});
  }
  for (const Vec2& a : points) {
    if (a.y == 0) add(a.x);
    for (const Vec2& b : points)
      if (a.y < 0 && b.y > 0) add(a.x + (b.x - a.x) * (a.y / (a.y - b.y)));
  }
  return roots;
}

RC_GTEST_PROP(Clip, TheHullMeetsTheAxisWhereItsSegmentsDo, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  DistanceBand band;
  band.degree = DrawDegree(engine);
  const double shift = Draw(engine, -1.5, 1.5), slope = Draw(engine, -2, 2);
  for (int i = 0; i <= band.degree; ++i) {
    // Whole numbers make points that coincide with the axis.
    double a = 4 * (shift + slope * i / band.degree) + Draw(engine, -3, 3),
           b = a + Draw(engine, 0, 4) * double(engine() % 2);
    if (seed % 3 == 0) a = std::floor(a), b = std::floor(b);
    band.low[i] = a;
    band.high[i] = b;
  }
  const double slack = seed % 2 == 0 ? 0 : 0.125;
  const ClipInterval expected = ByAllSegments(band, slack), found = ZeroInterval(band, slack);
  RC_ASSERT(found.empty() == expected.empty());
  if (found.empty()) return;
  RC_ASSERT(std::fabs(found.low - expected.low) < 1e-14);
  RC_ASSERT(std::fabs(found.high - expected.high) < 1e-14);
}

TEST(Clip, NumbersThatCannotBeComparedHoldNoRoot) {
  DistanceBand band;
  band.degree = 3;
  band.low.fill(NAN);
  band.high.fill(NAN);
  EXPECT_TRUE(ZeroInterval(band, 0).empty());
}

// The value of a net at parameters of the patch.
Vec2 ValueAt(const RayNet& net, double u, double v) {
  const BernsteinBasis in_u(net.degree_u, (u - net.u_low) / (net.u_high - net.u_low));
  const BernsteinBasis in_v(net.degree_v, (v - net.v_low) / (net.v_high - net.v_low));
  Vec2 value;
  for (int i = 0, k = 0; i <= net.degree_u; ++i)
    for (int j = 0; j <= net.degree_v; ++j, ++k)
      value = value + in_u.value[i] * in_v.value[j] * Vec2{net.f[k], net.g[k]};
  return value;
}

RC_GTEST_PROP(Clip, PartsHaveTheValuesOfThePatch, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const int m = DrawDegree(engine), n = DrawDegree(engine);
  SolverScene scene(DrawView(engine), {});
  scene.AddPatch(m, n, DrawNet(m, n, 0.3, 10, engine));
  const SolverRay ray = RayThrough(scene, Draw(engine, -100, 100), Draw(engine, -100, 100));
  NetStack nets(MostPoints(scene), true);
  RC_ASSERT(nets.Load(scene, scene.patches()[0], ray));
  const double first_error = RoundingError(nets.top());
  for (int cut = 0; cut < 6; ++cut) {
    const ClipAxis axis = engine() % 2 == 0 ? ClipAxis::kU : ClipAxis::kV;
    if (engine() % 3 == 0) {
      nets.Halve(axis);
      if (engine() % 2 == 0) nets.Pop();
    } else {
      const double low = Draw(engine, 0, 0.6) * double(engine() % 2);
      Restrict(nets.top(), axis, low, engine() % 2 == 0 ? 1 : low + Draw(engine, 0.1, 0.4));
    }
  }
  while (!nets.empty()) {
    const RayNet& net = nets.top();
    const double u = Draw(engine, net.u_low, net.u_high), v = Draw(engine, net.v_low, net.v_high);
    const PatchJet<3> jet = EvaluatePatch<3>(&scene.screen(scene.patches()[0])->x, m, n, u, v);
    const Vec2 value = (1 / nets.scale()) * ValueAt(net, u, v);
    // The parameter is rounded as well as the numbers: it moves the surface by the roundings of the terms times the degree.
    const double error = (m + n) * std::max(first_error, RoundingError(net)) / nets.scale();
    RC_ASSERT(std::fabs(value.x - (jet.value[0] - ray.x * jet.value[2])) <= error);
    RC_ASSERT(std::fabs(value.y - (jet.value[1] - ray.y * jet.value[2])) <= error);
    nets.Pop();
  }
}

TEST(Clip, HugeAndTinyWeightsAreScaledExactly) {
  std::mt19937_64 engine(5);
  for (const double factor : {0x1p500, 0x1p-500}) {
    SolverScene plain(testing::clip::PlainView(), {}), scaled(testing::clip::PlainView(), {});
    std::vector<Vec4> points = DrawNet(3, 4, 0.3, 10, engine);
    plain.AddPatch(3, 4, points);
    for (Vec4& p : points) p = factor * p;
    scaled.AddPatch(3, 4, points);
    NetStack a(20), b(20);
    ASSERT_TRUE(a.Load(plain, plain.patches()[0], RayThrough(plain, 3, 4)));
    ASSERT_TRUE(b.Load(scaled, scaled.patches()[0], RayThrough(scaled, 3, 4)));
    for (int k = 0; k < 20; ++k) {
      EXPECT_EQ(a.top().f[k], b.top().f[k]);
      EXPECT_EQ(a.top().g[k], b.top().g[k]);
    }
    EXPECT_LT(Largest(b.top()), 2);
    EXPECT_GE(Largest(b.top()), 1);
  }
}

TEST(Clip, TheTestForASecondRootKnowsFlatAndFoldedNets) {
  const auto passes = [](const std::vector<Vec4>& points, int m, int n) {
    SolverScene scene(testing::clip::PlainView(), {});
    scene.AddPatch(m, n, points);
    NetStack nets(MostPoints(scene));
    return nets.Load(scene, scene.patches()[0], RayThrough(scene, 0, 0)) && HasAtMostOneRoot(nets.top());
  };
  EXPECT_TRUE(passes({{0, 0, 0, 1}, {0, 9, 0, 1}, {9, 0, 0, 1}, {9, 9, 0, 1}}, 1, 1));
  // One side is collapsed.
  EXPECT_TRUE(passes({{0, 0, 0, 1}, {0, 0, 0, 1}, {9, 0, 0, 1}, {9, 9, 0, 1}}, 1, 1));
  // A bow tie, a patch that runs back along u, a point.
  EXPECT_FALSE(passes({{0, 0, 0, 1}, {0, 9, 0, 1}, {9, 9, 0, 1}, {9, 0, 0, 1}}, 1, 1));
  EXPECT_FALSE(
      passes({{0, 0, 0, 1}, {0, 9, 0, 1}, {9, 0, 0, 1}, {9, 9, 0, 1}, {0, 0, 5, 1}, {0, 9, 5, 1}}, 2, 1));
  EXPECT_FALSE(passes({{1, 1, 0, 1}, {1, 1, 0, 1}, {1, 1, 0, 1}, {1, 1, 0, 1}}, 1, 1));
}

// Wherever the test passes, no two points of the patch lie on one ray.
TEST(Clip, PatchesThatPassTheTestHaveOneRoot) {
  std::mt19937_64 engine(7);
  int passed = 0;
  for (int k = 0; k < 400; ++k) {
    const int m = DrawDegree(engine), n = DrawDegree(engine);
    SolverScene scene(DrawView(engine), {});
    const double bump = Draw(engine, 0, 0.5) / std::max(m, n), spread = 1 + (k % 2) * Draw(engine, 0, 0.02);
    scene.AddPatch(m, n, DrawNet(m, n, bump, spread, engine));
    const SolverRay ray = testing::clip::RayTo(scene, 0, Draw(engine, 0, 1), Draw(engine, 0, 1));
    NetStack nets(MostPoints(scene));
    ASSERT_TRUE(nets.Load(scene, scene.patches()[0], ray));
    if (!HasAtMostOneRoot(nets.top())) continue;
    ++passed;
    EXPECT_EQ(testing::clip::Ask(*testing::clip::Prepared("robust-clipping", scene), ray).roots.size(), 1u);
  }
  EXPECT_GT(passed, 50);
}

RC_GTEST_PROP(PatchCells, TheBlockHoldsThePointOfTheRay, (std::uint64_t seed)) {
  std::mt19937_64 engine(seed);
  const int m = DrawDegree(engine), n = DrawDegree(engine);
  SolverScene scene(DrawView(engine), {});
  // Two patches, so that the second one's boxes are not those of the first.
  for (int patch = 0; patch < 2; ++patch)
    scene.AddPatch(m, n, DrawNet(m, n, Draw(engine, 0, 0.4), Draw(engine, 1, 300), engine));
  const Result<PatchCells> cells = PatchCells::Make(scene, 0, {});
  RC_ASSERT(cells.ok());
  for (std::uint32_t patch = 0; patch < 2; ++patch) {
    const double u = Draw(engine, 0, 1), v = Draw(engine, 0, 1);
    const SolverRay ray = testing::clip::RayTo(scene, patch, u, v);
    const CellBlock block = cells.value().Around(patch, ray.x, ray.y);
    RC_ASSERT(!block.empty());
    RC_ASSERT(block.u_low() <= u && u <= block.u_high() && block.v_low() <= v && v <= block.v_high());
    RC_ASSERT(cells.value().Around(patch, 1e6, 0).empty() || block.u_high() - block.u_low() == 1);
  }
}

TEST(PatchCells, BlocksOfAFlatPatchAreSmallAndThoseOfAFoldedOneHoldBothRoots) {
  SolverScene scene(testing::clip::PlainView(), {});
  scene.AddPatch(1, 1, std::vector<Vec4>{{0, 0, 0, 1}, {0, 80, 0, 1}, {80, 0, 0, 1}, {80, 80, 0, 1}});
  scene.AddPatch(2, 2,
                 testing::clip::Biquadratic([](double, double v) { return 80 * v; },
                                            [](double u, double) { return 80 * (u - 0.5) * (u - 0.5); }));
  const PatchCells cells = std::move(PatchCells::Make(scene, 0, {})).value();
  const SolverRay flat = testing::clip::RayTo(scene, 0, 0.3, 0.7),
                  folded = testing::clip::RayTo(scene, 1, 0.1, 0.7);
  const CellBlock one = cells.Around(0, flat.x, flat.y), two = cells.Around(1, folded.x, folded.y);
  EXPECT_EQ(one.u_first, 2);
  EXPECT_EQ(one.u_last, 2);
  EXPECT_EQ(one.v_first, 5);
  EXPECT_EQ(one.v_last, 5);
  EXPECT_EQ(two.u_low(), 0);
  EXPECT_EQ(two.u_high(), 1);
  EXPECT_EQ(PatchCells::Make(scene, 100, {}).error().code, ErrorCode::kLimitExceeded);
}

}  // namespace
}  // namespace facetless
