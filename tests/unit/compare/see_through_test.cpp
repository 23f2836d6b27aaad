// Transparent faces: the exact picture and the mesh's picture show what lies behind them.
#include "render/compare/see_through.h"

#include <gtest/gtest.h>

#include "render/compare/compare_view.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

constexpr int kSize = 40;

// A red plane in front of a blue one, seen from above.
Model TwoPlanes(float opacity) {
  Model model = testing::ModelOf({testing::Rectangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0}),
                                  testing::Rectangle({0, 0, 2}, {4, 0, 0}, {0, 4, 0})});
  model.faces[0].has_color = model.faces[1].has_color = true;
  model.faces[0].color = {0, 0, 1, 1};
  model.faces[1].color = {1, 0, 0, opacity};
  return model;
}

std::array<int, 3> MiddleOf(const Model& model, int samples) {
  const Scene scene(model);
  ViewOptions options;
  options.samples = samples;
  const Camera camera = NamedView("top", model.bounds, Projection::kOrthographic, kSize, kSize).value();
  const Image8 image = RenderView(ExactSurfaces(scene, {}), model, camera, options).value().image;
  const std::uint8_t* pixel = image.at(kSize / 2, kSize / 2);
  return {pixel[0], pixel[1], pixel[2]};
}

TEST(SeeThrough, ShowsWhatLiesBehind) {
  for (const int samples : {1, 4}) {
    const auto opaque = MiddleOf(TwoPlanes(1), samples), clear = MiddleOf(TwoPlanes(0), samples),
               half = MiddleOf(TwoPlanes(0.5f), samples);
    EXPECT_GT(opaque[0], 100);
    EXPECT_LT(opaque[2], 60);
    EXPECT_LT(clear[0], 60);
    EXPECT_GT(clear[2], 100);
    EXPECT_GT(half[0], clear[0]);
    EXPECT_LT(half[0], opaque[0]);
    EXPECT_GT(half[2], opaque[2]);
    EXPECT_LT(half[2], clear[2]);
  }
}

TEST(SeeThrough, LeavesOutTheFacesOfEachPlacement) {
  Mesh mesh;
  mesh.from_model = true;
  mesh.parts.resize(1);
  mesh.parts[0].triangles = {{0, 1, 2}, {2, 1, 3}, {0, 2, 3}};
  mesh.parts[0].face_of_triangle = {0, 1, 1};
  mesh.nodes.resize(2);
  mesh.nodes[1].first_placed_face = 2;
  const Mesh opaque = OpaqueMesh(mesh, {true, false, false, true});
  ASSERT_EQ(opaque.nodes.size(), 2u);
  EXPECT_EQ(opaque.parts[opaque.nodes[0].part].triangles.size(), 2u);
  EXPECT_EQ(opaque.parts[opaque.nodes[1].part].triangles.size(), 1u);
}

TEST(SeeThrough, CostsNothingWhereNothingIsTransparent) {
  const std::vector<Color> colors(3);
  EXPECT_TRUE(TransparentFaces(colors).empty());
}

}  // namespace
}  // namespace facetless
