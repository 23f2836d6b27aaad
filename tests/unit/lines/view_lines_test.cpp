// The lines of a view, compared with closed forms: their places, their classes and their visibility.
#include "render/lines/view_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "render/lines/draw_lines.h"
#include "render/lines/edge_lines.h"
#include "render/lines/visibility.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using std::numbers::pi;
using testing::Frustum;
using testing::LooseBox;
using testing::ModelOf;
using testing::Rectangle;
using testing::Sphere;
using testing::Torus;

std::vector<ViewLine> LinesOf(const Model& model, const Camera& camera,
                              std::vector<SectionPlane> sections = {}, int threads = 0) {
  const Scene scene(model);
  DirectOptions options;
  options.sections = sections;
  const DirectResult direct = TraceDirect(scene, camera, options).value();
  return FindLines(scene, camera, direct.frame, direct.samples, direct.frame,
                   {.sections = std::move(sections), .execution = {.threads = threads}});
}

// Returns the length, in pixels, of the lines of a class in the window of size × size.
double LengthOf(const std::vector<ViewLine>& lines, LineClass kind, bool visible, double size = 300) {
  double length = 0;
  for (const ViewLine& line : lines) {
    if (line.kind != kind || line.visible != visible) continue;
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const LinePoint &a = line.points[i - 1], &b = line.points[i];
      double begin = 0, end = 1;
      for (const auto& [from, to] : {std::pair(a.x, b.x), std::pair(a.y, b.y)}) {
        const double at_low = (0 - from) / (to - from), at_high = (size - from) / (to - from);
        if (from == to && (from < 0 || from > size)) end = 0;
        if (from == to) continue;
        begin = std::max(begin, std::min(at_low, at_high));
        end = std::min(end, std::max(at_low, at_high));
      }
      length += std::max(end - begin, 0.0) * std::hypot(b.x - a.x, b.y - a.y);
    }
  }
  return length;
}

Camera ViewOf(const Model& model, const char* name, Projection projection, int size = 300) {
  return NamedView(name, model.bounds, projection, size, size).value();
}

// Checks that all chords of the class lie within kFlatness of the circle, and that they go around it once.
void ExpectCircle(const std::vector<ViewLine>& lines, LineClass kind, double x, double y, double radius) {
  double around = 0;
  for (const ViewLine& line : lines) {
    if (line.kind != kind) continue;
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const LinePoint &a = line.points[i - 1], &b = line.points[i];
      ASSERT_NEAR(std::hypot(a.x - x, a.y - y), radius, 1e-5);
      ASSERT_NEAR(std::hypot(0.5 * (a.x + b.x) - x, 0.5 * (a.y + b.y) - y), radius, 1.01 * kFlatness);
      around += std::hypot(a.x - b.x, a.y - b.y);
    }
  }
  EXPECT_NEAR(around / (2 * pi * radius), 1, 1e-3);
}

TEST(ViewLines, OfABallAreItsOutline) {
  const Model model = ModelOf({Sphere({3, -2, 5}, 10)});
  // The views front and top look along the lines in which patches meet, and along the seam.
  for (const char* name : {"iso", "front", "top", "right"}) {
    const Camera camera = ViewOf(model, name, Projection::kOrthographic);
    const auto lines = LinesOf(model, camera);
    ExpectCircle(lines, LineClass::kSilhouette, 150, 150, 10 * 300 / camera.height);
    EXPECT_EQ(LengthOf(lines, LineClass::kSilhouette, false), 0) << name;
  }
}

TEST(ViewLines, OfABallInPerspectiveAreTheConeThatTouchesIt) {
  const Model model = ModelOf({Sphere({0, 0, 0}, 10)});
  const Camera camera = ViewOf(model, "iso", Projection::kPerspective);
  const CameraFrame frame = MakeFrame(camera, 20).value();
  const double distance = Length(camera.eye), sine = 10 / distance;
  ExpectCircle(LinesOf(model, camera), LineClass::kSilhouette, 150, 150,
               sine / std::sqrt(1 - sine * sine) / frame.pixel_x);
}

TEST(ViewLines, OfABoxAreNineEdgesSeenAndThreeHidden) {
  const Model model = LooseBox({10, 10, 10}, 0, 1);
  const Camera camera = ViewOf(model, "iso", Projection::kOrthographic);
  const auto lines = LinesOf(model, camera);
  // Seen along the diagonal, all edges of a cube have the same projected length, √(2/3) of their own.
  const double edge = 10 * std::sqrt(2.0 / 3) * 300 / camera.height;
  EXPECT_NEAR(LengthOf(lines, LineClass::kFeature, true), 9 * edge, 4);
  EXPECT_NEAR(LengthOf(lines, LineClass::kFeature, false), 3 * edge, 4);
  EXPECT_EQ(LengthOf(lines, LineClass::kSilhouette, true), 0);
  EXPECT_EQ(LengthOf(lines, LineClass::kBoundary, true), 0);
}

TEST(ViewLines, OfACylinderAreTwoStraightOnes) {
  const Model model = ModelOf({Frustum({0, 0, 0}, 5, 5, 20)});
  const Camera camera = ViewOf(model, "front", Projection::kOrthographic);
  const auto lines = LinesOf(model, camera);
  EXPECT_NEAR(LengthOf(lines, LineClass::kSilhouette, true), 2 * 20 * 300 / camera.height, 1e-6);
  // Seen along its axis, the whole surface is edge-on, so there is no silhouette line.
  EXPECT_EQ(LinesOf(model, ViewOf(model, "top", Projection::kOrthographic)).size(), 0u);
}

TEST(ViewLines, ThatLieBehindAreHidden) {
  // A ball behind a plate: seen from the front, then from behind.
  const Model model = ModelOf({Rectangle({-20, 0, -20}, {40, 0, 0}, {0, 0, 40}), Sphere({0, 15, 0}, 10)});
  const auto front = LinesOf(model, ViewOf(model, "front", Projection::kOrthographic));
  EXPECT_EQ(LengthOf(front, LineClass::kSilhouette, true), 0);
  EXPECT_GT(LengthOf(front, LineClass::kSilhouette, false), 100);
  const auto back = LinesOf(model, ViewOf(model, "back", Projection::kOrthographic));
  EXPECT_EQ(LengthOf(back, LineClass::kSilhouette, false), 0);
  EXPECT_GT(LengthOf(back, LineClass::kSilhouette, true), 100);
}

TEST(ViewLines, AreWholeHoweverNearOneLooks) {
  // Beside the silhouette of a ball of r samples, the plane of a sample changes its depth by √(r/2) samples
  // from one to the next.
  const Model model = ModelOf({Sphere({0, 0, 0}, 10)});
  for (const double height : {1e-1, 1e-3, 1e-5}) {
    Camera camera = ViewOf(model, "front", Projection::kOrthographic);
    const Vec3 to_edge = Vec3{6, 0, 8} - camera.target;
    camera.eye = camera.eye + to_edge;
    camera.target = camera.target + to_edge;
    camera.height = height;
    const auto lines = LinesOf(model, camera);
    EXPECT_NEAR(LengthOf(lines, LineClass::kSilhouette, true), 300 / 0.8, 2) << height;
    EXPECT_EQ(LengthOf(lines, LineClass::kSilhouette, false), 0) << height;
  }
}

// Returns the lines of pixels, with visibility from a picture that has n × n samples per pixel.
std::vector<ViewLine> FineLinesOf(const Model& model, const Camera& camera, int n) {
  const Scene scene(model);
  const Camera fine = camera.Supersampled(n, n);
  const DirectResult direct = TraceDirect(scene, fine, {}).value();
  return FindLines(scene, camera, MakeFrame(camera, model.Diagonal()).value(), direct.samples, direct.frame,
                   {});
}

TEST(ViewLines, OfSmoothBodiesDoNotHideThemselvesHoweverManySamples) {
  const Model ball = ModelOf({Sphere({3, -2, 5}, 10)}), ring = ModelOf({Torus({0, 0, 0}, 20, 6)});
  for (const char* name : {"iso", "front", "top"}) {
    const Camera camera = ViewOf(ball, name, Projection::kOrthographic);
    for (const int n : {1, 2, 4, 8}) {
      const auto lines = FineLinesOf(ball, camera, n);
      EXPECT_EQ(LengthOf(lines, LineClass::kSilhouette, false), 0) << name << " " << n;
      ExpectCircle(lines, LineClass::kSilhouette, 150, 150, 10 * 300 / camera.height);
    }
  }
  // Seen from above, nothing of a ring is hidden.
  const Camera camera = ViewOf(ring, "top", Projection::kOrthographic);
  for (const int n : {1, 4, 8}) {
    const auto lines = FineLinesOf(ring, camera, n);
    EXPECT_EQ(LengthOf(lines, LineClass::kSilhouette, false), 0) << n;
    EXPECT_NEAR(LengthOf(lines, LineClass::kSilhouette, true), 2 * pi * (26 + 14) * 300 / camera.height, 2);
  }
}

TEST(Visibility, MakesASmoothEdgeOnTheOutlineASilhouette) {
  // Samples to the left of x = 50 show a plane that is parallel to the image; there is nothing to the right.
  // There are three visible lines: on the outline, inside, and a sharp edge on the outline, which keeps its
  // class.
  Camera camera;
  camera.width_px = camera.height_px = 100;
  camera.eye = {0, 0, 10};
  camera.target = {0, 0, 0};
  camera.up = {0, 1, 0};
  camera.height = 100;
  const CameraFrame frame = MakeFrame(camera, 10).value();
  SampleBuffer samples;
  samples.Resize(100, 100);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % 100 >= 50) continue;
    samples.depth[i] = 10;
    samples.face[i] = 0;
    samples.normal[i] = {0, 0, 1};
  }
  const auto line = [](LineClass kind, double x) {
    return ViewLine{kind, true, {{x, 10, 10}, {x, 90, 10}}, {0, 1}};
  };
  const auto lines = SplitByVisibility(
      {line(LineClass::kSmooth, 50), line(LineClass::kSmooth, 30), line(LineClass::kFeature, 50)}, frame,
      samples, frame, {{1}, {0}});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].kind, LineClass::kSilhouette);
  EXPECT_EQ(lines[1].kind, LineClass::kSmooth);
  EXPECT_EQ(lines[2].kind, LineClass::kFeature);
}

TEST(ViewLines, AreHiddenToThePixelHoweverFarTheyRunBesideThePicture) {
  // A wire of ten kilometres, with a ball in front of its right side.
  const Model model = ModelOf({Frustum({0, 0, -5e6}, 5, 5, 1e7), Sphere({5, -20, 0}, 4)});
  Camera camera = ViewOf(model, "front", Projection::kOrthographic);
  camera.eye = {0, -100, 0};
  camera.target = {0, 0, 0};
  camera.height = 20;
  const auto lines = LinesOf(model, camera);
  EXPECT_NEAR(LengthOf(lines, LineClass::kSilhouette, false), 8 * 15, 2);
  EXPECT_NEAR(LengthOf(lines, LineClass::kSilhouette, true), 2 * 300 - 8 * 15 + 2 * pi * 4 * 15, 3);
  // The SVG file contains no dashes and no numbers for the parts outside the window.
  for (const ViewLine& line : lines)
    for (const LinePoint& p : line.points) {
      EXPECT_LE(std::fabs(p.x - 150), 158.001);
      EXPECT_LE(std::fabs(p.y - 150), 158.001);
    }
}

TEST(ViewLines, AreAsMuchHiddenInALargePictureAsInASmallOne) {
  // At a shallow angle, the ring itself hides most of the silhouette of its hole.
  const Model model = ModelOf({Torus({0, 0, 0}, 20, 6)});
  Camera small = ViewOf(model, "front", Projection::kOrthographic);
  small.eye = small.target + Vec3{0, -96, 28};
  Camera large = small;
  large.width_px = large.height_px = 2400;
  const auto few = LinesOf(model, small), many = LinesOf(model, large);
  for (const bool visible : {true, false}) {
    const double length = LengthOf(few, LineClass::kSilhouette, visible);
    EXPECT_GT(length, 20);
    EXPECT_NEAR(LengthOf(many, LineClass::kSilhouette, visible, 2400) / 8, length, 3);
  }
}

TEST(ViewLines, OfACutAreItsOutline) {
  const Model model = testing::ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10)}), "ball");
  const Camera camera = ViewOf(model, "top", Projection::kOrthographic);
  const auto lines = LinesOf(model, camera, {{{0, 0, 6}, {0, 0, 1}}});
  ExpectCircle(lines, LineClass::kCut, 150, 150, 8 * 300 / camera.height);
  EXPECT_EQ(LengthOf(lines, LineClass::kCut, false), 0);
  // The removed part has no outline: everything above the widest circle.
  EXPECT_EQ(LengthOf(LinesOf(model, camera, {{{0, 0, -1}, {0, 0, 1}}}), LineClass::kSilhouette, true), 0);
}

TEST(ViewLines, SeenEdgeOnKeepTheirDepth) {
  // Seen from the front, the outline of a cut is a straight line, but its points lie on a circle.
  const Camera camera = ViewOf(ModelOf({Sphere({0, 0, 0}, 10)}), "front", Projection::kOrthographic);
  const double pixel = camera.height / 300;
  const auto expect_circle = [&](const std::vector<ViewLine>& lines, LineClass kind, double radius) {
    double nearest = INFINITY, farthest = 0;
    for (const ViewLine& line : lines)
      for (std::size_t i = 0; i < line.points.size(); ++i)
        if (line.kind == kind) {
          nearest = std::min(nearest, line.points[i].depth);
          farthest = std::max(farthest, line.points[i].depth);
        }
    const double middle = 0.5 * (nearest + farthest);
    EXPECT_NEAR((farthest - nearest) / 2, radius, pixel);
    for (const ViewLine& line : lines)
      for (std::size_t i = 1; line.kind == kind && i < line.points.size(); ++i) {
        const LinePoint &a = line.points[i - 1], &b = line.points[i];
        const double x = (0.5 * (a.x + b.x) - 150) * pixel, depth = 0.5 * (a.depth + b.depth) - middle;
        // Where the circle runs along the ray, half a pixel sideways is more than half a pixel of depth.
        if (std::fabs(x) > 0.9 * radius) continue;
        EXPECT_NEAR(std::hypot(x, depth), radius, 2 * kDepthFlatness * pixel) << "at " << 0.5 * (a.x + b.x);
      }
  };
  Model ball = ModelOf({Sphere({0, 0, 0}, 10)});
  expect_circle(LinesOf(ball, camera, {{{0, 0, 0}, {0, 0, 1}}}), LineClass::kCut, 10);
}

TEST(ViewLines, AreTheSameForAnyNumberOfThreads) {
  const Model model = ModelOf({Torus({0, 0, 0}, 20, 6), Sphere({0, 5, 8}, 5)});
  const Camera camera = ViewOf(model, "iso", Projection::kPerspective);
  const std::string one = LinesSvg(LinesOf(model, camera, {}, 1), 300, 300, 0, "x"),
                    two = LinesSvg(LinesOf(model, camera, {}, 2), 300, 300, 0, "x");
  EXPECT_GT(one.size(), 500u);
  EXPECT_EQ(one, two);
}

TEST(EdgeClasses, AreThoseOfTheirFaces) {
  const Model model = LooseBox({10, 20, 30}, 0, 1);
  for (const LineClass kind : ClassifyEdges(model, 20)) EXPECT_EQ(kind, LineClass::kFeature);
  for (const LineClass kind : ClassifyEdges(model, 91)) EXPECT_EQ(kind, LineClass::kSmooth);
  // Without the first face, four of the twelve edges are used once.
  Model open = LooseBox({10, 20, 30}, 0, 1);
  open.faces[0].loops = {};
  std::map<LineClass, int> counts;
  for (const LineClass kind : ClassifyEdges(open, 20)) ++counts[kind];
  EXPECT_EQ(counts[LineClass::kBoundary], 4);
  EXPECT_EQ(counts[LineClass::kFeature], 8);
}

Film WhiteFilm(int width, int height) {
  Film film;
  film.width = width;
  film.height = height;
  film.pixels.assign(std::size_t(width) * height, {1, 1, 1, 1});
  return film;
}

TEST(DrawLines, CoversAsMuchAsTheLineIsWide) {
  const LineStyle style = LineStyleFor(LineClass::kFeature, true);
  for (const double y : {10.0, 10.25, 10.5, 10.9}) {
    Film film = WhiteFilm(40, 20);
    const ViewLine line{LineClass::kFeature, true, {{-5, y, 0}, {20, y, 0}, {45, y, 0}}};
    DrawLines({&line, 1}, &film);
    for (const int x : {0, 19, 20, 39}) {
      double cover = 0;
      for (int row = 0; row < 20; ++row) cover += (1 - film.pixels[row * 40 + x][0]) / (1 - style.ink[0]);
      EXPECT_NEAR(cover, style.width * style.cover, 1e-3) << y << " " << x;
    }
  }
}

TEST(DrawLines, DashesHiddenLinesBelowVisibleOnes) {
  Film film = WhiteFilm(200, 20);
  const ViewLine hidden{LineClass::kFeature, false, {{0, 10.5, 0}, {200, 10.5, 0}}};
  DrawLines({&hidden, 1}, &film);
  int gaps = 0;
  for (int x = 1; x < 200; ++x) {
    const bool ink = film.pixels[10 * 200 + x][0] < 0.9, before = film.pixels[10 * 200 + x - 1][0] < 0.9;
    gaps += before && !ink;
  }
  EXPECT_NEAR(gaps, 25, 1);
}

TEST(LinesSvg, GroupsLinesByClassAndEscapesItsTitle) {
  const std::vector<ViewLine> lines = {{LineClass::kFeature, true, {{0, 0, 0}, {5, 0, 0}, {10, 0, 0}}},
                                       {LineClass::kSilhouette, false, {{1, 2.345, 0}, {3, 4, 0}}}};
  const std::string svg = LinesSvg(lines, 100, 50, 0.5, "<a&b>");
  EXPECT_NE(svg.find("viewBox=\"0 0 100 50\" width=\"50mm\" height=\"25mm\""), std::string::npos);
  EXPECT_NE(svg.find("<title>&lt;a&amp;b>"), std::string::npos);
  EXPECT_NE(svg.find("<g class=\"feature visible\">\n<path d=\"M0 0L10 0\"/>"), std::string::npos) << svg;
  EXPECT_NE(svg.find("<g class=\"silhouette hidden\">\n<path d=\"M1 2.3"), std::string::npos) << svg;
}

}  // namespace
}  // namespace facetless
