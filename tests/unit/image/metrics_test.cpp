// Metrics: known values, invariants, and cases that image libraries compute wrongly.
#include "render/image/metrics.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numeric>

namespace facetless {
namespace {

Image8 Solid(int width, int height, std::array<std::uint8_t, 3> color) {
  Image8 image{width, height, 3, {}};
  for (int i = 0; i < width * height; ++i) image.bytes.insert(image.bytes.end(), color.begin(), color.end());
  return image;
}

Image8 Noise(int width, int height, unsigned seed) {
  Image8 image{width, height, 3, {}};
  unsigned state = seed * 2654435761u + 1;
  for (int i = 0; i < width * height * 3; ++i) {
    state = state * 1664525u + 1013904223u;
    image.bytes.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return image;
}

ColorMetrics Compare(const Image8& a, const Image8& b, const ColorMetricOptions& options = {}) {
  const Result<ColorMetrics> metrics = CompareColors(a, b, options);
  EXPECT_TRUE(metrics.ok()) << metrics.error().message;
  return metrics.value();
}

TEST(Metrics, EqualPicturesDifferInNothing) {
  const ColorMetrics m = Compare(Noise(40, 30, 1), Noise(40, 30, 1));
  EXPECT_EQ(m.max, 0);
  EXPECT_EQ(m.mean, 0);
  EXPECT_EQ(m.rms, 0);
  EXPECT_TRUE(std::isinf(m.psnr) && m.psnr > 0);
  EXPECT_NEAR(m.ssim, 1, 1e-6);
  EXPECT_EQ(m.flip_mean, 0);
  EXPECT_EQ(m.flip_p95, 0);
  EXPECT_EQ(m.share_over_threshold, 0);
  EXPECT_EQ(m.pixels_per_degree, 67);
}

TEST(Metrics, OneChangedPixelHasTheNumbersOfOneChangedPixel) {
  const Image8 a = Solid(20, 10, {100, 100, 100});
  Image8 b = a;
  b.at(3, 4)[1] = 151;  // by 51 / 255 = 0.2 in one channel of 600
  const ColorMetrics m = Compare(a, b);
  EXPECT_NEAR(m.max, 0.2, 1e-6);
  EXPECT_NEAR(m.mean, 0.2 / 600, 1e-8);
  EXPECT_NEAR(m.rms, std::sqrt(0.04 / 600), 1e-7);
  EXPECT_NEAR(m.psnr, 10 * std::log10(600 / 0.04), 1e-3);
  EXPECT_NEAR(m.share_over_threshold, 1.0 / 200, 1e-12);
  EXPECT_LT(m.ssim, 1);
}

TEST(Metrics, TheThresholdIsExclusive) {
  const Image8 a = Solid(10, 10, {100, 100, 100}), b = Solid(10, 10, {103, 100, 100});
  ColorMetricOptions options;
  options.threshold = 2.5 / 255;
  EXPECT_EQ(Compare(a, b, options).share_over_threshold, 1);
  options.threshold = 3.5 / 255;
  EXPECT_EQ(Compare(a, b, options).share_over_threshold, 0);
}

TEST(Metrics, NumbersAreThoseOfIdiff) {
  const Image8 a = Noise(57, 31, 3), b = Noise(57, 31, 4);
  ColorMetricOptions options;
  options.threshold = 0.7;
  const ColorMetrics ours = Compare(a, b, options);
  const OIIO::ImageSpec spec(57, 31, 3, OIIO::TypeDesc::UINT8);
  const OIIO::ImageBuf theirs_a(spec, const_cast<std::uint8_t*>(a.bytes.data())),
      theirs_b(spec, const_cast<std::uint8_t*>(b.bytes.data()));
  const auto theirs = OIIO::ImageBufAlgo::compare(theirs_a, theirs_b, 0.7f, 0.7f);
  EXPECT_NEAR(ours.max, theirs.maxerror, 1e-6);
  EXPECT_NEAR(ours.mean, theirs.meanerror, 1e-6);
  EXPECT_NEAR(ours.rms, theirs.rms_error, 1e-6);
  EXPECT_NEAR(ours.psnr, theirs.PSNR, 1e-4);
  EXPECT_NEAR(ours.share_over_threshold, static_cast<double>(theirs.nfail) / (57 * 31), 1e-12);
  EXPECT_GT(theirs.nfail, 0);
}

TEST(Metrics, SizesAreComparedFirst) {
  EXPECT_EQ(CompareColors(Solid(4, 4, {}), Solid(4, 5, {}), {}).error().code, ErrorCode::kSizeMismatch);
  EXPECT_EQ(FlipMap(Solid(4, 4, {}), Solid(5, 4, {}), 67).error().code, ErrorCode::kSizeMismatch);
  EXPECT_EQ(Ssim(Solid(4, 4, {}), Solid(16, 1, {})).error().code, ErrorCode::kSizeMismatch);
  EXPECT_EQ(CompareColors(Image8{}, Image8{}, {}).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(FlipMap(Solid(4, 4, {}), Solid(4, 4, {}), 0).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(FlipMap(Solid(4, 4, {}), Solid(4, 4, {}), NAN).error().code, ErrorCode::kBadUsage);
  ColorMetricOptions bad;
  bad.threshold = NAN;
  EXPECT_EQ(CompareColors(Solid(4, 4, {}), Solid(4, 4, {}), bad).error().code, ErrorCode::kBadUsage);
}

TEST(Metrics, TransparentPicturesAreComparedOverGrey) {
  Image8 clear{8, 8, 4, std::vector<std::uint8_t>(8 * 8 * 4, 0)};
  Image8 other = clear;
  for (std::size_t i = 0; i < other.bytes.size(); i += 4) other.bytes[i] = 255;  // red, but invisible
  EXPECT_EQ(Compare(clear, other).max, 0);
  EXPECT_LE(Compare(clear, Solid(8, 8, {128, 128, 128})).max, 1.001 / 255);
}

TEST(Ssim, FollowsItsDefinitionOnFlatPictures) {
  // Without structure, only the luminance term remains: (2ab + C1) / (a² + b² + C1).
  const double a = 100 / 255.0, b = 150 / 255.0, c1 = 1e-4;
  EXPECT_NEAR(Ssim(Solid(32, 32, {100, 100, 100}), Solid(32, 32, {150, 150, 150})).value(),
              (2 * a * b + c1) / (a * a + b * b + c1), 1e-4);
}

TEST(Ssim, IsSymmetricAndAtMostOne) {
  for (unsigned seed = 1; seed < 6; ++seed) {
    const Image8 a = Noise(33, 21, seed), b = Noise(33, 21, seed + 100);
    const double forth = Ssim(a, b).value();
    EXPECT_DOUBLE_EQ(forth, Ssim(b, a).value());
    EXPECT_LT(forth, 0.3) << "independent noise has no common structure";
    EXPECT_GE(forth, -1);
  }
}

TEST(Ssim, SmallPicturesUseTheWindowThatFits) {
  for (auto [width, height] : {std::pair{1, 1}, {2, 3}, {5, 40}, {11, 11}, {12, 10}}) {
    const Result<double> same = Ssim(Noise(width, height, 7), Noise(width, height, 7));
    ASSERT_TRUE(same.ok());
    EXPECT_NEAR(same.value(), 1, 1e-6) << width << "x" << height;
  }
}

double FlipMean(const Image8& a, const Image8& b, double ppd = 67) {
  const Result<std::vector<float>> map = FlipMap(a, b, ppd);
  EXPECT_TRUE(map.ok());
  return std::accumulate(map.value().begin(), map.value().end(), 0.0) /
         static_cast<double>(map.value().size());
}

TEST(Flip, KnownValuesOfFlatPictures) {
  // Without features, FLIP is its colour error. Black to white has a HyAB distance of 100. The largest
  // distance, green to blue with the Hunt effect, follows from their CIELAB coordinates (87.735, −86.183,
  // 83.180) and (32.301, 79.197, −107.865).
  const double da = -0.87735 * 86.183 - 0.32301 * 79.197, db = 0.87735 * 83.180 + 0.32301 * 107.865;
  const double largest = std::pow(87.735 - 32.301 + std::hypot(da, db), 0.7), knee = 0.4 * largest;
  const double white = 0.95 + 0.05 * (std::pow(100, 0.7) - knee) / (largest - knee);
  EXPECT_NEAR(FlipMean(Solid(32, 32, {0, 0, 0}), Solid(32, 32, {255, 255, 255})), white, 1e-4);
  EXPECT_NEAR(FlipMean(Solid(32, 32, {0, 255, 0}), Solid(32, 32, {0, 0, 255})), 1, 1e-5);
}

TEST(Flip, IsSymmetricAndBetweenZeroAndOne) {
  EXPECT_TRUE(rc::check("any two pictures", [] {
    const unsigned seed = *rc::gen::inRange(1u, 1000000u);
    const int width = *rc::gen::inRange(1, 40), height = *rc::gen::inRange(1, 40);
    const Image8 a = Noise(width, height, seed), b = Noise(width, height, seed + 1);
    const std::vector<float> forth = FlipMap(a, b, 67).value(), back = FlipMap(b, a, 67).value();
    RC_ASSERT(forth == back);
    for (float error : forth) RC_ASSERT(error >= 0 && error <= 1);
  }));
}

TEST(Flip, DifferencesElsewhereChangeNothingNearby) {
  // The error is computed around differences only. One in each corner makes the whole picture such a region.
  EXPECT_TRUE(rc::check("a patch of noise in two equal pictures", [] {
    const unsigned seed = *rc::gen::inRange(1u, 1000000u);
    const int width = *rc::gen::inRange(60, 160), height = *rc::gen::inRange(60, 160);
    const double ppd = *rc::gen::inRange(5, 80);
    const int reach = static_cast<int>(std::ceil(0.15 * ppd));  // of both filters, at least
    const Image8 a = Noise(width, height, seed);
    Image8 b = a;
    const int column = *rc::gen::inRange(0, width - 3), row = *rc::gen::inRange(0, height - 3);
    for (int y = row; y < row + 3; ++y)
      for (int x = column; x < column + 3; ++x) b.at(x, y)[0] ^= 0x5a;
    const std::vector<float> alone = FlipMap(a, b, ppd).value();
    Image8 c = b;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (std::abs(x - column - 1) > 3 * reach || std::abs(y - row - 1) > 3 * reach) c.at(x, y)[1] ^= 0x21;
    const std::vector<float> among = FlipMap(a, c, ppd).value();
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * width + x;
        if (std::abs(x - column - 1) <= reach && std::abs(y - row - 1) <= reach) {
          RC_ASSERT(alone[i] == among[i]);
        } else if (std::abs(x - column - 1) > 2 * reach || std::abs(y - row - 1) > 2 * reach) {
          RC_ASSERT(alone[i] == 0);
        }
      }
  }));
}

TEST(Flip, GrowsWithTheDifference) {
  double last = 0;
  for (int step : {2, 5, 10, 20, 50, 100}) {
    const auto value = static_cast<std::uint8_t>(100 + step);
    const double error = FlipMean(Solid(24, 24, {100, 100, 100}), Solid(24, 24, {value, value, value}));
    EXPECT_GT(error, last);
    last = error;
  }
}

TEST(Flip, FineDetailFadesWithDistance) {
  // Compare a checkerboard of single pixels with its mean: it is visible from nearby, and grey from far away.
  Image8 board = Solid(64, 64, {0, 0, 0});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      if ((x + y) % 2 == 0) std::fill_n(board.at(x, y), 3, std::uint8_t{255});
  const Image8 mean = Solid(64, 64, {188, 188, 188});
  EXPECT_GT(FlipMean(board, mean, 10), 2 * FlipMean(board, mean, 67));
}

TEST(Flip, AnErrorStaysWhereItIs) {
  Image8 a = Solid(80, 80, {120, 120, 120}), b = a;
  for (int y = 38; y < 42; ++y)
    for (int x = 38; x < 42; ++x) std::fill_n(b.at(x, y), 3, std::uint8_t{255});
  const std::vector<float> map = FlipMap(a, b, 67).value();
  EXPECT_GT(map[40 * 80 + 40], 0.3);
  // The widest filter reaches 10 pixels at 67 pixels per degree.
  EXPECT_EQ(map[40 * 80 + 60], 0);
  EXPECT_EQ(map[5 * 80 + 5], 0);
}

}  // namespace
}  // namespace facetless
