#include "render/image/film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace facetless {
namespace {

double ExactLinear(double e) {
  return e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
}
double ExactEncoded(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}

TEST(Srgb, CurvesFollowTheStandard) {
  for (int i = 0; i <= 100000; ++i) {
    const double x = i / 100000.0;
    ASSERT_NEAR(SrgbToLinear(x), ExactLinear(x), 1e-14) << x;
    ASSERT_NEAR(LinearToSrgb(x), ExactEncoded(x), 1e-14) << x;
  }
  EXPECT_EQ(SrgbToLinear(-1), 0);
  EXPECT_EQ(LinearToSrgb(2), LinearToSrgb(1));
}

TEST(Srgb, EncodeByteIsTheNearestByte) {
  for (int i = 0; i <= 1000000; ++i) {
    const float linear = static_cast<float>(i) / 1e6f;
    const double exact = 255 * ExactEncoded(linear);
    ASSERT_LE(std::fabs(EncodeByte(linear) - exact), 0.5 + 1e-4) << linear;
  }
  EXPECT_EQ(EncodeByte(-1.0f), 0);
  EXPECT_EQ(EncodeByte(0.0f), 0);
  EXPECT_EQ(EncodeByte(1.0f), 255);
  EXPECT_EQ(EncodeByte(7.0f), 255);
}

TEST(Srgb, EveryByteSurvivesTheRoundTrip) {
  for (int byte = 0; byte < 256; ++byte)
    EXPECT_EQ(EncodeByte(static_cast<float>(SrgbToLinear(byte / 255.0))), byte);
}

Film Filled(int width, int height, std::array<float, 4> pixel) {
  Film film{width, height, {}};
  film.pixels.assign(static_cast<std::size_t>(width) * height, pixel);
  return film;
}

TEST(Resolve, IsTheMeanInLinearLight) {
  Film samples = Filled(4, 2, {0, 0, 0, 1});
  for (int i : {0, 5}) samples.pixels[i] = {1, 1, 1, 1};
  const Result<Film> film = Resolve(samples, 2, 2);
  ASSERT_TRUE(film.ok());
  EXPECT_EQ(film.value().width, 2);
  EXPECT_EQ(film.value().height, 1);
  EXPECT_EQ(film.value().pixels[0], (std::array<float, 4>{0.5f, 0.5f, 0.5f, 1}));
  EXPECT_EQ(film.value().pixels[1], (std::array<float, 4>{0, 0, 0, 1}));
  // The mean of black and white is 188 in sRGB, not 128.
  EXPECT_EQ(Encode(film.value()).value().bytes[0], 188);
}

TEST(Resolve, RefusesSizesThatDoNotDivide) {
  EXPECT_EQ(Resolve(Filled(5, 4, {0, 0, 0, 1}), 2, 2).error().code, ErrorCode::kSizeMismatch);
  EXPECT_EQ(Resolve(Filled(4, 4, {0, 0, 0, 1}), 0, 2).error().code, ErrorCode::kSizeMismatch);
}

TEST(Encode, OpaqueIsRgbAndTransparentTakesAlphaOut) {
  EXPECT_EQ(Encode(Filled(2, 2, {0.5f, 0.5f, 0.5f, 1})).value().channels, 3);
  const Image8 image = Encode(Filled(2, 2, {0.25f, 0.125f, 0, 0.5f})).value();
  ASSERT_EQ(image.channels, 4);
  EXPECT_EQ(image.at(0, 0)[0], EncodeByte(0.5f));
  EXPECT_EQ(image.at(0, 0)[1], EncodeByte(0.25f));
  EXPECT_EQ(image.at(0, 0)[3], 128);
  const Image8 empty = Encode(Filled(1, 1, {0, 0, 0, 0})).value();
  EXPECT_EQ(empty.bytes, (std::vector<std::uint8_t>{0, 0, 0, 0}));
}

TEST(Encode, NamesThePixelThatIsNoNumber) {
  Film film = Filled(4, 4, {0, 0, 0, 1});
  film.pixels[9][2] = std::numeric_limits<float>::quiet_NaN();
  const Result<Image8> image = Encode(film);
  ASSERT_FALSE(image.ok());
  EXPECT_EQ(image.error().code, ErrorCode::kNotFinite);
  EXPECT_NE(image.error().message.find("(1, 2)"), std::string::npos);
}

}  // namespace
}  // namespace facetless
