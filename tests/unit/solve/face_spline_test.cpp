// The basis functions over the knots of a face give the points and the derivatives of its patches.
#include "render/solve/face_spline.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

#include "render/model/builder.h"
#include "tests/unit/solve/sheets.h"

namespace facetless {
namespace {

// A face of 3 × 2 patches whose native spans differ in length, over the control points of one even sheet.
Model Patchwork(int degree_u, int degree_v, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  SurfaceGrid grid;
  grid.degree_u = degree_u;
  grid.degree_v = degree_v;
  grid.u_spans = {{-1, 0.5}, {0.5, 4}, {4, 4.25}};
  grid.v_spans = {{10, 30}, {30, 35}};
  std::vector<std::vector<Vec4>> net(static_cast<std::size_t>(3 * degree_u + 1));
  for (std::size_t k = 0; k < net.size(); ++k)
    for (int l = 0; l <= 2 * degree_v; ++l) {
      const double w = 0.5 + number();
      net[k].push_back({w * (30.0 * double(k) / degree_u - 45 + number()), w * number(),
                        w * (40.0 * l / degree_v - 40 + number()), w});
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k <= degree_u; ++k)
        for (int l = 0; l <= degree_v; ++l)
          grid.points.push_back(
              net[static_cast<std::size_t>(i * degree_u + k)][static_cast<std::size_t>(j * degree_v + l)]);
  ModelBuilder builder;
  builder.AddPart("patchwork");
  builder.AddFace(grid);
  builder.AddInstance({});
  return std::move(builder).Finish().value();
}

RC_GTEST_PROP(FaceSpline, HasThePointsAndDerivativesOfItsPatches, ()) {
  const int degree_u = *rc::gen::inRange(1, kMaxDegree + 1), degree_v = *rc::gen::inRange(1, kMaxDegree + 1);
  const Model model = Patchwork(degree_u, degree_v, *rc::gen::arbitrary<std::uint32_t>());
  SolverScene scene(testing::SheetFrame(*rc::gen::arbitrary<bool>()), {0, 0, 0});
  scene.AddFace(model, 0, {}, 0, nullptr, {});
  const FaceSpline spline(scene, scene.faces()[0]);
  const double u_length[] = {1.5, 3.5, 0.25}, v_length[] = {20, 5};
  for (std::uint32_t i = 0; i < 3; ++i)
    for (std::uint32_t j = 0; j < 2; ++j) {
      const double u = *rc::gen::inRange(1, 100) / 100.0, v = *rc::gen::inRange(1, 100) / 100.0;
      FaceSpline::Place at;
      RC_ASSERT(spline.Locate(spline.S(i + u), spline.T(j + v), &at));
      RC_ASSERT(at.i == i);
      RC_ASSERT(at.j == j);
      const SolverPatch& patch = scene.patches()[at.patch];
      const auto exact = EvaluatePatch<3>(&scene.screen(patch)->x, degree_u, degree_v, u, v);
      const auto jet = spline.Jet(at), value = spline.Value(at);
      // The range of 0 … 3 stands for the native range of −1 … 4.25, and 0 … 2 for 10 … 35.
      const double scale_u = 3 / 5.25 * u_length[i], scale_v = 2 / 25.0 * v_length[j];
      for (std::size_t c = 0; c < 3; ++c) {
        const double size = 1e-11 * (300 + std::fabs(exact.value[c]));
        RC_ASSERT(std::fabs(jet.value[c] - exact.value[c]) < size);
        RC_ASSERT(value.value[c] == jet.value[c]);
        RC_ASSERT(std::fabs(jet.du[c] * scale_u - exact.du[c]) < 10 * degree_u * size);
        RC_ASSERT(std::fabs(jet.dv[c] * scale_v - exact.dv[c]) < 10 * degree_v * size);
      }
      const SolverRoot root = spline.Root(at);
      RC_ASSERT(std::fabs(root.u - u) < 1e-12);
      RC_ASSERT(std::fabs(root.v - v) < 1e-12);
    }
}

TEST(FaceSpline, HasNoSurfaceOutsideItsRangeOrWhereItIsTrimmedAway) {
  const Model model = Patchwork(2, 3, 1);
  SolverScene scene(testing::SheetFrame(false), {0, 0, 0});
  std::vector<RectClass> classes(6, RectClass::kMixed);
  classes[3] = RectClass::kOutside;  // patch (1, 1)
  scene.AddFace(model, 0, {}, 0, nullptr, classes);
  const FaceSpline spline(scene, scene.faces()[0]);
  FaceSpline::Place at;
  bool inside = false;
  EXPECT_TRUE(spline.Locate(0, 0, &at, &inside));
  EXPECT_TRUE(spline.Locate(3, 2, &at, &inside));
  EXPECT_EQ(at.i, 2u);
  EXPECT_EQ(at.j, 1u);
  EXPECT_FALSE(spline.Locate(spline.S(1.5), spline.T(1.5), &at, &inside));
  EXPECT_TRUE(inside);
  EXPECT_FALSE(spline.Locate(3.001, 1, &at, &inside));
  EXPECT_FALSE(inside);
  EXPECT_FALSE(spline.Locate(NAN, 1, &at, &inside));
  EXPECT_FALSE(inside);
}

}  // namespace
}  // namespace facetless
