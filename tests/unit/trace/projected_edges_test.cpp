// The rule at shared edges: sides of projected curves, and faces that tile the image without overlap and
// without a gap.
#include "render/trace/projected_edges.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>

#include "render/nurbs/surface_eval.h"
#include "tests/support/shapes.h"
#include "tests/unit/nurbs/trim_models.h"

namespace facetless {
namespace {

using namespace trim_models;

constexpr double kPi = 3.14159265358979323846;

CameraFrame FrameOf(Vec3 eye, Projection projection = Projection::kOrthographic) {
  Camera camera;
  camera.eye = eye;
  camera.up = {0.1, 1, 0.2};
  camera.projection = projection;
  camera.height = 4;
  camera.fov_y_deg = 50;
  camera.width_px = camera.height_px = 256;
  const Result<CameraFrame> frame = MakeFrame(camera, 4);
  EXPECT_TRUE(frame.ok());
  return frame.value();
}

// Seen from +z, with y upwards on the screen: x runs to the right, rows run downwards.
CameraFrame FromAbove() {
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.up = {0, 1, 0};
  camera.height = 4;
  camera.width_px = camera.height_px = 256;
  return MakeFrame(camera, 4).value();
}

Model CircleModel() {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Circle({0, 0}, 1));
  model.vertices.push_back({{1, 0, 0}, 0});
  model.edges[0].vertices[0] = model.edges[0].vertices[1] = 0;
  return model;
}

TEST(ProjectedEdges, SideOfALine) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon({{-1, 0}, {1, 0}, {0, 1}}));
  const ProjectedEdges edges(model, Placement(), FromAbove());
  // The edge runs to the right through row 128. Since rows run downwards, the positive side is below it on
  // the screen.
  const EdgeSide below = edges.SideOf(0, 0.2, 128, 130), above = edges.SideOf(0, 0.9, 128, 125);
  EXPECT_EQ(below.side, Side::kPositive);
  EXPECT_EQ(above.side, Side::kNegative);
  EXPECT_NEAR(below.distance_px, 2, 1e-12);
  EXPECT_NEAR(above.distance_px, 3, 1e-12);
  EXPECT_NEAR(below.parameter, 0.5, 1e-9);
  EXPECT_NEAR(below.tangent.x, 128, 1e-12);
  EXPECT_NEAR(below.tangent.y, 0, 1e-12);
  // Beyond the end, the tangent line is used.
  const EdgeSide beyond = edges.SideOf(0, 0.5, 250, 129);
  EXPECT_EQ(beyond.parameter, 1);
  EXPECT_EQ(beyond.side, Side::kPositive);
}

TEST(ProjectedEdges, OnTheLineOneSideIsChosen) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon({{-1, 0}, {1, 0}, {0, 1}}));
  const ProjectedEdges edges(model, Placement(), FromAbove());
  const EdgeSide on = edges.SideOf(0, 0.3, 100, 128);
  EXPECT_EQ(on.distance_px, 0);
  EXPECT_EQ(on.side, Side::kNegative);
}

TEST(ProjectedEdges, KinksAreDecidedByBothTangents) {
  // One edge consists of two straight segments with a right angle at (0, 0). It turns to the left and then,
  // reversed, to the right.
  for (bool back : {false, true}) {
    Outline bent{{Line({-1, 0}, {0, 0}), Line({0, 0}, {0, 1})}};
    if (back) bent = Reversed(bent);
    Model model = PlaneModel(-2, 2, -2, 2);
    AddOpenLoop(model, bent);
    const ProjectedEdges edges(model, Placement(), FromAbove());
    for (double x : {-1.0, 1.0})
      for (double y : {-1.0, 1.0}) {
        // Only the quarter x < 0, y > 0 (up) is inside the angle, on the left. In pixels that is the negative
        // side.
        const bool inside = x < 0 && y > 0;
        const Side expected = inside != back ? Side::kNegative : Side::kPositive;
        for (double guess : {0.8, 1.0, 1.2})
          EXPECT_EQ(edges.SideOf(0, guess, 128 + x, 128 - 2 * y).side, expected)
              << x << " " << y << " " << guess;
      }
  }
}

TEST(ProjectedEdges, CircleIsClosedAndExact) {
  const Model model = CircleModel();
  const ProjectedEdges edges(model, Placement(), FromAbove());
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double angle = random.Uniform(0, 2 * kPi), off = std::pow(10, random.Uniform(-11, 0));
    for (double sign : {-1.0, 1.0}) {
      const double r = 64 + sign * off;
      const double quarter = angle / (kPi / 2);
      const double guess = std::fmod(quarter + random.Uniform(-0.3, 0.3) + 4, 4);
      const EdgeSide answer = edges.SideOf(0, guess, 128 + r * std::cos(angle), 128 - r * std::sin(angle));
      // Counter-clockwise with y upwards is clockwise in pixels, so the inside is the negative side.
      EXPECT_EQ(answer.side, sign > 0 ? Side::kPositive : Side::kNegative) << angle << " " << off;
      EXPECT_NEAR(answer.distance_px, off, 1e-9);
    }
  }
}

RC_GTEST_PROP(ProjectedEdges, TwoGuessesGiveTheSameBits, (std::uint32_t seed)) {
  Random random(seed);
  const Model model = CircleModel();
  const Projection projection = random.Integer(0, 1) ? Projection::kPerspective : Projection::kOrthographic;
  const CameraFrame frame =
      FrameOf({random.Uniform(1, 3), random.Uniform(1, 3), random.Uniform(3, 5)}, projection);
  const ProjectedEdges edges(model, Placement(), frame);
  const double angle = random.Uniform(0, 2 * kPi);
  const PixelPoint at = Project(frame, {std::cos(angle), std::sin(angle), 0});
  const double off = std::pow(10, random.Uniform(-14, -6));
  const double x = at.x + off * random.Uniform(-1, 1), y = at.y + off * random.Uniform(-1, 1);
  const double guess = 4 * angle / (2 * kPi);
  const EdgeSide a = edges.SideOf(0, std::fmod(guess + 4 + 1e-4, 4), x, y);
  const EdgeSide b = edges.SideOf(0, std::fmod(guess + 4 - 3e-5, 4), x, y);
  RC_ASSERT(a.side == b.side);
  RC_ASSERT(std::memcmp(&a.distance_px, &b.distance_px, sizeof(double)) == 0);
}

TEST(ProjectedEdges, BehindTheEyeIsUnknown) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon({{-1, 0}, {1, 0}, {0, 1}}));
  Camera camera;
  camera.eye = {0, -1, 0};
  camera.target = {1, -1, 0};
  camera.up = {0, 0, 1};
  camera.projection = Projection::kPerspective;
  camera.width_px = camera.height_px = 256;
  const CameraFrame frame = MakeFrame(camera, 4).value();
  const ProjectedEdges edges(model, Placement(), frame);
  // The edge crosses the eye plane x = 0: its far half is visible, its near half is not.
  const PixelPoint seen = Project(frame, {0.5, 0, 0});
  const Side over = edges.SideOf(0, 0.75, seen.x + 1, seen.y - 1).side,
             under = edges.SideOf(0, 0.75, seen.x - 1, seen.y + 1).side;
  EXPECT_NE(over, Side::kUnknown);
  EXPECT_NE(under, Side::kUnknown);
  EXPECT_EQ(edges.SideOf(0, 0.25, seen.x, seen.y).side, Side::kUnknown);
}

TEST(ProjectedEdges, SeenEndOnIsUnknown) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Polygon({{-1, 0}, {1, 0}, {0, 1}}));
  Camera camera;
  camera.eye = {5, 0, 0};
  camera.up = {0, 0, 1};
  camera.height = 4;
  const ProjectedEdges edges(model, Placement(), MakeFrame(camera, 4).value());
  EXPECT_EQ(edges.SideOf(0, 0.5, 100, 100).side, Side::kUnknown);
}

// Checks a fan of flat faces around one vertex, which are all visible: exactly one of them must keep every
// pixel near the vertex.
void ExpectFanTiles(Random& random, int spokes) {
  std::vector<double> angles;
  for (int i = 0; i < spokes; ++i) angles.push_back(2 * kPi * (i + random.Uniform(0.05, 0.95)) / spokes);
  angles.push_back(angles[0] + 2 * kPi);
  const auto at = [](double angle) { return Vec2{std::cos(angle), std::sin(angle)}; };
  ModelBuilder builder;
  builder.AddPart("fan");
  builder.AddInstance({});
  const auto add_edge = [&](Vec2 a, Vec2 b) {
    const std::uint32_t edge = builder.AddEdge({});
    builder.AddEdgeSegment(std::array{Vec4{a.x, a.y, 0, 1}, Vec4{b.x, b.y, 0, 1}});
    return edge;
  };
  const auto add_coedge = [&](std::uint32_t edge, bool reversed, Vec2 a, Vec2 b) {
    Coedge coedge;
    coedge.edge = edge;
    coedge.reversed = reversed;
    coedge.gap_mm = 1e-3;
    builder.AddCoedge(coedge);
    builder.AddTrimSegment(Line(a, b), reversed ? 1.0 : 0.0, reversed ? 0.0 : 1.0);
  };
  for (int i = 0; i < spokes; ++i) add_edge({0, 0}, at(angles[i]));
  for (int i = 0; i < spokes; ++i) {
    // The p-curves deviate from the true edges, differently for each face. The rim varies, so that reflex
    // corners may occur.
    const Vec2 shift{random.Uniform(-5e-4, 5e-4), random.Uniform(-5e-4, 5e-4)};
    const auto shifted = [&](double angle) { return at(angle) + shift; };
    const double turn = (angles[i + 1] - angles[i]) / 3;
    builder.AddFace({SurfaceKind::kPlane,
                     1,
                     1,
                     {{-2, 2}},
                     {{-2, 2}},
                     {{-2, -2, 0, 1}, {-2, 2, 0, 1}, {2, -2, 0, 1}, {2, 2, 0, 1}}});
    builder.AddLoop();
    add_coedge(static_cast<std::uint32_t>(i), false, shift, shifted(angles[i]));
    for (int k = 0; k < 3; ++k) {
      const double begin = angles[i] + k * turn, end = k < 2 ? angles[i] + (k + 1) * turn : angles[i + 1];
      add_coedge(add_edge(at(begin), at(end)), false, shifted(begin), shifted(end));
    }
    add_coedge(static_cast<std::uint32_t>((i + 1) % spokes), true, shifted(angles[i + 1]), shift);
  }
  const Model model = testing::Finished(std::move(builder));
  std::vector<FaceTrim> trims;
  for (int i = 0; i < spokes; ++i) trims.push_back(FaceTrim::Build(model, static_cast<std::uint32_t>(i)));

  const CameraFrame frame = FromAbove();
  const ProjectedEdges edges(model, Placement(), frame);
  for (int k = 0; k < 400; ++k) {
    const double r = std::pow(10, random.Uniform(-12, -1)), angle = random.Uniform(0, 2 * kPi);
    const Vec2 q{r * std::cos(angle), r * std::sin(angle)};
    const PixelPoint pixel = Project(frame, {q.x, q.y, 0});
    int kept = 0, asked = 0;
    for (const FaceTrim& trim : trims) {
      const TrimAnswer answer = trim.Query(q.x, q.y, 1e-15, 1e-15);
      bool keep = answer.inside;
      if (answer.coedge != kNoIndex) {
        ++asked;
        const EdgeVerdict verdict =
            DecideAtEdge(model, edges, answer, pixel.x, pixel.y, frame.pixel_x, false).verdict;
        if (verdict != EdgeVerdict::kUnknown) keep = verdict == EdgeVerdict::kKeep;
      }
      kept += keep;
    }
    RC_ASSERT(kept == 1);
    RC_ASSERT(asked > 0 || r > 1e-4);
  }
}

RC_GTEST_PROP(ProjectedEdges, FansOfFacesTileTheImage, (std::uint32_t seed)) {
  Random random(seed);
  ExpectFanTiles(random, random.Integer(3, 9));
}

// Two halves of a disc on either side of a curved edge. Their p-curves deviate by up to the gap.
RC_GTEST_PROP(ProjectedEdges, NeighboursAreComplementaryAlongACurve, (std::uint32_t seed)) {
  Random random(seed);
  const Curve arc{{-1, 0, 1}, {-0.3, random.Uniform(-1, 1), 1}, {0.4, random.Uniform(-1, 1), 1}, {1, 0, 1}};
  const double gap = 1e-3;
  const auto shifted = [](Curve curve, double by) {
    for (Vec3& p : curve) p.y += by;
    return curve;
  };
  const Curve upper = shifted(arc, random.Uniform(-0.7, 0.7) * gap),
              lower = shifted(arc, random.Uniform(-0.7, 0.7) * gap);
  // The upper face follows the arc, the lower one runs against it.
  Model above = PlaneModel(-2, 2, -2, 2), below = above;
  AddOpenLoop(above,
              {{upper}, {Line({1, 0}, {1, 1.5})}, {Line({1, 1.5}, {-1, 1.5})}, {Line({-1, 1.5}, {-1, 0})}},
              gap);
  Curve backwards(lower.rbegin(), lower.rend());
  AddOpenLoop(
      below,
      {{backwards}, {Line({-1, 0}, {-1, -1.5})}, {Line({-1, -1.5}, {1, -1.5})}, {Line({1, -1.5}, {1, 0})}},
      gap);
  // Both share edge 0, which is the arc itself.
  for (Model* side : {&above, &below})
    for (std::size_t i = 0; i < 4; ++i) side->edge_points[i] = {arc[i].x, arc[i].y, 0, 1};
  below.coedges[0].reversed = true;
  std::swap(below.trim_segments[0].edge_begin, below.trim_segments[0].edge_end);
  const FaceTrim up = FaceTrim::Build(above, 0), down = FaceTrim::Build(below, 0);

  const CameraFrame frame = FromAbove();
  const ProjectedEdges up_edges(above, Placement(), frame), down_edges(below, Placement(), frame);
  for (int i = 0; i < 200; ++i) {
    const Vec2 on = PointOn({arc.data(), 3}, random.Uniform(0.05, 0.95));
    const Vec2 q{on.x, on.y + (random.Integer(0, 1) ? 1 : -1) * std::pow(10, random.Uniform(-14, -1))};
    const PixelPoint pixel = Project(frame, {q.x, q.y, 0});
    const auto keeps = [&](const FaceTrim& trim, const Model& model_of, const ProjectedEdges& edges) {
      const TrimAnswer answer = trim.Query(q.x, q.y, 1e-15, 1e-15);
      const EdgeVerdict verdict =
          DecideAtEdge(model_of, edges, answer, pixel.x, pixel.y, frame.pixel_x, false).verdict;
      return verdict == EdgeVerdict::kUnknown ? answer.inside : verdict == EdgeVerdict::kKeep;
    };
    RC_ASSERT(keeps(up, above, up_edges) != keeps(down, below, down_edges));
  }
}

}  // namespace
}  // namespace facetless
