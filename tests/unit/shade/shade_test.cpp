// Shading: what it depends on, where its lines run, and that it is the same on every machine.
#include "render/shade/shade.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>

#include "render/shade/studio.h"

namespace facetless {
namespace {

constexpr Color kGrey{0.7f, 0.7f, 0.7f};

Camera FrontCamera(int width, int height) {
  Camera camera;
  camera.eye = {0, -10, 0};
  camera.up = {0, 0, 1};
  camera.height = height;  // one millimetre per pixel
  camera.width_px = width;
  camera.height_px = height;
  return camera;
}

// Samples of a plane at depth 10 that is parallel to the image, seen by FrontCamera.
SampleBuffer FacingPlane(int width, int height) {
  SampleBuffer samples;
  samples.Resize(width, height);
  std::fill(samples.depth.begin(), samples.depth.end(), 10);
  std::fill(samples.normal.begin(), samples.normal.end(), std::array<float, 3>{0, -1, 0});
  std::fill(samples.face.begin(), samples.face.end(), 0u);
  return samples;
}

Film Shaded(const SampleBuffer& samples, const ShadeOptions& options = {},
            std::vector<Color> colors = {kGrey, kGrey}) {
  const CameraFrame frame = MakeFrame(FrontCamera(samples.width, samples.height), 1).value();
  const Result<Film> film = Shade(samples, frame, colors, options);
  EXPECT_TRUE(film.ok()) << film.error().message;
  return film.value();
}

// Returns the columns of row `y` in which `options`, with edges, change the picture.
std::vector<int> LineColumns(const SampleBuffer& samples, ShadeOptions options, int y) {
  options.edges = true;
  const Film with = Shaded(samples, options);
  options.edges = false;
  const Film without = Shaded(samples, options);
  std::vector<int> columns;
  for (int x = 0; x < samples.width; ++x) {
    const std::size_t i = static_cast<std::size_t>(y) * samples.width + x;
    if (with.pixels[i] != without.pixels[i]) columns.push_back(x);
    EXPECT_LE(with.pixels[i][1], without.pixels[i][1]) << "lines are dark";
  }
  return columns;
}

TEST(Studio, LightStaysBetweenBlackAndWhite) {
  EXPECT_TRUE(rc::check("any normal, view and colour", [] {
    const auto number = [] { return *rc::gen::inRange(-100, 101) / 100.0; };
    Vec3 normal = Normalized({number(), number(), number() + 1e-3});
    const Vec3 view = Normalized({number() / 3, number() / 3, 1});
    if (Dot(normal, view) < 0) normal = -normal;
    const auto share = [] { return *rc::gen::inRange(0, 101) / 100.0; };
    const Vec3 light = StudioView(view).Light(normal, {share(), share(), share()});
    for (double channel : {light.x, light.y, light.z}) RC_ASSERT(channel >= 0 && channel <= 1);
  }));
}

TEST(Studio, TheKeyIsAboveLeftAndWarmTheFillIsCool) {
  const Vec3 view{0, 0, 1}, white{1, 1, 1};
  const auto sum = [](Vec3 v) { return v.x + v.y + v.z; };
  const Vec3 lit = StudioView(view).Light(Normalized({-1, 1, 1}), 0.5 * white);
  const Vec3 shaded = StudioView(view).Light(Normalized({1, -1, 1}), 0.5 * white);
  EXPECT_GT(sum(lit), 1.5 * sum(shaded));
  EXPECT_GT(lit.x, lit.z);
  EXPECT_LT(shaded.x, shaded.z);
}

TEST(Studio, ShadingIsContinuous) {
  // Normals that differ by a tenth of a degree must differ in colour by less than the eye sees.
  const Vec3 view{0, 0, 1};
  Vec3 last = StudioView(view).Light({-1, 0, 0}, {0.45, 0.45, 0.45});
  for (int i = 1; i <= 1800; ++i) {
    const double angle = 3.14159265358979 * (1 - i / 1800.0);
    const Vec3 light =
        StudioView(view).Light({std::cos(angle), 0, std::fabs(std::sin(angle))}, {0.45, 0.45, 0.45});
    EXPECT_LT(std::fabs(light.y - last.y), 0.008) << i;
    last = light;
  }
}

TEST(Shade, DependsOnlyOnNormalViewAndFace) {
  // In an orthographic view, the same sample has the same colour at any place and at any depth.
  SampleBuffer samples = FacingPlane(4, 1);
  for (std::size_t i = 0; i < 4; ++i) samples.normal[i] = {0.6f, -0.8f, 0};
  samples.depth = {10, 1e6, -5, 3};
  const Film film = Shaded(samples);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(film.pixels[i], film.pixels[0]);
}

TEST(Shade, NormalsAreFlippedToTheViewer) {
  SampleBuffer samples = FacingPlane(2, 1);
  samples.normal[0] = {0.6f, -0.8f, 0};
  samples.normal[1] = {-0.6f, 0.8f, 0};
  const Film film = Shaded(samples);
  EXPECT_EQ(film.pixels[0], film.pixels[1]);
}

TEST(Shade, EveryFaceHasItsColourAndUnknownFacesTheFallback) {
  SampleBuffer samples = FacingPlane(3, 1);
  samples.face = {0, 1, 77};
  ShadeOptions options;
  options.fallback = {0, 0, 1};
  const Film film = Shaded(samples, options, {Color{1, 0, 0}, Color{0, 1, 0}});
  EXPECT_GT(film.pixels[0][0], 3 * film.pixels[0][1]);
  EXPECT_GT(film.pixels[1][1], 3 * film.pixels[1][0]);
  EXPECT_GT(film.pixels[2][2], 3 * film.pixels[2][0]);
}

TEST(Shade, BackgroundIsEvenOrTransparent) {
  SampleBuffer samples;
  samples.Resize(5, 4);
  const Film studio = Shaded(samples);
  for (const auto& pixel : studio.pixels) {
    EXPECT_EQ(pixel, studio.pixels[0]);
    EXPECT_EQ(pixel[3], 1);
    EXPECT_GT(pixel[0], 0.8f);
  }
  ShadeOptions options;
  options.background = Background::kTransparent;
  for (const auto& pixel : Shaded(samples, options).pixels)
    EXPECT_EQ(pixel, (std::array<float, 4>{0, 0, 0, 0}));
}

TEST(Shade, RefusesWhatIsNoNumber) {
  const CameraFrame frame = MakeFrame(FrontCamera(4, 4), 1).value();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto code = [&](const auto& change) {
    SampleBuffer samples = FacingPlane(4, 4);
    change(samples);
    const Result<Film> film = Shade(samples, frame, {}, {});
    EXPECT_FALSE(film.ok());
    return film.ok() ? ErrorCode::kInternal : film.error().code;
  };
  EXPECT_EQ(code([&](SampleBuffer& s) { s.depth[6] = nan; }), ErrorCode::kNotFinite);
  EXPECT_EQ(code([&](SampleBuffer& s) { s.depth[6] = -INFINITY; }), ErrorCode::kNotFinite);
  EXPECT_EQ(code([&](SampleBuffer& s) { s.normal[6][1] = static_cast<float>(nan); }), ErrorCode::kNotFinite);
  EXPECT_EQ(code([&](SampleBuffer& s) { s.normal.pop_back(); }), ErrorCode::kSizeMismatch);
  SampleBuffer samples = FacingPlane(4, 4);
  samples.depth[6] = nan;
  EXPECT_NE(Shade(samples, frame, {}, {}).error().message.find("(2, 1)"), std::string::npos)
      << "the message must name the pixel";
  ShadeOptions bad;
  bad.edge_angle_deg = nan;
  EXPECT_EQ(Shade(FacingPlane(4, 4), frame, {}, bad).error().code, ErrorCode::kBadUsage);
}

TEST(Shade, ThreadsDoNotChangeAByte) {
  SampleBuffer samples = FacingPlane(64, 48);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 n = Normalized({std::sin(i * 0.1), -1.2, std::cos(i * 0.07)});
    samples.normal[i] = {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
    samples.face[i] = i % 2;
    if (i % 5 == 0) samples.depth[i] = INFINITY;
  }
  ShadeOptions one, many;
  one.edges = many.edges = true;
  one.execution.threads = 1;
  many.execution.threads = 7;
  EXPECT_EQ(Shaded(samples, one).pixels, Shaded(samples, many).pixels);
}

TEST(Edges, ASilhouetteIsOnePixelWideAndBelongsToTheNearerSide) {
  SampleBuffer samples = FacingPlane(12, 3);
  for (int y = 0; y < 3; ++y)
    for (int x = 6; x < 12; ++x) samples.depth[y * 12 + x] = INFINITY;
  ShadeOptions options;
  EXPECT_EQ(LineColumns(samples, options, 1), std::vector<int>{5});
  // In front of a surface that is farther away, the result is the same.
  for (int y = 0; y < 3; ++y)
    for (int x = 6; x < 12; ++x) samples.depth[y * 12 + x] = 40;
  EXPECT_EQ(LineColumns(samples, options, 1), std::vector<int>{5});
  // With several samples per pixel, the line is as many samples wide, on both sides.
  options.samples_x = 4;
  EXPECT_EQ(LineColumns(samples, options, 1), (std::vector<int>{4, 5, 6, 7}));
}

TEST(Edges, ACreaseNeedsTwoFacesAndTheAngle) {
  const auto lines = [](double angle_deg, std::uint32_t other_face) {
    // A roof: two planes that meet in the middle, each tilted by half the angle.
    SampleBuffer samples = FacingPlane(12, 1);
    const double half = angle_deg / 2 * 3.14159265358979 / 180;
    for (int x = 0; x < 12; ++x) {
      const double side = x < 6 ? -1 : 1;
      samples.normal[x] = {static_cast<float>(side * std::sin(half)), static_cast<float>(-std::cos(half)), 0};
      samples.depth[x] = 10 + std::tan(half) * std::fabs(x + 0.5 - 6);
      if (x >= 6) samples.face[x] = other_face;
    }
    ShadeOptions options;
    options.samples_x = 2;
    return LineColumns(samples, options, 0).size();
  };
  EXPECT_EQ(lines(90, 1), 2u);
  EXPECT_EQ(lines(21, 1), 2u);
  EXPECT_EQ(lines(19, 1), 0u);
  EXPECT_EQ(lines(90, 0), 0u) << "within one face there are no lines";
}

TEST(Edges, SlopesAndBendsAreNoSilhouettes) {
  const ShadeOptions options;
  // A plane tilted by up to 85 degrees.
  for (double degrees : {30.0, 60.0, 80.0, 85.0}) {
    const double slope = std::tan(degrees * 3.14159265358979 / 180);
    SampleBuffer samples = FacingPlane(40, 1);
    for (int x = 0; x < 40; ++x) {
      samples.depth[x] = 10 + slope * x;
      const Vec3 n = Normalized({-slope, -1, 0});
      samples.normal[x] = {static_cast<float>(n.x), static_cast<float>(n.y), 0};
    }
    EXPECT_TRUE(LineColumns(samples, options, 0).empty()) << degrees;
  }
  // The depth of a sphere changes ever faster towards its rim. There must be a line at the rim and nowhere
  // else.
  for (double shift : {0.0, 0.01, 0.3, 0.49}) {
    SampleBuffer samples;
    samples.Resize(100, 1);
    for (int x = 0; x < 100; ++x) {
      const double offset = x + 0.5 - 50 + shift, rest = 40 * 40 - offset * offset;
      if (!(rest > 0)) continue;
      samples.depth[x] = 50 - std::sqrt(rest);
      samples.normal[x] = {static_cast<float>(offset / 40), static_cast<float>(-std::sqrt(rest) / 40), 0};
      samples.face[x] = 0;
    }
    EXPECT_EQ(LineColumns(samples, options, 0).size(), 2u) << shift;
  }
}

TEST(Edges, SupersampledLinesAreSoft) {
  // With 4 × 4 samples, the line along a slanted border must have intermediate values after resolving.
  SampleBuffer samples = FacingPlane(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      if (x > 20 + y / 3) samples.depth[y * 64 + x] = 60;
  ShadeOptions options;
  options.edges = true;
  options.samples_x = options.samples_y = 4;
  const Film film = Resolve(Shaded(samples, options), 4, 4).value();
  const float paper = film.pixels[0][1];
  int soft = 0, dark = 0;
  for (const auto& pixel : film.pixels) {
    soft += pixel[1] > 0.3f * paper && pixel[1] < 0.9f * paper;
    dark += pixel[1] <= 0.3f * paper;
  }
  EXPECT_GT(soft, 8);
  EXPECT_GT(dark, 4);
}

}  // namespace
}  // namespace facetless
