// A view of a model with parameters, as the inspections use it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "render/inspect/picture.h"
#include "render/trace/direct.h"

namespace facetless::testing {

struct Traced {
  explicit Traced(Model of, const std::string& view = "iso", Projection projection = Projection::kPerspective,
                  int size = 120)
      : model(std::move(of)), scene(model) {
    const Result<Camera> camera = NamedView(view, model.bounds, projection, size, size);
    Trace(camera.value());
  }
  Traced(Model of, const Camera& camera) : model(std::move(of)), scene(model) { Trace(camera); }

  PerSample<double> Values(const std::string& shade) const {
    const Result<Inspection> inspection = ParseInspection(shade);
    Result<PerSample<double>> values =
        InspectionValues(model, &scene, result.samples, result.frame, inspection.value(), {});
    EXPECT_TRUE(values.ok()) << values.error().message;
    return std::move(values).value();
  }
  InspectionView Measured(const std::string& shade) const {
    Result<InspectionView> view =
        Measure(model, &scene, result.samples, result.frame, ParseInspection(shade).value(), {});
    EXPECT_TRUE(view.ok()) << view.error().message;
    return std::move(view).value();
  }
  Film Drawn(const std::string& shade, int threads = 0) const {
    ShadeOptions options;
    options.execution.threads = threads;
    Result<Film> film = Draw(model, &scene, result.samples, result.frame, Measured(shade), options);
    EXPECT_TRUE(film.ok()) << film.error().message;
    return std::move(film).value();
  }
  bool Hit(std::size_t i) const { return std::isfinite(result.samples.depth[i]); }
  std::size_t size() const { return result.samples.size(); }

  Model model;
  Scene scene;
  DirectResult result;

 private:
  void Trace(const Camera& camera) {
    DirectOptions options;
    options.uv = true;
    Result<DirectResult> traced = TraceDirect(scene, camera, options);
    EXPECT_TRUE(traced.ok()) << traced.error().message;
    result = std::move(traced).value();
  }
};

}  // namespace facetless::testing
