// One channel of a picture in float32, and the separable filters of the metrics. Private to render/image.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "render/image/film.h"

namespace facetless {

struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;  // row-major

  Plane() = default;
  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
  float* row(int y) { return values.data() + static_cast<std::size_t>(y) * width; }
  const float* row(int y) const { return values.data() + static_cast<std::size_t>(y) * width; }
};

// The weights of a filter for the offsets −radius … radius; taps.size() = 2·radius + 1.
using Taps = std::vector<float>;

// Filters a plane. Beyond the border, the border pixel is repeated. Sums run in single precision from the
// first tap to the last, so they are the same on every machine, and accurate to 1e-6 of the largest value.
Plane FilterRows(const Plane& plane, const Taps& taps);
Plane FilterColumns(const Plane& plane, const Taps& taps);
Plane Filter(const Plane& plane, const Taps& along_x, const Taps& along_y);  // rows, then columns

// The channels of the picture as linear light, 0 … 1. Transparent pixels are composed over mid grey (encoded
// 0.5).
std::array<Plane, 3> LinearChannels(const Image8& image);

}  // namespace facetless
