#include "render/compare/color_map.h"

#include <algorithm>
#include <cmath>

#include "render/image/film.h"

namespace facetless {
namespace {

// Oklab: lightness in the middle and at the ends, chroma at the ends, and the direction of both hues.
constexpr double kMiddle = 0.975, kEnd = 0.46, kChroma = 0.165;
constexpr double kBlue[2] = {-0.20, -0.98}, kRed[2] = {0.80, 0.60};

}  // namespace

std::array<std::uint8_t, 3> DivergingColor(double t) {
  const double share = std::min(std::fabs(t), 1.0);
  const double lightness = kMiddle + (kEnd - kMiddle) * share;
  const double(&hue)[2] = t < 0 ? kBlue : kRed;
  const double a = kChroma * share * hue[0], b = kChroma * share * hue[1];
  // Oklab to linear sRGB, with Ottosson's matrices.
  const double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
  const double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
  const double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
  const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {EncodeByte(static_cast<float>(4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3)),
          EncodeByte(static_cast<float>(-1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3)),
          EncodeByte(static_cast<float>(-0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3))};
}

}  // namespace facetless
