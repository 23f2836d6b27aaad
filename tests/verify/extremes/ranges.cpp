// Numbers at the ends of the range of double.
#include <cmath>

#include "tests/verify/extremes/catalogue.h"
#include "tests/verify/extremes/models.h"

namespace facetless::extremes {

using testing::ModelOf;
using testing::Sphere;

namespace {

constexpr double kDenormal = 0x1p-1060;

std::vector<Camera> Views(const Model& model) {
  return NamedViews(model, {"iso"}, 33);
}

// Returns two views for a model of any size about the origin.
std::vector<Camera> ViewsOf(double size) {
  const Vec3 eye = {0, -3 * size, size};
  return {Orthographic("orthographic", eye, {0, 0, 0}, {0, 0, 1}, 2.5 * size, 33, 33),
          Perspective("perspective", eye, {0, 0, 0}, {0, 0, 1}, 45, 33, 33)};
}

void AddSpheres(Rows& rows) {
  const auto row = [&](double size, const char* expected, std::optional<ErrorCode> error) {
    char input[80];
    std::snprintf(input, sizeof input, "sphere of %g mm", size);
    rows.push_back({.group = "range",
                    .input = input,
                    .expected = expected,
                    .model =
                        [=] {
                          return ModelOf({Sphere({0, 0, 0}, size)});
                        },
                    .cameras = [=](const Model&) { return ViewsOf(size); },
                    .doubts = kDoubtSilhouette,
                    .depth_bound_mm = 1e-9 * size,
                    .error = error});
  };
  for (const double size : {1e-28, 1e-20, 1e20, 1e28}) row(size, "right", std::nullopt);
  for (const double size : {1e-40, 1e-160, 1e-310, 1e40, 1e160, 1e300})
    row(size, "a clear error: lengths may be 1e-30 to 1e30 mm", ErrorCode::kBadUsage);
}

void AddModels(Rows& rows) {
  rows.push_back({.group = "range",
                  .input = "denormal coordinates among those of 10 mm",
                  .expected = "right, as if they were 0",
                  .model =
                      [] {
                        return ModelOf({Mapped(BumpyPatch(3, 3, 10), [](Vec3 p) {
                          return Vec3{p.x + kDenormal, p.y > 0 ? p.y : kDenormal, p.z * 1e-309};
                        })});
                      },
                  .cameras = Views,
                  .depth_bound_mm = 1e-9});
  rows.push_back({.group = "range",
                  .input = "denormal weights among those of 1",
                  .expected = "right",
                  .model =
                      [] {
                        return ModelOf({BumpyPatch(
                            3, 3, 10, [](int k, int l) { return k % 3 && l % 3 ? kDenormal : 1; })});
                      },
                  .cameras = Views,
                  .depth_bound_mm = 1e-6});
  rows.push_back({.group = "range",
                  .input = "all weights denormal",
                  .expected = "a clear error",
                  .model =
                      [] {
                        Model model = ModelOf({BumpyPatch(3, 3, 10)});
                        model.surfaces[0].rational = true;
                        model.control_points =
                            BumpyPatch(3, 3, 10, [](int, int) { return kDenormal; }).points;
                        return model;
                      },
                  .cameras = Views,
                  .error = ErrorCode::kFormatBroken});
}

void AddCameras(Rows& rows) {
  const auto row = [&](const char* input, const char* expected, const std::function<void(Camera&)>& change,
                       std::optional<ErrorCode> error) {
    rows.push_back({.group = "range",
                    .input = std::string("camera: ") + input,
                    .expected = expected,
                    .model =
                        [] {
                          return ModelOf({Sphere({0, 0, 0}, 10)});
                        },
                    .cameras = [=](const Model& model) -> std::vector<Camera> {
                      Camera camera =
                          NamedView("iso", model.bounds, Projection::kOrthographic, 33, 33).value();
                      change(camera);
                      return {camera};
                    },
                    .certified = {0.98, 0.98, 0.98},
                    .doubts = kDoubtSilhouette | kDoubtTrim,
                    .depth_bound_mm = 1e-6,
                    .error = error});
  };
  const auto perspective = [](double fov_y_deg) {
    return [=](Camera& camera) {
      camera.projection = Projection::kPerspective;
      camera.fov_y_deg = fov_y_deg;
    };
  };
  const auto window = [](double height) { return [=](Camera& camera) { camera.height = height; }; };
  row("a window of 1e-28 mm", "right: one point, 33 × 33 times", window(1e-28), std::nullopt);
  row("a window of 1e-310 mm", "a clear error", window(1e-310), ErrorCode::kBadUsage);
  row("a window of 1e28 mm", "nothing but the middle pixel", window(1e28), std::nullopt);
  row("a window of 1e300 mm", "a clear error", window(1e300), ErrorCode::kBadUsage);
  row("a field of view of 1e-20 degrees", "right: one point, 33 × 33 times", perspective(1e-20),
      std::nullopt);
  row("a field of view of 1e-310 degrees", "a clear error", perspective(1e-310), ErrorCode::kBadUsage);
  row(
      "an eye a denormal aside", "right", [](Camera& camera) { camera.eye.y = camera.target.y = kDenormal; },
      std::nullopt);
  row(
      "an eye a denormal away from its target", "a clear error",
      [](Camera& camera) {
        camera.eye = camera.target + Vec3{0, kDenormal, 0};
      },
      ErrorCode::kBadUsage);
  row(
      "an eye 1e200 mm away", "a clear error",
      [](Camera& camera) {
        camera.eye = {1e200, 0, 0};
      },
      ErrorCode::kBadUsage);
}

}  // namespace

void AddRanges(Rows& rows) {
  AddSpheres(rows);
  AddModels(rows);
  AddCameras(rows);
}

}  // namespace facetless::extremes
