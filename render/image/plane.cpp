#include "render/image/plane.h"

#include <algorithm>

#include "render/base/parallel.h"

namespace facetless {
namespace {

constexpr int kBlock = 16;  // number of pixels whose sums stay in registers during the loop over the taps

// Computes out[x] = Σ taps[k] · rows[k][x]. The build for AVX2 adds in the same order, and does not fuse products and
// sums.
[[gnu::target_clones("avx2", "default")]] void WeighRows(const std::vector<const float*>& rows,
                                                         const Taps& taps, int width, float* out) {
  int x = 0;
  for (; x + kBlock <= width; x += kBlock) {
    float sums[kBlock] = {};
    for (std::size_t k = 0; k < taps.size(); ++k) {
      const float tap = taps[k];
      const float* row = rows[k] + x;
      for (int i = 0; i < kBlock; ++i) sums[i] += tap * row[i];
    }
    std::copy_n(sums, kBlock, out + x);
  }
  for (; x < width; ++x) {
    float sum = 0;
    for (std::size_t k = 0; k < taps.size(); ++k) sum += taps[k] * rows[k][x];
    out[x] = sum;
  }
}

}  // namespace

Plane FilterRows(const Plane& plane, const Taps& taps) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(plane.width, plane.height);
  ParallelForBlocks(0, plane.height, 16, [&](int first, int last) {
    // Make a row with its border repeated on both sides; the shifted rows point into it.
    std::vector<float> padded(static_cast<std::size_t>(plane.width + 2 * radius));
    std::vector<const float*> shifted;
    for (std::size_t k = 0; k < taps.size(); ++k) shifted.push_back(padded.data() + k);
    for (int y = first; y < last; ++y) {
      const float* row = plane.row(y);
      std::fill_n(padded.begin(), radius, row[0]);
      std::copy_n(row, plane.width, padded.begin() + radius);
      std::fill_n(padded.end() - radius, radius, row[plane.width - 1]);
      WeighRows(shifted, taps, plane.width, out.row(y));
    }
  });
  return out;
}

Plane FilterColumns(const Plane& plane, const Taps& taps) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(plane.width, plane.height);
  ParallelForBlocks(0, plane.height, 16, [&](int first, int last) {
    std::vector<const float*> rows(taps.size());
    for (int y = first; y < last; ++y) {
      for (int k = -radius; k <= radius; ++k)
        rows[static_cast<std::size_t>(k + radius)] = plane.row(std::clamp(y + k, 0, plane.height - 1));
      WeighRows(rows, taps, plane.width, out.row(y));
    }
  });
  return out;
}

Plane Filter(const Plane& plane, const Taps& along_x, const Taps& along_y) {
  return FilterColumns(FilterRows(plane, along_x), along_y);
}

std::array<Plane, 3> LinearChannels(const Image8& image) {
  std::array<float, 256> linear;
  for (int byte = 0; byte < 256; ++byte) linear[byte] = static_cast<float>(SrgbToLinear(byte / 255.0));
  const float grey = static_cast<float>(SrgbToLinear(0.5));
  std::array<Plane, 3> channels;
  channels.fill(Plane(image.width, image.height));
  ParallelForBlocks(0, channels[0].values.size(), 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::uint8_t* pixel = &image.bytes[i * image.channels];
      const float alpha = image.channels == 4 ? pixel[3] / 255.0f : 1.0f;
      for (int c = 0; c < 3; ++c) channels[c].values[i] = alpha * linear[pixel[c]] + (1 - alpha) * grey;
    }
  });
  return channels;
}

}  // namespace facetless
