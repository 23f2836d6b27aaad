// The size of a model, its distance from the origin, and long and thin models.
#include <cmath>

#include "tests/verify/extremes/catalogue.h"
#include "tests/verify/extremes/models.h"

namespace facetless::extremes {

using testing::Frustum;
using testing::ModelOf;
using testing::PatchGrid;
using testing::Place;
using testing::Rectangle;

namespace {

std::vector<Camera> WholeViews(const Model& model) {
  return NamedViews(model, {"iso", "front"}, 64);
}

constexpr Vec3 kFar{1e7, -1e7, 1e7};

// Rotates by an angle whose sine is no short number, and moves to `place`.
Placement TurnedAt(Vec3 place) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  return {{{c, -s, 0, place.x}, {s, c, 0, place.y}, {0, 0, 1, place.z}}};
}

constexpr double kLong = 1e8;

}  // namespace

void AddSizes(Rows& rows) {
  for (const double size : {1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9}) {
    char input[80];
    std::snprintf(input, sizeof input, "sphere, torus and cone of %g mm", size);
    rows.push_back({.group = "size",
                    .input = input,
                    .expected = "the same digits at every size",
                    .model =
                        [=] {
                          return ModelOf(ThreeSolids({0, 0, 0}, size));
                        },
                    .cameras = WholeViews,
                    .depth_bound_mm = 1e-9 * size});
  }
  rows.push_back({.group = "size",
                  .input = "1 mm, 1e7 mm from the origin by its coordinates",
                  .expected = "the coordinates' own digits",
                  .model = [] { return ModelOf(ThreeSolids(kFar, 0.125)); },
                  .cameras = WholeViews,
                  .depth_bound_mm = 1e-5});
  rows.push_back({.group = "size",
                  .input = "1 mm, 1e7 mm from the origin by a placement",
                  .expected = "no digit is lost",
                  .model =
                      [] {
                        Model model = ModelOf(ThreeSolids({0, 0, 0}, 0.125));
                        Place(&model, TurnedAt(kFar));
                        Box3 box;
                        for (const double x : {-1.0, 1.0})
                          for (const double y : {-1.0, 1.0}) box.Add(kFar + Vec3{0.5 * x, 0.5 * y, 0.2 * x});
                        model.bounds = box;
                        return model;
                      },
                  .cameras = WholeViews,
                  .depth_bound_mm = 1e-10});
  rows.push_back({.group = "size",
                  .input = "a strip of 1e8 × 1 mm: whole, and the millimetre in its middle and at its end",
                  .expected = "right at every zoom",
                  .model =
                      [] {
                        return ModelOf({Rectangle({0, 0, 0}, {kLong, 0.3, 0}, {0, 1, 0.2})});
                      },
                  .cameras =
                      [](const Model& model) {
                        std::vector<Camera> views = WholeViews(model);
                        views.push_back(CloseTo(model, "iso", {0.5 * kLong, 0.65, 0.1}, 2, 64));
                        views.push_back(CloseTo(model, "top", {kLong, 0.8, 0.1}, 2, 64));
                        return views;
                      },
                  .depth_bound_mm = 1e-5});
  rows.push_back(
      {.group = "size",
       .input = "a tube of 1e8 mm, 1 mm wide: whole, its middle, its end, and through it along the axis",
       .expected = "right at every zoom",
       .model =
           [] {
             return ModelOf({Frustum({0, 0, 0}, 0.5, 0.5, kLong)});
           },
       .cameras =
           [](const Model& model) {
             std::vector<Camera> views = WholeViews(model);
             views.push_back(CloseTo(model, "front", {0, 0, 0.5 * kLong}, 2, 64));
             views.push_back(CloseTo(model, "iso", {0, 0, kLong}, 2, 64));
             views.push_back(Orthographic("along", {0, 0, -1}, {0, 0, 0}, {0, 1, 0}, 2, 63, 63));
             views.push_back(
                 Perspective("inside", {0.1, 0.1, 0.5 * kLong}, {0.1, 0.1, kLong}, {0, 1, 0}, 60, 63, 63));
             return views;
           },
       .certified = {0.999, 0.999, 0.999},
       .doubts = kDoubtTrim | kDoubtSilhouette | kDoubtTwoRoots,
       .depth_bound_mm = 1e-4});
  rows.push_back({.group = "size",
                  .input = "a bumpy patch of 1e8 × 1 × 1e-4 mm",
                  .expected = "right at every zoom",
                  .model =
                      [] {
                        return ModelOf({Mapped(BumpyPatch(3, 3, 1), [](Vec3 p) {
                          return Vec3{kLong * p.x, p.y, 1e-4 * p.z};
                        })});
                      },
                  .cameras =
                      [](const Model& model) {
                        std::vector<Camera> views = WholeViews(model);
                        views.push_back(CloseTo(model, "top", {0.4 * kLong, 0.5, 0}, 2, 64));
                        views.push_back(CloseTo(model, "iso", {0.4 * kLong, 0.5, 0}, 2, 64));
                        return views;
                      },
                  .depth_bound_mm = 1e-5});
}

}  // namespace facetless::extremes
