// Points that are measured on a ball, whose mesh has a known error.
#include "render/trade/trade_measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/trade/trade_report.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::BallMesh;
using testing::ModelOf;
using testing::Sphere;

constexpr double kRadius = 10;

class TradeOnABall : public ::testing::Test {
 protected:
  TradeOnABall() : model_(ModelOf({Sphere({0, 0, 0}, kRadius)})), scene_(model_) {
    reference_ = MeasureReference(scene_, ViewOf(Projection::kOrthographic), {}).value();
  }
  Camera ViewOf(Projection projection) const {
    return NamedView("iso", model_.bounds, projection, 96, 96).value();
  }
  TradePoint Measured(int longitudes) const {
    const Mesh mesh = BallMesh(kRadius, longitudes);
    const BaselineScene tree = BaselineScene::Build(mesh, {}).value();
    const Triangles triangles(tree, model_, {}, 0);
    TradePoint point = MeasurePoint(triangles, triangles, model_, reference_, MeshSetting{}, {}).value();
    CompleteCosts(point);
    return point;
  }

  Result<TradePoint> MeasureExact(const DirectSetting& setting, const TradeViewOptions& options) const {
    DirectOptions direct;
    direct.accuracy = setting;
    const ExactSurfaces exact(scene_, direct);
    return MeasurePoint(exact, exact, model_, reference_, setting, options);
  }

  Model model_;
  Scene scene_;
  TradeReference reference_;
};

TEST_F(TradeOnABall, ReferenceKnowsItsPixels) {
  EXPECT_EQ(reference_.samples, 16);
  EXPECT_EQ(reference_.view.image.width, 96);
  EXPECT_NEAR(reference_.mm_per_pixel, reference_.camera.height / 96, 1e-12);
  // The outline of a disc has 4·√2 pixels per pixel of its radius if pixels may join at corners.
  const double radius_px = kRadius / reference_.mm_per_pixel;
  EXPECT_NEAR(static_cast<double>(reference_.outline_pixels), 4 * std::numbers::sqrt2 * radius_px, 8);
  // In perspective, the size of a pixel is that at the camera's target.
  const Camera camera = ViewOf(Projection::kPerspective);
  const TradeReference seen = MeasureReference(scene_, camera, {}).value();
  EXPECT_NEAR(
      seen.mm_per_pixel,
      2 * Length(camera.target - camera.eye) * std::tan(camera.fov_y_deg * std::numbers::pi / 360) / 96,
      1e-9);
}

TEST_F(TradeOnABall, CertifiedIsItsOwnReference) {
  TradePoint point = MeasureExact({.precision = Precision::kCertified}, {}).value();
  CompleteCosts(point);
  EXPECT_GT(point.deviation_mm.count, 1000u);
  EXPECT_EQ(point.depth_mm.max, 0);
  EXPECT_EQ(point.silhouette.pixels, 0u);
  EXPECT_EQ(point.flip_mean, 0);
  EXPECT_EQ(point.repetitions, kRepetitions);
  EXPECT_GT(point.total_ms, 0);
  EXPECT_LE(point.fastest_ms, point.total_ms);
  EXPECT_GE(point.slowest_ms, point.total_ms);
  EXPECT_GT(point.leaves, 0u);
  EXPECT_GT(point.peak_bytes, 0u);
}

TEST_F(TradeOnABall, FinerMeshesErrLess) {
  const TradePoint coarse = Measured(24), fine = Measured(96);
  // This is the sagitta of a quad's diagonal at the equator.
  const double sagitta = kRadius * (1 - std::cos(std::numbers::pi / 24 * std::numbers::sqrt2));
  EXPECT_LE(coarse.deviation_mm.p99, 1.1 * sagitta);
  EXPECT_GT(coarse.deviation_mm.p99, 0.5 * sagitta);
  EXPECT_NEAR(fine.deviation_mm.p99 / coarse.deviation_mm.p99, 1.0 / 16, 0.02)
      << "the error must grow with the square";
  EXPECT_LT(fine.flip_mean, coarse.flip_mean);
  EXPECT_LE(fine.silhouette_offset_px, coarse.silhouette_offset_px);
}

TEST_F(TradeOnABall, CostsAddUp) {
  TradePoint point = Measured(24);
  point.mesh_ms = 100;
  point.build_ms = 10;
  point.mesher_peak_bytes = 1'000'000'000;
  CompleteCosts(point);
  EXPECT_EQ(point.model_ms, 110);
  EXPECT_EQ(point.prepare_ms, 110);
  EXPECT_DOUBLE_EQ(point.total_ms, 110 + point.trace_ms + point.shade_ms);
  EXPECT_EQ(point.peak_bytes, 1'000'000'000u) << "the mesher needs more than the tracer";
  const nlohmann::json json = TradePointJson(point, "iso");
  EXPECT_NEAR(json.at("timing_ms").at("next_view"), point.trace_ms + point.shade_ms, 1e-9);
  EXPECT_EQ(json.at("tracer"), "mesh");
}

TEST_F(TradeOnABall, StopsWhenItIsTold) {
  const std::atomic<bool> stop{true};
  const Result<TradePoint> point = MeasureExact({}, {.execution = {}, .budget = &stop});
  ASSERT_FALSE(point.ok());
  EXPECT_EQ(point.error().code, ErrorCode::kCancelled);
}

TEST(PictureSamples, AreFewerWhereThePictureIsLarge) {
  EXPECT_EQ(PictureSamples(1024, 1024), 16);
  EXPECT_EQ(PictureSamples(2048, 2048), 16);
  EXPECT_EQ(PictureSamples(4096, 4096), 4);
  EXPECT_EQ(PictureSamples(65536, 65536), 1);
}

TEST(TradeTable, HasALineForEachPoint) {
  TradeView view;
  view.context = {"top", ErrorMeasure::kP99, 1e-12, 0.5};
  TradePoint skipped;
  skipped.setting = MeshSetting{1e-6, 30};
  skipped.skipped = "meshing takes longer than 60 s";
  view.points = {TradePoint{}, skipped};
  const std::string table = TradeTable(view);
  EXPECT_NE(table.find("view top"), std::string::npos);
  EXPECT_NE(table.find("mesh 1e-6, 30°"), std::string::npos);
  EXPECT_NE(table.find("not measured: meshing takes longer than 60 s"), std::string::npos);
}

}  // namespace
}  // namespace facetless
