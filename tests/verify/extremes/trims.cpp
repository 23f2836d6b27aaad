// Loops that are tiny, that touch each other, or that have very many segments.
#include <cmath>
#include <numbers>

#include "tests/unit/nurbs/trim_models.h"
#include "tests/verify/extremes/catalogue.h"
#include "tests/verify/extremes/models.h"

namespace facetless::extremes {

using namespace trim_models;  // NOLINT(google-build-using-namespace)

namespace {

// A square of 10 mm with its border as a loop.
Model Square() {
  Model model = PlaneModel(0, 10, 0, 10);
  AddLoop(model, Polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}}));
  return model;
}

std::vector<Camera> Whole(const Model& model) {
  return NamedViews(model, {"top", "iso"}, 65);
}

Outline RegularPolygon(Vec2 center, double radius, int corners) {
  std::vector<Vec2> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.push_back({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)});
  }
  return Polygon(points);
}

// A star whose corners lie alternately on two circles.
Outline Star(Vec2 center, double inner, double outer, int corners) {
  std::vector<Vec2> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, radius = i % 2 ? inner : outer;
    points.push_back({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)});
  }
  return Polygon(points);
}

}  // namespace

void AddTrims(Rows& rows) {
  const auto with_holes = [](const std::vector<Outline>& holes) {
    Model model = Square();
    for (const Outline& hole : holes) AddLoop(model, Reversed(hole));
    return model;
  };
  for (const double size : {1e-6, 1e-9, 1e-12}) {
    char input[80];
    std::snprintf(input, sizeof input, "a hole of %g mm in a square of 10 mm, whole and close", size);
    const Vec2 center{3.3, 4.7};
    rows.push_back({.group = "trims",
                    .input = input,
                    .expected = "the hole is there; in doubt on its border only",
                    .model = [=] { return with_holes({RegularPolygon(center, 0.5 * size, 7)}); },
                    .cameras =
                        [=](const Model& model) {
                          std::vector<Camera> views = Whole(model);
                          const Vec3 point{center.x, center.y, 0};
                          for (const double window : {1e3 * size, 3 * size})
                            views.push_back(CloseTo(model, "top", point, window, 33));
                          return views;
                        },
                    .certified = {0, 0.5, 0.5},
                    .doubts = kDoubtTrim,
                    .depth_bound_mm = 1e-9});
  }
  const auto close_to = [](Vec3 point) {
    return [=](const Model& model) {
      std::vector<Camera> views = Whole(model);
      for (const double window : {1e-3, 1e-6, 1e-9})
        views.push_back(CloseTo(model, "top", point, window, 33));
      return views;
    };
  };
  rows.push_back({.group = "trims",
                  .input = "two square holes that share a corner",
                  .expected = "right; in doubt at the corner and the border only",
                  .model =
                      [=] {
                        return with_holes({Polygon({{3, 3}, {5, 3}, {5, 5}, {3, 5}}),
                                           Polygon({{5, 5}, {7, 5}, {7, 7}, {5, 7}})});
                      },
                  .cameras = close_to({5, 5, 0}),
                  .certified = {0, 0.5, 0.5},
                  .doubts = kDoubtTrim,
                  .depth_bound_mm = 1e-9});
  rows.push_back({.group = "trims",
                  .input = "two square holes that share a side",
                  .expected = "right; in doubt on the border only",
                  .model =
                      [=] {
                        return with_holes({Polygon({{3, 3}, {5, 3}, {5, 6}, {3, 6}}),
                                           Polygon({{5, 3}, {7, 3}, {7, 6}, {5, 6}})});
                      },
                  .cameras = close_to({5, 4, 0}),
                  .certified = {0, 0.5, 0.5},
                  .doubts = kDoubtTrim,
                  .depth_bound_mm = 1e-9});
  rows.push_back({.group = "trims",
                  .input = "a round hole that touches the border of the face",
                  .expected = "right; in doubt on the border only",
                  .model =
                      [=] {
                        return with_holes({Circle({2, 5}, 2)});
                      },
                  .cameras = close_to({0, 5, 0}),
                  .certified = {0, 0.5, 0.5},
                  .doubts = kDoubtTrim | kDoubtTwoRoots,
                  .depth_bound_mm = 1e-9});
  rows.push_back({.group = "trims",
                  .input = "a star-shaped hole of 10,000 segments",
                  .expected = "right",
                  .model =
                      [=] {
                        return with_holes({Star({5, 5}, 3, 4, 10000)});
                      },
                  .cameras =
                      [](const Model& model) {
                        std::vector<Camera> views = Whole(model);
                        views.push_back(CloseTo(model, "top", {8.5, 5, 0}, 0.05, 65));
                        return views;
                      },
                  .certified = {0.5, 0.99, 0.99},
                  .doubts = kDoubtTrim,
                  .depth_bound_mm = 1e-9,
                  .judged = 12});
}

}  // namespace facetless::extremes
