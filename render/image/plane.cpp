#include "render/image/plane.h"

#include <algorithm>

#include "render/trace/parallel.h"

namespace facetless {
namespace {

Plane FilterRows(const Plane& plane, const Taps& taps) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(plane.width, plane.height);
  ParallelFor(0, plane.height, [&](int y) {
    const float* row = &plane.values[static_cast<std::size_t>(y) * plane.width];
    for (int x = 0; x < plane.width; ++x) {
      double sum = 0;
      for (int k = -radius; k <= radius; ++k)
        sum += taps[k + radius] * row[std::clamp(x + k, 0, plane.width - 1)];
      out.values[static_cast<std::size_t>(y) * plane.width + x] = static_cast<float>(sum);
    }
  });
  return out;
}

Plane FilterColumns(const Plane& plane, const Taps& taps) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(plane.width, plane.height);
  ParallelFor(0, plane.height, [&](int y) {
    std::vector<double> sums(plane.width, 0.0);
    for (int k = -radius; k <= radius; ++k) {
      const float* row =
          &plane.values[static_cast<std::size_t>(std::clamp(y + k, 0, plane.height - 1)) * plane.width];
      for (int x = 0; x < plane.width; ++x) sums[x] += taps[k + radius] * row[x];
    }
    for (int x = 0; x < plane.width; ++x)
      out.values[static_cast<std::size_t>(y) * plane.width + x] = static_cast<float>(sums[x]);
  });
  return out;
}

}  // namespace

Plane Filter(const Plane& plane, const Taps& along_x, const Taps& along_y) {
  return FilterColumns(FilterRows(plane, along_x), along_y);
}

std::array<Plane, 3> LinearChannels(const Image8& image) {
  std::array<float, 256> linear;
  for (int byte = 0; byte < 256; ++byte) linear[byte] = static_cast<float>(SrgbToLinear(byte / 255.0));
  const float grey = static_cast<float>(SrgbToLinear(0.5));
  std::array<Plane, 3> channels;
  channels.fill(Plane(image.width, image.height));
  for (std::size_t i = 0; i < channels[0].values.size(); ++i) {
    const std::uint8_t* pixel = &image.bytes[i * image.channels];
    const float alpha = image.channels == 4 ? pixel[3] / 255.0f : 1.0f;
    for (int c = 0; c < 3; ++c) channels[c].values[i] = alpha * linear[pixel[c]] + (1 - alpha) * grey;
  }
  return channels;
}

}  // namespace facetless
