#include "render/image/paint.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// The integers in [0, limit] below and above x. Requires x not to be NaN.
int Floor(double x, int limit) {
  return static_cast<int>(std::floor(std::clamp(x, 0.0, static_cast<double>(limit))));
}
int Ceil(double x, int limit) {
  return static_cast<int>(std::ceil(std::clamp(x, 0.0, static_cast<double>(limit))));
}

}  // namespace

void CoverPixel(std::uint8_t* pixel, int channels, const Rgb8& color, double cover) {
  const double below_alpha = channels == 4 ? pixel[3] / 255.0 : 1;
  const double below = below_alpha * (1 - cover), alpha = cover + below;
  if (!(alpha > 0)) return;
  for (int c = 0; c < 3; ++c)
    pixel[c] = EncodeByte(static_cast<float>(
        (below * SrgbToLinear(pixel[c] / 255.0) + cover * SrgbToLinear(color[c] / 255.0)) / alpha));
  if (channels == 4) pixel[3] = static_cast<std::uint8_t>(std::lround(alpha * 255));
}

double DistanceToSegment(Vec2 from, Vec2 to, Vec2 p) {
  const Vec2 along = to - from, offset = p - from;
  const double length2 = Dot(along, along);
  const double t = length2 > 0 ? std::clamp(Dot(offset, along) / length2, 0.0, 1.0) : 0.0;
  return Length(offset - t * along);
}

void DrawStroke(Image8& image, Vec2 from, Vec2 to, double width, const Rgb8& color, double cover) {
  const double half = 0.5 * width, reach = half + 1;
  const int x0 = Floor(std::min(from.x, to.x) - reach, image.width);
  const int x1 = Ceil(std::max(from.x, to.x) + reach, image.width);
  const int y0 = Floor(std::min(from.y, to.y) - reach, image.height);
  const int y1 = Ceil(std::max(from.y, to.y) + reach, image.height);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const double distance = DistanceToSegment(from, to, {x + 0.5, y + 0.5});
      const double inside = std::clamp(half + 0.5 - distance, 0.0, 1.0);
      if (inside > 0) CoverPixel(image.at(x, y), image.channels, color, cover * inside);
    }
}

void FillRectangle(Image8& image, Vec2 low, Vec2 high, const Rgb8& color, double cover) {
  const auto share = [](int pixel, double begin, double end) {
    return std::clamp(std::min(end, pixel + 1.0) - std::max(begin, static_cast<double>(pixel)), 0.0, 1.0);
  };
  for (int y = Floor(low.y, image.height); y < Ceil(high.y, image.height); ++y)
    for (int x = Floor(low.x, image.width); x < Ceil(high.x, image.width); ++x) {
      const double inside = share(x, low.x, high.x) * share(y, low.y, high.y);
      if (inside > 0) CoverPixel(image.at(x, y), image.channels, color, cover * inside);
    }
}

}  // namespace facetless
