// Fields of view, unusual positions of the eye, unusual image sizes.
#include <cmath>
#include <numbers>

#include "tests/verify/extremes/catalogue.h"
#include "tests/verify/extremes/models.h"
#include "tests/verify/oracle/random_models.h"

namespace facetless::extremes {

using testing::Frustum;
using testing::ModelOf;
using testing::Sphere;

namespace {

void AddFields(Rows& rows) {
  struct Field {
    double degrees,
        least_distance_mm;  // of the eye from the sphere's centre; wide angles are used close to it
    bool across_the_eye =
        false;  // parts that need more leaves than the memory allows must be in doubt, with that reason
  };
  for (const Field& field : {Field{1e-6, 1.05},
                             {1e-3, 1.05},
                             {1, 1.05},
                             {120, 1.05},
                             {170, 1.05},
                             {179, 1.05},
                             {179.999, 2.5},
                             {179.999, 1.05, true}}) {
    const double fov = field.degrees, least_mm = field.least_distance_mm;
    const bool given_up = field.across_the_eye;
    char input[120];
    std::snprintf(input, sizeof input, "field of view of %g degrees, three solids of 1 mm%s", fov,
                  given_up ? ", across the eye plane" : "");
    rows.push_back(
        {.group = "field of view",
         .input = input,
         .expected = given_up   ? "right, or in doubt by the name limit"
                     : fov < 90 ? "right, to the digits of the eye's distance"
                                : "right",
         .model =
             [] {
               return ModelOf(ThreeSolids({0, 0, 0}, 1));
             },
         .cameras = [=](const Model&) -> std::vector<Camera> {
           const double distance = std::fmax(4 / std::tan(fov * std::numbers::pi / 360), least_mm);
           const Vec3 toward = Normalized({0.3, -1, 0.4});
           return {Perspective("whole", distance * toward, {0, 0, 0}, {0, 0, 1}, fov, 64, 64)};
         },
         .certified = given_up ? std::array<double, 3>{0, 0, 0} : std::array<double, 3>{0.99, 0.99, 0.99},
         .doubts = static_cast<std::uint8_t>(kDoubtSilhouette | kDoubtTwoRoots |
                                             (given_up ? kDoubtLimit | kDoubtUnresolved : 0)),
         .depth_bound_mm = fov < 1 ? 1e-4 : 1e-6});
  }
  rows.push_back({.group = "field of view",
                  .input = "a millionth of a degree at a sphere's border, 100 mm away",
                  .expected = "right",
                  .model =
                      [] {
                        return ModelOf({Sphere({0, 0, 0}, 1)});
                      },
                  .cameras = [](const Model&) -> std::vector<Camera> {
                    const double y = std::cos(std::asin(0.01)), x = 0.01;
                    return {Perspective("close", {100, 0, 0}, {x, y, 0}, {0, 0, 1}, 1e-6, 64, 64)};
                  },
                  .certified = {0, 0.9, 0.9},
                  .doubts = kDoubtSilhouette,
                  .depth_bound_mm = 1e-6});
}

void AddEyes(Rows& rows) {
  const auto sphere = [] { return ModelOf({Sphere({0, 0, 0}, 1)}); };
  // Looks from the eye in all six directions, with 120 degrees each.
  const auto all_around = [](Vec3 eye) {
    return [=](const Model&) {
      std::vector<Camera> views;
      const Vec3 directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
      const char* names[] = {"right", "left", "back", "front", "up", "down"};
      for (int i = 0; i < 6; ++i) {
        const Vec3 up = i < 4 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
        views.push_back(Perspective(names[i], eye, eye + directions[i], up, 120, 33, 33));
      }
      return views;
    };
  };
  const auto row = [&](const char* input, const char* expected, std::function<Model()> model, Vec3 eye,
                       std::array<double, 3> certified) {
    rows.push_back({.group = "eye",
                    .input = input,
                    .expected = expected,
                    .model = std::move(model),
                    .cameras = all_around(eye),
                    .certified = certified,
                    .doubts = kDoubtSilhouette | kDoubtPole | kDoubtTrim | kDoubtUnresolved | kDoubtTwoRoots |
                              kDoubtCoincident,
                    .depth_bound_mm = 1e-6});
  };
  const Vec3 on_it{std::cos(0.7) * std::cos(0.4), std::sin(0.7) * std::cos(0.4), std::sin(0.4)};
  row("in the middle of a sphere of 1 mm", "a hit everywhere", sphere, {0, 0, 0}, {0.9, 0.9, 0.9});
  row("1e-6 mm inside the sphere", "a hit everywhere", sphere, (1 - 1e-6) * on_it, {0.9, 0.9, 0.9});
  row("1e-9 mm inside the sphere: the near plane is behind the surface", "right beyond the near plane",
      sphere, (1 - 1e-9) * on_it, {0.9, 0.9, 0.9});
  row("1e-12 mm inside the sphere", "right beyond the near plane", sphere, (1 - 1e-12) * on_it,
      {0.9, 0.9, 0.9});
  row("on the sphere", "right beyond the near plane", sphere, on_it, {0.9, 0.9, 0.9});
  row("on the sphere, at a corner of four patches", "right beyond the near plane", sphere, {1, 0, 0},
      {0.9, 0.9, 0.9});
  row("at the sphere's pole", "right beyond the near plane", sphere, {0, 0, 1}, {0.9, 0.9, 0.9});
  row("at a cone's apex", "right beyond the near plane",
      [] {
        return ModelOf({Frustum({0, 0, 0}, 1, 0, 1)});
      },
      {0, 0, 1}, {0.9, 0.9, 0.9});
  row("on a solid box's face", "right beyond the near plane", [] { return oracle::SolidBox({}); },
      {0.3, 0.2, 1}, {0.9, 0.9, 0.9});
  row("at a solid box's vertex", "right beyond the near plane", [] { return oracle::SolidBox({}); },
      {1, 1, 1}, {0.9, 0.9, 0.9});
}

void AddImages(Rows& rows) {
  const auto solids = [] { return ModelOf(ThreeSolids({0, 0, 0}, 1)); };
  rows.push_back({.group = "image",
                  .input = "1 × 1 pixel",
                  .expected = "right",
                  .model = solids,
                  .cameras =
                      [](const Model& model) {
                        return NamedViews(model, {"iso", "top"}, 1);
                      },
                  .certified = {0, 0, 0},
                  .doubts = kDoubtPole | kDoubtTrim,
                  .depth_bound_mm = 1e-9});
  const auto strip = [](int width, int height) {
    return [=](const Model&) -> std::vector<Camera> {
      return {Orthographic("strip", {0.1, -5, 0.2}, {0.1, 0, 0.2}, {0, 0, 1}, 8.0 * height / width, width,
                           height)};
    };
  };
  rows.push_back({.group = "image",
                  .input = "16,384 × 64 pixels",
                  .expected = "right",
                  .model = solids,
                  .cameras = strip(16384, 64),
                  .certified = {0.99, 0.999, 0.999},
                  .doubts = kDoubtSilhouette,
                  .depth_bound_mm = 1e-6});
  rows.push_back({.group = "image",
                  .input = "64 × 65,536 pixels",
                  .expected = "right",
                  .model = solids,
                  .cameras = [](const Model&) -> std::vector<Camera> {
                    return {Orthographic("strip", {0.1, -5, 0.2}, {0.1, 0, 0.2}, {0, 0, 1}, 8, 64, 65536)};
                  },
                  .certified = {0.99, 0.999, 0.999},
                  .doubts = kDoubtSilhouette,
                  .depth_bound_mm = 1e-6,
                  .by_hand = true});
}

}  // namespace

void AddViews(Rows& rows) {
  AddFields(rows);
  AddEyes(rows);
  AddImages(rows);
}

}  // namespace facetless::extremes
