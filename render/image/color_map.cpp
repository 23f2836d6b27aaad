#include "render/image/color_map.h"

#include <algorithm>
#include <cmath>

#include "render/image/film.h"

namespace facetless {
namespace {

// The diverging map in Oklab: lightness in the middle and at the ends, chroma at the ends, and the directions
// of the two hues.
constexpr double kMiddle = 0.975, kEnd = 0.46, kChroma = 0.165;
constexpr double kBlue[2] = {-0.20, -0.98}, kRed[2] = {0.80, 0.60};

// Converts Oklab to sRGB bytes, with Ottosson's matrices.
std::array<std::uint8_t, 3> FromOklab(double lightness, double a, double b) {
  const double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
  const double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
  const double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
  const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {EncodeByte(static_cast<float>(4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3)),
          EncodeByte(static_cast<float>(-1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3)),
          EncodeByte(static_cast<float>(-0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3))};
}

// The sequential map: lightness at both ends, and the control points of a parabola through the hues of Oklab.
constexpr double kDarkest = 0.30, kLightest = 0.95;
constexpr double kHues[3][2] = {{0.08, -0.13}, {-0.20, 0.00}, {-0.02, 0.17}};

}  // namespace

std::array<std::uint8_t, 3> DivergingColor(double t) {
  const double share = std::min(std::fabs(t), 1.0);
  const double lightness = kMiddle + (kEnd - kMiddle) * share;
  const double(&hue)[2] = t < 0 ? kBlue : kRed;
  const double a = kChroma * share * hue[0], b = kChroma * share * hue[1];
  return FromOklab(lightness, a, b);
}

std::array<std::uint8_t, 3> SequentialColor(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  const auto on = [&](int axis) {
    return (1 - s) * (1 - s) * kHues[0][axis] + 2 * s * (1 - s) * kHues[1][axis] + s * s * kHues[2][axis];
  };
  return FromOklab(kDarkest + (kLightest - kDarkest) * s, on(0), on(1));
}

std::array<std::uint8_t, 3> CategoryColor(std::uint32_t number) {
  // Steps of the golden section distribute consecutive numbers evenly around the circle. The step has 32
  // bits, so that it wraps around exactly.
  constexpr std::uint32_t kGolden = 2654435769u;
  constexpr double kLightnesses[3] = {0.66, 0.82, 0.50}, kChromaOfCategories = 0.11;
  const double turn =
      (number * kGolden) * 0x1p-30;  // 0 … 4: one unit for each side of the square around the circle
  const double along = turn - std::floor(turn), across = 1 - along;
  const double corner[4][2] = {{across, along}, {-along, across}, {-across, -along}, {along, -across}};
  const double(&at)[2] = corner[static_cast<int>(turn)];
  const double chroma = kChromaOfCategories / std::sqrt(at[0] * at[0] + at[1] * at[1]);
  return FromOklab(kLightnesses[number % 3], chroma * at[0], chroma * at[1]);
}

}  // namespace facetless
