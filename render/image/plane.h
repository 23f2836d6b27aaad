// One channel of a picture in float32, the separable filters of the metrics, and the region of a picture in which
// they are evaluated. Private to render/image.
//
//  1. A filter computes the pixels of its region, and sets all others to 0. The value of a pixel in the region does not
//     depend on which other pixels the region has.
//  2. Where two pictures are equal within a filter's radius of a pixel, they have the same filtered value at the pixel.
//     A metric that compares two pictures therefore needs only the pixels within the radius of a difference.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/base/parallel.h"

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

// A set of pixels that consists of whole blocks. A block is kBlock consecutive pixels of a row; at the right border it
// may be shorter.
class FilterRegion {
 public:
  static constexpr int kBlock = 16;
  // Makes the set of the blocks that have a pixel in which the pictures differ. Requires pictures of the same size.
  FilterRegion(const Image8& a, const Image8& b);

  // Returns the set of all blocks that have a pixel within the given distances, in pixels, of this region.
  FilterRegion Grown(int radius_x, int radius_y) const;
  bool empty() const;
  // Calls visit(y, begin, end) for each run of pixels [begin, end) in rows first ≤ y < last.
  template <typename Visit>
  void ForRuns(int first, int last, const Visit& visit) const {
    for (int y = first; y < last; ++y) {
      const std::uint8_t* row = blocks_.data() + static_cast<std::size_t>(y) * stride_;
      for (int block = 0; block < stride_; ++block) {
        if (!row[block]) continue;
        const int begin = block;
        while (block < stride_ && row[block]) ++block;
        const int end = block * kBlock;
        visit(y, begin * kBlock, end < width_ ? end : width_);
      }
    }
  }
  // The same for all rows, in parallel.
  template <typename Visit>
  void ForRuns(const Visit& visit) const {
    ParallelForBlocks(0, height_, 16, [&](int first, int last) { ForRuns(first, last, visit); });
  }

 private:
  int width_, height_, stride_;       // stride_: blocks per row
  std::vector<std::uint8_t> blocks_;  // row by row; 1: in the region
};

// The weights of a filter for the offsets −radius … radius; taps.size() = 2·radius + 1.
using Taps = std::vector<float>;

// Filters a plane. Beyond the border, the border pixel is repeated. Sums run in single precision from the
// first tap to the last, so they are the same on every machine, and accurate to 1e-6 of the largest value.
Plane FilterRows(const Plane& plane, const Taps& taps, const FilterRegion& region);
Plane FilterColumns(const Plane& plane, const Taps& taps, const FilterRegion& region);
// Rows, then columns.
Plane Filter(const Plane& plane, const Taps& along_x, const Taps& along_y, const FilterRegion& region);

// The channels of the picture as linear light, 0 … 1. Transparent pixels are composed over mid grey (encoded
// 0.5).
std::array<Plane, 3> LinearChannels(const Image8& image);

}  // namespace facetless
