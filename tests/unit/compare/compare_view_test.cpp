// One view from model and mesh to report: a sphere and its tessellation, for which everything has a closed
// form.
#include "render/compare/compare_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>

#include "render/compare/report.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::BallMesh;
using testing::ModelOf;
using testing::Sphere;

constexpr double kRadius = 10;

Mesh MeshOf(int longitudes, bool from_model) {
  Mesh mesh = BallMesh(kRadius, longitudes);
  mesh.from_model = from_model;
  return mesh;
}

// Returns the largest distance of a facet to the sphere: at the diagonal of an equatorial quad.
double Sagitta(int longitudes) {
  return kRadius * (1 - std::cos(std::numbers::pi / longitudes * std::numbers::sqrt2));
}

class SphereView : public ::testing::Test {
 protected:
  SphereView() : model_(ModelOf({Sphere({0, 0, 0}, kRadius)})), scene_(model_) {
    model_.faces[0].name = "ball";
    model_.faces[0].has_color = true;
    model_.faces[0].color = {0.8f, 0.3f, 0.2f};
  }

  // The exact surfaces, and the one mesh with which they are compared.
  struct Compared {
    Camera camera;
    View direct, baseline;
    Difference difference;
  };

  Compared Compare(const Mesh& mesh, const ViewOptions& options = {}, int size = 128) {
    const Result<BaselineScene> baseline = BaselineScene::Build(mesh, {});
    const Result<Camera> camera = NamedView("iso", model_.bounds, Projection::kPerspective, size, size);
    const Triangles triangles(baseline.value(), model_, {}, 0);
    const Representation* candidates[] = {&triangles};
    Result<ViewComparison> made = CompareView(exact_, candidates, model_, camera.value(), options);
    EXPECT_TRUE(made.ok()) << made.error().message;
    json_ = ComparisonJson(made.value(), &baseline.value());
    ViewComparison& comparison = made.value();
    CandidateView& candidate = comparison.candidates.front();
    return {comparison.camera, std::move(comparison.reference), std::move(candidate.view),
            std::move(candidate.difference)};
  }

  Model model_;
  Scene scene_;
  const ExactSurfaces exact_{scene_, {}};
  nlohmann::json json_;
};

TEST_F(SphereView, DeviationIsTheSagittaAndShrinksWithItsSquare) {
  double last = 0;
  for (int longitudes : {32, 64, 128}) {
    const Compared c = Compare(MeshOf(longitudes, true));
    const double sagitta = Sagitta(longitudes), typical = c.difference.deviation_mm.p99;
    EXPECT_LE(typical, sagitta) << longitudes;
    EXPECT_GE(typical, 0.8 * sagitta) << longitudes;
    // N·D| times the difference along the ray is the distance to first order. At the rim, where the sphere curves away from the
    // ray, it is too large.
    EXPECT_LE(c.difference.deviation_mm.max, 1.5 * sagitta) << longitudes;
    EXPECT_GT(c.difference.depth_mm.mean, 0) << "an inscribed mesh lies farther from the eye";
    if (last > 0) {
      EXPECT_NEAR(last / typical, 4, 0.3);
    }
    last = typical;
    EXPECT_LT(c.difference.silhouette.max_distance_px, 2);
    EXPECT_EQ(c.difference.faces.size(), 1u);
    EXPECT_NE(c.difference.faces[0].name.find("ball"), std::string::npos);
  }
}

TEST_F(SphereView, BothTracersShadeAlike) {
  const Compared c = Compare(MeshOf(512, true));
  EXPECT_GT(c.difference.color.ssim, 0.99);
  EXPECT_LT(c.difference.color.flip_mean, 0.01);
  EXPECT_LT(c.difference.normal_deg.p95, 0.2);
  // Both pictures must show the face's colour.
  for (const Image8* image : {&c.direct.image, &c.baseline.image}) {
    const std::uint8_t* middle = image->at(64, 64);
    EXPECT_GT(middle[0], middle[2] + 40);
  }
}

TEST_F(SphereView, AnInspectionShowsOnBothAndChangesNoMillimetre) {
  const Mesh mesh = MeshOf(64, true);
  ViewOptions options;
  const Compared studio = Compare(mesh, options);
  options.samples = 4;
  options.inspection = ParseInspection("zebra").value();
  const Compared zebra = Compare(mesh, options);
  EXPECT_EQ(zebra.difference.deviation_mm.max, studio.difference.deviation_mm.max);
  EXPECT_EQ(zebra.difference.silhouette.pixels, studio.difference.silhouette.pixels);
  EXPECT_NE(zebra.direct.image.bytes, studio.direct.image.bytes);
  EXPECT_NE(zebra.baseline.image.bytes, studio.baseline.image.bytes);
  EXPECT_GT(zebra.difference.color.ssim, 0.7) << "the same stripes";
  EXPECT_TRUE(zebra.direct.inspection && zebra.baseline.inspection);
  EXPECT_FALSE(studio.direct.inspection || studio.baseline.inspection);
}

TEST_F(SphereView, WhatNoMeshCanShowIsRefused) {
  const Mesh own = MeshOf(32, true), foreign = MeshOf(32, false);
  const Camera camera = NamedView("iso", model_.bounds, Projection::kPerspective, 32, 32).value();
  const auto refused = [&](const Mesh& mesh, const char* shade) {
    const Result<BaselineScene> baseline = BaselineScene::Build(mesh, {});
    ViewOptions options;
    options.inspection = ParseInspection(shade).value();
    const Triangles triangles(baseline.value(), model_, {}, 0);
    const Representation* candidates[] = {&triangles};
    const auto compared = CompareView(exact_, candidates, model_, camera, options);
    return !compared.ok() && compared.error().code == ErrorCode::kBadUsage;
  };
  EXPECT_TRUE(refused(own, "curvature"));
  EXPECT_TRUE(refused(own, "thickness"));
  EXPECT_FALSE(refused(own, "faces"));
  EXPECT_TRUE(refused(foreign, "faces"));
  EXPECT_FALSE(refused(foreign, "draft"));
}

TEST_F(SphereView, CurvatureIsMeasuredAtPixelCentresAndDrawnSupersampled) {
  const Camera camera = NamedView("iso", model_.bounds, Projection::kPerspective, 64, 64).value();
  ViewOptions options;
  options.inspection = ParseInspection("curvature:kind=gaussian").value();
  const Result<View> plain = RenderView(exact_, model_, camera, options);
  options.samples = 4;
  const Result<View> smooth = RenderView(exact_, model_, camera, options);
  ASSERT_TRUE(plain.ok() && smooth.ok());
  EXPECT_EQ(plain.value().inspection->values, smooth.value().inspection->values);
  EXPECT_EQ(plain.value().inspection->range.high, smooth.value().inspection->range.high);
  EXPECT_NEAR(plain.value().inspection->statistics.p50, 1 / (kRadius * kRadius), 1e-11);
  EXPECT_NE(plain.value().image.bytes, smooth.value().image.bytes);
}

TEST_F(SphereView, AForeignMeshBorrowsTheColours) {
  const Compared own = Compare(MeshOf(256, true)), foreign = Compare(MeshOf(256, false));
  EXPECT_EQ(own.baseline.image.bytes, foreign.baseline.image.bytes);
  EXPECT_FALSE(foreign.difference.faces_known);
  EXPECT_TRUE(json_["difference"]["other_face"].is_null());
}

TEST_F(SphereView, SupersamplingChangesTheColourAndNothingElse) {
  ViewOptions options;
  const Mesh mesh = MeshOf(64, true);
  const Compared plain = Compare(mesh, options);
  options.samples = 6;
  const Compared smooth = Compare(mesh, options);
  EXPECT_EQ(plain.direct.samples.depth, smooth.direct.samples.depth);
  EXPECT_EQ(plain.baseline.samples.depth, smooth.baseline.samples.depth);
  EXPECT_NE(plain.direct.image.bytes, smooth.direct.image.bytes);
  EXPECT_EQ(smooth.direct.image.width, 128);
  EXPECT_EQ(smooth.direct.image.height, 128);
  EXPECT_EQ(smooth.direct.grid.x, 3);
  EXPECT_EQ(smooth.direct.grid.y, 2);
  EXPECT_EQ(plain.direct.color_ms, 0);
  EXPECT_GT(smooth.direct.color_ms, 0);
  EXPECT_GT(smooth.direct.peak_bytes, plain.direct.peak_bytes);
}

// The largest difference of two pictures, in levels.
int LargestDifference(const Image8& a, const Image8& b) {
  EXPECT_EQ(a.bytes.size(), b.bytes.size());
  int largest = 0;
  for (std::size_t i = 0; i < a.bytes.size(); ++i)
    largest = std::max(largest, std::abs(a.bytes[i] - b.bytes[i]));
  return largest;
}

TEST_F(SphereView, AdaptiveSamplesShowWhatUniformOnesShow) {
  for (const bool own : {true, false}) {
    const Mesh mesh = MeshOf(48, own);
    for (const int samples : {2, 4, 6, 9, 16}) {
      ViewOptions options;
      options.samples = samples;
      const Compared adaptive = Compare(mesh, options, 96);
      options.uniform_samples = true;
      const Compared uniform = Compare(mesh, options, 96);
      for (const auto& [some, all] :
           {std::pair{&adaptive.direct, &uniform.direct}, {&adaptive.baseline, &uniform.baseline}}) {
        EXPECT_LE(LargestDifference(some->image, all->image), 3) << samples << " samples, own mesh " << own;
        ASSERT_TRUE(some->refined_pixels);
        EXPECT_GT(*some->refined_pixels, 96u);
        EXPECT_LT(*some->refined_pixels, 96u * 96 / 3);
        EXPECT_FALSE(all->refined_pixels);
      }
      EXPECT_EQ(adaptive.difference.depth_mm.max, uniform.difference.depth_mm.max);
      EXPECT_NEAR(adaptive.difference.color.flip_mean, uniform.difference.color.flip_mean, 1e-3);
    }
  }
}

TEST_F(SphereView, WhatNeedsAllSamplesIsSampledUniformly) {
  const Camera camera = NamedView("iso", model_.bounds, Projection::kPerspective, 64, 64).value();
  const auto is_uniform = [&](const std::function<void(ViewOptions*)>& change) {
    ViewOptions options;
    options.samples = 4;
    change(&options);
    const Result<View> view = RenderView(exact_, model_, camera, options);
    EXPECT_TRUE(view.ok());
    return view.ok() && !view.value().refined_pixels;
  };
  EXPECT_FALSE(is_uniform([](ViewOptions*) {}));
  EXPECT_TRUE(is_uniform([](ViewOptions* o) { o->uniform_samples = true; }));
  EXPECT_TRUE(is_uniform([](ViewOptions* o) { o->edges = true; }));
  EXPECT_TRUE(is_uniform([](ViewOptions* o) { o->lines = LineMode::kVisible; }));
  EXPECT_TRUE(is_uniform([](ViewOptions* o) { o->find_lines = true; }));
  EXPECT_TRUE(is_uniform([](ViewOptions* o) { o->inspection = ParseInspection("zebra").value(); }));
  EXPECT_TRUE(is_uniform([](ViewOptions* o) { o->samples = 1; }));
  model_.faces[0].color.a = 0.5f;
  EXPECT_TRUE(is_uniform([](ViewOptions*) {}));
}

TEST_F(SphereView, TheDirectImageIsTheSameAloneAndWithAnyNumberOfThreads) {
  ViewOptions options;
  options.samples = 4;
  options.edges = true;
  const Compared compared = Compare(MeshOf(64, true), options);
  for (int threads : {1, 5}) {
    options.execution.threads = threads;
    const Result<View> alone = RenderView(exact_, model_, compared.camera, options);
    ASSERT_TRUE(alone.ok());
    EXPECT_EQ(alone.value().image.bytes, compared.direct.image.bytes);
  }
}

TEST_F(SphereView, TimesAreDisjointAndAddUp) {
  ViewOptions options;
  options.samples = 4;
  const Compared c = Compare(MeshOf(64, true), options);
  EXPECT_LE(c.direct.counters.prepare_ms + c.direct.counters.trace_ms + c.direct.color_ms + c.direct.shade_ms,
            c.direct.total_ms);
  EXPECT_LE(c.baseline.counters.trace_ms + c.baseline.color_ms + c.baseline.shade_ms, c.baseline.total_ms);
  EXPECT_GT(c.direct.shade_ms, 0);
}

TEST_F(SphereView, TheReportHasEveryPromisedName) {
  Compare(MeshOf(64, true));
  const auto has = [](const nlohmann::json& object, std::initializer_list<const char*> keys) {
    for (const char* key : keys) EXPECT_TRUE(object.contains(key)) << key;
  };
  has(json_, {"name", "camera", "direct", "baseline", "difference"});
  has(json_["camera"], {"eye", "target", "up", "projection", "fov_y_deg", "width", "height_px"});
  has(json_["direct"],
      {"timing_ms", "rays", "hits", "leaves", "solves", "iterations", "certified", "converged", "unresolved",
       "certified_hits", "odd_rays", "reverse_mismatches", "unseen_faces", "bmssm", "peak_bytes"});
  has(json_["direct"]["timing_ms"], {"prepare", "trace", "shade", "total"});
  has(json_["direct"]["bmssm"], {"bits", "bytes"});
  has(json_["baseline"],
      {"triangles", "deflection_mm", "angular_deg", "faces_unmeshed", "timing_ms", "peak_bytes"});
  has(json_["baseline"]["timing_ms"], {"mesh", "build", "trace", "shade", "total"});
  const nlohmann::json& direct = json_["direct"];
  EXPECT_EQ(direct["certified"].get<int>() + direct["converged"].get<int>() + direct["unresolved"].get<int>(),
            128 * 128);
  has(ModelJson(model_),
      {"file", "sha256", "format", "unit", "diagonal_mm", "bounds_mm", "solids", "faces", "faces_skipped",
       "loops_lost", "faces_approximated", "surfaces", "patches", "import_ms", "import_peak_bytes"});
  EXPECT_EQ(ModelJson(model_)["surfaces"]["sphere"], 1);
}

TEST(Report, ListsTheEdgesThatTheFileLeavesOpen) {
  Model model = testing::LooseBox({10, 8, 6}, 0.05, 1);
  EXPECT_EQ(ModelJson(model)["open_edges"]["count"], 0);
  for (Edge& edge : model.edges) edge.tolerance_mm = 0.01;
  model.faces[0].entity = "#12";
  const nlohmann::json open = ModelJson(model)["open_edges"];
  EXPECT_EQ(open["count"], 12);
  ASSERT_EQ(open["worst"].size(), 12u);
  const nlohmann::json& first = open["worst"][0];
  EXPECT_EQ(first["cause"], "gap");
  EXPECT_EQ(first["faces"].size(), 2u);
  EXPECT_EQ(first["gap_mm"], 0.05);
  EXPECT_EQ(first["tolerance_mm"], 0.01);
  EXPECT_EQ(first["at"].size(), 3u);
  EXPECT_EQ(open["worst"][0]["faces"][0]["entity"], "#12");
}

TEST_F(SphereView, RefusesBadOptionsAndCanBeCancelled) {
  const Camera camera = NamedView("iso", model_.bounds, Projection::kOrthographic, 16, 16).value();
  ViewOptions options;
  options.samples = 0;
  EXPECT_EQ(RenderView(exact_, model_, camera, options).error().code, ErrorCode::kBadUsage);
  options.samples = 65;
  EXPECT_EQ(RenderView(exact_, model_, camera, options).error().code, ErrorCode::kBadUsage);
  options = {};
  options.execution.threads = -1;
  EXPECT_EQ(RenderView(exact_, model_, camera, options).error().code, ErrorCode::kBadUsage);
  options = {};
  const std::atomic<bool> cancel{true};
  options.execution.cancel = &cancel;
  EXPECT_EQ(RenderView(exact_, model_, camera, options).error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace facetless
