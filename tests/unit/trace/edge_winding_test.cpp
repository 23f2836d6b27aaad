// Tests whether a border winds around a pixel, by counting its edges' crossings of a half-line.
#include "render/trace/edge_winding.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/nurbs/trim_models.h"

namespace facetless {
namespace {

using namespace trim_models;

// Seen from +z, with y upwards on the screen and 64 pixels per unit: (0,0) is pixel (128, 128).
CameraFrame FromAbove() {
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.up = {0, 1, 0};
  camera.height = 4;
  camera.width_px = camera.height_px = 256;
  return MakeFrame(camera, 4).value();
}

bool Winds(const Model& model, const ProjectedEdges& edges, double x, double y) {
  bool odd = false;
  for (std::uint32_t e = 0; e < model.edges.size(); ++e) {
    const std::optional<bool> crosses = CrossesHalfLine(edges, e, x, y);
    EXPECT_TRUE(crosses.has_value());
    odd ^= crosses.value_or(false);
  }
  return odd;
}

TEST(EdgeWinding, ACircleWindsAroundItsInside) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Circle({0.1, -0.2}, 1));
  const ProjectedEdges edges(model, Placement(), FromAbove());
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.Uniform(0, 256), y = random.Uniform(0, 256);
    const double distance = std::hypot(x - 134.4, y - 140.8);
    if (std::fabs(distance - 64) < 1e-9) continue;
    ASSERT_EQ(Winds(model, edges, x, y), distance < 64) << x << " " << y;
  }
}

TEST(EdgeWinding, OfAPolygonAsBruteForceHasIt) {
  Random random(4);
  for (int turn = 0; turn < 50; ++turn) {
    std::vector<Vec2> corners;
    for (int i = random.Integer(3, 9); i > 0; --i)
      corners.push_back({random.Uniform(-1.9, 1.9), random.Uniform(-1.9, 1.9)});
    Model model = PlaneModel(-2, 2, -2, 2);
    AddLoop(model, Polygon(corners));
    const ProjectedEdges edges(model, Placement(), FromAbove());
    const Sampled sampled({Polygon(corners)}, 1);
    for (int i = 0; i < 500; ++i) {
      const Vec2 q{random.Uniform(-2, 2), random.Uniform(-2, 2)};
      if (sampled.Distance(q) < 1e-9) continue;
      ASSERT_EQ(Winds(model, edges, 128 + 64 * q.x, 128 - 64 * q.y), sampled.Inside(q)) << turn << " " << i;
    }
  }
}

TEST(EdgeWinding, EdgesThatMissTheirVertexMeetInIt) {
  // The ends of the triangle's edges do not meet. Every pixel around a corner must see one closed border.
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon({{-1, -1}, {1, -1}, {0, 1}}));
  Random random(5);
  for (std::uint32_t i = 0; i < 3; ++i) {
    model.edges[i].vertices[0] = i;
    model.edges[i].vertices[1] = (i + 1) % 3;
    const Vec2 corner[3] = {{-1, -1}, {1, -1}, {0, 1}};
    model.vertices.push_back({{corner[i].x, corner[i].y, 0}, 0.2});
  }
  for (Vec4& p : model.edge_points) p.x += random.Uniform(-0.2, 0.2), p.y += random.Uniform(-0.2, 0.2);
  const ProjectedEdges edges(model, Placement(), FromAbove());
  // A closed border has the same number of crossings to the left and to the right, modulo 2. Turn the picture
  // to test this.
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.up = {0, -1, 0};
  camera.height = 4;
  camera.width_px = camera.height_px = 256;
  const ProjectedEdges turned(model, Placement(), MakeFrame(camera, 4).value());
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = random.Uniform(0, 256), y = random.Uniform(0, 256);
    const bool winds = Winds(model, edges, x, y);
    inside += winds;
    ASSERT_EQ(winds, Winds(model, turned, 256 - x, 256 - y)) << x << " " << y;
  }
  EXPECT_GT(inside, 1000);
}

TEST(EdgeWinding, NothingIsSaidOfWhatLiesBehindTheEye) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon({{-1, -1}, {1, -1}, {0, 1}}));
  Camera camera;
  camera.eye = {0, 0, 0.5};
  camera.target = {0, 1, 0.5};
  camera.up = {0, 0, 1};
  camera.projection = Projection::kPerspective;
  const ProjectedEdges edges(model, Placement(), MakeFrame(camera, 4).value());
  EXPECT_FALSE(CrossesHalfLine(edges, 0, 10, 10).has_value());
}

}  // namespace
}  // namespace facetless
