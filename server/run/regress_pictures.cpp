#include <algorithm>
#include <cmath>

#include "server/run/regress.h"

namespace facetless {
namespace {

constexpr int kGap = 8;

void CopyOnWhite(const Image8& from, Image8& to, int x0) {
  for (int y = 0; y < from.height; ++y) {
    for (int x = 0; x < from.width; ++x) {
      const std::uint8_t* source = from.at(x, y);
      std::uint8_t* target = to.at(x0 + x, y);
      const int alpha = from.channels == 4 ? source[3] : 255;
      for (int c = 0; c < 3; ++c)
        target[c] = static_cast<std::uint8_t>((source[c] * alpha + 255 * (255 - alpha) + 127) / 255);
    }
  }
}

}  // namespace

Image8 SideBySide(const Image8& a, const Image8& b, const Image8& c) {
  Image8 joined;
  joined.width = 3 * a.width + 2 * kGap;
  joined.height = a.height;
  joined.channels = 3;
  joined.bytes.assign(std::size_t(joined.width) * joined.height * 3, 255);
  CopyOnWhite(a, joined, 0);
  CopyOnWhite(b, joined, a.width + kGap);
  CopyOnWhite(c, joined, 2 * (a.width + kGap));
  return joined;
}

Image8 ErrorPicture(const std::vector<float>& errors, int width, int height) {
  Image8 picture;
  picture.width = width;
  picture.height = height;
  picture.channels = 3;
  picture.bytes.reserve(errors.size() * 3);
  for (const float error : errors) {
    // Red rises over the first third, green over the second, blue over the last, so that lightness always
    // grows. The square root makes small errors visible.
    const float ramp = 3 * std::sqrt(std::clamp(error, 0.0f, 1.0f));
    for (int c = 0; c < 3; ++c)
      picture.bytes.push_back(
          static_cast<std::uint8_t>(255 * std::clamp(ramp - static_cast<float>(c), 0.0f, 1.0f)));
  }
  return picture;
}

Result<DepthDifference> CompareDepths(const DepthImage& a, const DepthImage& b) {
  if (a.width != b.width || a.height != b.height)
    return Error{ErrorCode::kSizeMismatch, "the depth images are " + std::to_string(a.width) + "x" +
                                               std::to_string(a.height) + " and " + std::to_string(b.width) +
                                               "x" + std::to_string(b.height) + " pixels"};
  DepthDifference difference;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    if (std::isnan(a.depth[i]) || std::isnan(b.depth[i]))
      return Error{ErrorCode::kNotFinite, "a depth is not a number at pixel " + std::to_string(i % a.width) +
                                              ", " + std::to_string(i / a.width)};
    const bool hit_a = std::isfinite(a.depth[i]), hit_b = std::isfinite(b.depth[i]);
    if (hit_a != hit_b) ++difference.silhouette_pixels;
    if (hit_a && hit_b) difference.max_mm = std::max(difference.max_mm, std::fabs(a.depth[i] - b.depth[i]));
  }
  return difference;
}

}  // namespace facetless
