// The difference of two views, on samples for which every number is known.
#include "render/compare/difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/compare/difference_picture.h"
#include "render/compare/report.h"
#include "render/image/color_map.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

constexpr int kWidth = 40, kHeight = 30;

// A frame with one millimetre per pixel, looking along +Y.
CameraFrame Frame() {
  Camera camera;
  camera.eye = {0, -100, 0};
  camera.up = {0, 0, 1};
  camera.height = kHeight;
  camera.width_px = kWidth;
  camera.height_px = kHeight;
  return MakeFrame(camera, 1).value();
}

std::size_t At(int x, int y) {
  return static_cast<std::size_t>(y) * kWidth + x;
}

// A plane that is parallel to the image at depth 100, and fills columns 10 to 29 and rows 5 to 24.
SampleBuffer Plate() {
  SampleBuffer samples;
  samples.Resize(kWidth, kHeight);
  for (int y = 5; y < 25; ++y)
    for (int x = 10; x < 30; ++x) {
      samples.depth[At(x, y)] = 100;
      samples.normal[At(x, y)] = {0, -1, 0};
      samples.face[At(x, y)] = 0;
    }
  return samples;
}

Model TwoFaces() {
  Model model = testing::Squares(3);
  model.faces[0].name = "plate";
  model.faces[1].name = "rib";
  model.faces[2].name = "floor";
  return model;
}

Image8 Grey() {
  return {kWidth, kHeight, 3, std::vector<std::uint8_t>(static_cast<std::size_t>(kWidth) * kHeight * 3, 128)};
}

Difference Compare(const SampleBuffer& direct, const SampleBuffer& baseline, bool faces_known = true) {
  const Result<Difference> difference =
      ComputeDifference({direct, baseline, Grey(), Grey(), Frame(), TwoFaces(), faces_known, 1e-6, {}});
  EXPECT_TRUE(difference.ok()) << difference.error().message;
  return difference.value();
}

TEST(Difference, EqualViewsDifferInNothing) {
  const Difference d = Compare(Plate(), Plate());
  EXPECT_EQ(d.both_hit, 400u);
  EXPECT_EQ(d.silhouette.pixels, 0u);
  EXPECT_EQ(d.silhouette.max_distance_px, 0);
  EXPECT_EQ(d.depth_mm.max, 0);
  EXPECT_EQ(d.depth_mm.count, 400u);
  EXPECT_EQ(d.deviation_mm.count, 400u);
  EXPECT_EQ(d.normal_deg.max, 0);
  EXPECT_EQ(d.border_pixels, 0u);
  ASSERT_EQ(d.faces.size(), 1u);
  EXPECT_EQ(d.faces[0].pixels, 400u);
  EXPECT_NE(d.faces[0].name.find("plate"), std::string::npos);
}

TEST(Difference, DepthIsSignedAndPercentilesAreValuesThatOccur) {
  SampleBuffer baseline = Plate();
  // 400 pixels: 396 are 0.1 nearer, three 0.3 farther, one 0.5 farther.
  int changed = 0;
  for (double& depth : baseline.depth)
    if (std::isfinite(depth)) depth += ++changed <= 396 ? -0.1 : changed <= 399 ? 0.3 : 0.5;
  const Difference d = Compare(Plate(), baseline);
  EXPECT_NEAR(d.depth_mm.mean, (-39.6 + 0.9 + 0.5) / 400, 1e-12);
  EXPECT_NEAR(d.depth_mm.mean_abs, (39.6 + 0.9 + 0.5) / 400, 1e-12);
  EXPECT_NEAR(d.depth_mm.rms, std::sqrt((396 * 0.01 + 3 * 0.09 + 0.25) / 400), 1e-12);
  EXPECT_NEAR(d.depth_mm.p50, 0.1, 1e-12);
  EXPECT_NEAR(d.depth_mm.p99, 0.1, 1e-12) << "396 of 400 are 99 %";
  EXPECT_NEAR(d.depth_mm.max, 0.5, 1e-12);
  EXPECT_EQ(d.depth_mm.max_x, 29);
  EXPECT_EQ(d.depth_mm.max_y, 24);
  // The plate is parallel to the image, so the distance between the surfaces is the difference in depth.
  EXPECT_NEAR(d.deviation_mm.max, 0.5, 1e-12);
}

TEST(Difference, DeviationIsTheDistanceBetweenThePlanes) {
  // Two parallel planes turned by 60 degrees, 0.2 mm apart along the view: 0.1 mm apart.
  SampleBuffer direct = Plate(), baseline = Plate();
  for (int y = 5; y < 25; ++y)
    for (int x = 10; x < 30; ++x) {
      direct.depth[At(x, y)] = 100 + std::sqrt(3.0) * x;
      baseline.depth[At(x, y)] = direct.depth[At(x, y)] + 0.2;
      direct.normal[At(x, y)] = baseline.normal[At(x, y)] = {static_cast<float>(-std::sqrt(0.75)), -0.5f, 0};
    }
  const Difference d = Compare(direct, baseline);
  EXPECT_NEAR(d.depth_mm.p50, 0.2, 1e-9);
  EXPECT_NEAR(d.deviation_mm.p50, 0.1, 1e-7);
  EXPECT_NEAR(d.deviation_mm.max, 0.1, 1e-7);
}

TEST(Difference, NormalsAreComparedInDegrees) {
  SampleBuffer baseline = Plate();
  for (auto& n : baseline.normal)
    if (n[1] != 0) n = {0.5f, static_cast<float>(-std::sqrt(0.75)), 0};
  EXPECT_NEAR(Compare(Plate(), baseline).normal_deg.max, 30, 1e-5);
  EXPECT_NEAR(Compare(Plate(), baseline).normal_deg.p95, 30, 1e-5);
  // Opposite normals count as an error in our own mesh, but not in a foreign mesh.
  for (auto& n : baseline.normal) n = {-n[0], -n[1], -n[2]};
  EXPECT_NEAR(Compare(Plate(), baseline, true).normal_deg.max, 150, 1e-5);
  EXPECT_NEAR(Compare(Plate(), baseline, false).normal_deg.max, 30, 1e-5);
}

TEST(Difference, SilhouettesCountBothWaysAndMeasureHowFar) {
  SampleBuffer baseline = Plate();
  for (int y = 5; y < 25; ++y)
    for (int x : {10, 11, 12}) baseline.depth[At(x, y)] = INFINITY;  // three columns are missing
  baseline.depth[At(35, 10)] = 100;                                  // and one pixel is added
  baseline.normal[At(35, 10)] = {0, -1, 0};
  const Difference d = Compare(Plate(), baseline);
  EXPECT_EQ(d.silhouette.only_direct, 60u);
  EXPECT_EQ(d.silhouette.only_baseline, 1u);
  EXPECT_EQ(d.silhouette.pixels, 61u);
  EXPECT_EQ(d.silhouette.max_distance_px, 6) << "from column 35 to column 29";
  EXPECT_EQ(d.faces[0].missed_pixels, 60u);
  EXPECT_EQ(d.both_hit, 340u);
  // In one of the two views, nothing is hit.
  SampleBuffer nothing;
  nothing.Resize(kWidth, kHeight);
  const Difference empty = Compare(Plate(), nothing);
  EXPECT_EQ(empty.silhouette.pixels, 400u);
  EXPECT_TRUE(std::isinf(empty.silhouette.max_distance_px));
  EXPECT_EQ(empty.depth_mm.count, 0u);
}

// Returns the plate with a rib 20 mm in front of it, in the columns from first to last.
SampleBuffer WithRib(int first, int last) {
  SampleBuffer samples = Plate();
  for (int y = 5; y < 25; ++y)
    for (int x = first; x <= last; ++x) {
      samples.depth[At(x, y)] = 80;
      samples.face[At(x, y)] = 1;
    }
  return samples;
}

TEST(Difference, APixelBesideAnEdgeIsABorderPixel) {
  // The mesh's rib is one column narrower. In that column the plate behind it is visible, 20 mm farther away.
  for (bool faces_known : {true, false}) {
    const Difference d = Compare(WithRib(15, 20), WithRib(15, 19), faces_known);
    EXPECT_EQ(d.border_pixels, 20u) << faces_known;
    EXPECT_NEAR(d.border_share, 0.05, 1e-12);
    EXPECT_EQ(d.depth_mm.max, 20) << "the view's depth counts it";
    EXPECT_EQ(d.deviation_mm.max, 0) << "and the distance between surfaces does not";
    EXPECT_EQ(d.other_face_pixels, faces_known ? 20u : 0u);
    EXPECT_EQ(d.faces_known, faces_known);
  }
}

TEST(Difference, AMissingFaceIsNoBorder) {
  // The mesh has no rib at all. All of the rib counts except its rim, and it is the worst face.
  const Difference d = Compare(WithRib(15, 20), Plate());
  EXPECT_EQ(d.other_face_pixels, 120u);
  EXPECT_EQ(d.border_pixels, 40u) << "a column on each side";
  EXPECT_EQ(d.deviation_mm.max, 20);
  ASSERT_EQ(d.faces.size(), 2u);
  EXPECT_EQ(d.faces[0].id, 1u);
  EXPECT_NE(d.faces[0].name.find("rib"), std::string::npos);
  EXPECT_EQ(d.faces[0].other_face_pixels, 120u);
  EXPECT_EQ(d.faces[0].depth_mm_max, 20);
  EXPECT_EQ(d.faces[1].depth_mm_max, 0);
}

TEST(Difference, AShiftOfTwoPixelsIsNoBorder) {
  const Difference d = Compare(WithRib(15, 22), WithRib(15, 19));
  EXPECT_EQ(d.other_face_pixels, 60u);
  EXPECT_EQ(d.border_pixels, 40u) << "the columns beside either edge";
  EXPECT_EQ(d.deviation_mm.max, 20) << "the column between them counts";
}

TEST(Difference, ANanFailsAndSizesComeFirst) {
  const auto code = [](const SampleBuffer& a, const SampleBuffer& b) {
    const Result<Difference> d = ComputeDifference({a, b, Grey(), Grey(), Frame(), TwoFaces(), true, 0, {}});
    EXPECT_FALSE(d.ok());
    return d.ok() ? ErrorCode::kInternal : d.error().code;
  };
  SampleBuffer bad = Plate();
  bad.depth[At(15, 7)] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(Plate(), bad), ErrorCode::kNotFinite);
  EXPECT_EQ(code(bad, Plate()), ErrorCode::kNotFinite);
  bad = Plate();
  bad.normal[At(15, 7)][2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code(Plate(), bad), ErrorCode::kNotFinite);
  SampleBuffer small;
  small.Resize(3, 3);
  small.depth[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(Plate(), small), ErrorCode::kSizeMismatch);
}

TEST(ColorMap, RunsFromBlueOverWhiteToRedInEvenSteps) {
  const auto lightness = [](std::array<std::uint8_t, 3> c) {
    const double y = 0.2126 * SrgbToLinear(c[0] / 255.0) + 0.7152 * SrgbToLinear(c[1] / 255.0) +
                     0.0722 * SrgbToLinear(c[2] / 255.0);
    return 116 * std::cbrt(y) - 16;
  };
  const auto middle = DivergingColor(0), blue = DivergingColor(-1), red = DivergingColor(1);
  EXPECT_GT(lightness(middle), 95);
  EXPECT_GT(blue[2], blue[0] + 80);
  EXPECT_GT(red[0], red[2] + 80);
  EXPECT_EQ(DivergingColor(5), red);
  for (int i = 1; i <= 100; ++i) {
    const double t = i / 100.0;
    EXPECT_LT(lightness(DivergingColor(t)), lightness(DivergingColor(t - 0.01)) + 0.4);
    EXPECT_NEAR(lightness(DivergingColor(t)), lightness(DivergingColor(-t)), 7)
        << "both signs weigh the same";
  }
}

TEST(DifferencePicture, ShowsSignsAndWhatOnlyOneHits) {
  SampleBuffer baseline = Plate();
  baseline.depth[At(15, 10)] = 100.5;
  baseline.depth[At(20, 10)] = 99.5;
  baseline.depth[At(12, 15)] = INFINITY;
  baseline.depth[At(35, 15)] = 100;
  baseline.normal[At(35, 15)] = {0, -1, 0};
  const Difference d = Compare(Plate(), baseline);
  DifferencePictureOptions options;
  options.range_mm = 0.5;
  const Result<DifferencePicture> picture = DrawDifference(Plate(), baseline, Frame(), d, options);
  ASSERT_TRUE(picture.ok()) << picture.error().message;
  const Image8& image = picture.value().image;
  EXPECT_EQ(image.width, kWidth);
  EXPECT_EQ(image.height, kHeight + picture.value().legend_height);
  const auto color = [&](int x, int y) {
    return std::array<int, 3>{image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]};
  };
  EXPECT_GT(color(15, 10)[0], color(15, 10)[2] + 80) << "farther: red";
  EXPECT_GT(color(20, 10)[2], color(20, 10)[0] + 80) << "nearer: blue";
  EXPECT_GT(color(25, 20)[1], 235) << "equal: near white";
  EXPECT_LT(color(12, 15)[1], 60) << "only the surface: black";
  EXPECT_GT(color(35, 15)[0], color(35, 15)[2] + 150) << "only the mesh: yellow";
  EXPECT_NE(color(0, 0), color(25, 20)) << "the background is not the colour of zero";
}

TEST(DifferencePicture, TheRangeIsRobustAndRound) {
  SampleBuffer baseline = Plate();
  for (double& depth : baseline.depth) depth += 0.013;
  baseline.depth[At(15, 10)] = 1000;  // one of 400 is far off
  EXPECT_DOUBLE_EQ(
      DrawDifference(Plate(), baseline, Frame(), Compare(Plate(), baseline), {}).value().range_mm, 0.02);
  // For equal views the range is the noise of the mesh's positions, rounded up.
  EXPECT_DOUBLE_EQ(DrawDifference(Plate(), Plate(), Frame(), Compare(Plate(), Plate()), {}).value().range_mm,
                   1e-6);
  DifferencePictureOptions bad;
  bad.range_mm = NAN;
  EXPECT_EQ(DrawDifference(Plate(), Plate(), Frame(), Compare(Plate(), Plate()), bad).error().code,
            ErrorCode::kBadUsage);
}

TEST(Report, WritesNullForWhatDoesNotExist) {
  SampleBuffer nothing;
  nothing.Resize(kWidth, kHeight);
  const nlohmann::json json = DifferenceJson(Compare(Plate(), nothing), {});
  EXPECT_TRUE(json["color"]["psnr"].is_null()) << "equal pictures";
  EXPECT_TRUE(json["silhouette"]["max_distance_px"].is_null());
  EXPECT_TRUE(json["depth_mm"]["max_at"].is_null());
  EXPECT_EQ(json["silhouette"]["pixels"], 400);
  for (const char* key :
       {"max", "mean", "rms", "psnr", "ssim", "flip_mean", "flip_p95", "share_over_threshold"})
    EXPECT_TRUE(json["color"].contains(key)) << key;
  for (const char* spread : {"depth_mm", "deviation_mm"})
    for (const char* key : {"mean", "p50", "p95", "p99", "max"})
      EXPECT_TRUE(json[spread].contains(key)) << key;
  for (const char* key : {"mean", "p95", "max"}) EXPECT_TRUE(json["normal_deg"].contains(key)) << key;
  for (const char* key : {"id", "name", "depth_mm_max", "pixels"})
    EXPECT_TRUE(json["faces"][0].contains(key)) << key;
  EXPECT_TRUE(json.contains("noise_mm"));
}

TEST(Report, ListsOfFacesEndAndSayHowManyThereAre) {
  Difference difference;
  difference.faces.resize(kMostListedFaces + 5);
  const nlohmann::json json = DifferenceJson(difference, {});
  EXPECT_EQ(json["faces"].size(), kMostListedFaces);
  EXPECT_EQ(json["face_count"], kMostListedFaces + 5);
  View view;
  view.direct.emplace();
  view.direct->unseen_faces.resize(kMostListedFaces + 7);
  view.unseen_names.resize(kMostListedFaces + 7);
  const nlohmann::json direct = DirectJson(view);
  EXPECT_EQ(direct["unseen_faces"].size(), kMostListedFaces);
  EXPECT_EQ(direct["unseen_face_count"], kMostListedFaces + 7);
}

TEST(Report, TheCameraHasTheNumbersOfItsProjection) {
  Camera camera;
  camera.height = 12.5;
  nlohmann::json json = CameraJson(camera);
  EXPECT_EQ(json["projection"], "orthographic");
  EXPECT_EQ(json["height"], 12.5);
  EXPECT_FALSE(json.contains("fov_y_deg"));
  camera.projection = Projection::kPerspective;
  json = CameraJson(camera);
  EXPECT_EQ(json["projection"], "perspective");
  EXPECT_EQ(json["fov_y_deg"], 40);
  EXPECT_FALSE(json.contains("height"));
  EXPECT_EQ(json["width"], 512);
  EXPECT_EQ(json["height_px"], 512);
}

}  // namespace
}  // namespace facetless
