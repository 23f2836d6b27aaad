#include "render/image/plane.h"

#include <algorithm>

#include "render/base/parallel.h"

namespace facetless {
namespace {

// Computes out[x] = Σ taps[k] · rows[k][x]. The build for AVX2 adds in the same order, and does not fuse products and
// sums.
[[gnu::target_clones("avx2", "default")]] void WeighRows(const std::vector<const float*>& rows,
                                                         const Taps& taps, int begin, int end, float* out) {
  constexpr int kBlock = FilterRegion::kBlock;  // their sums stay in registers during the loop over the taps
  int x = begin;
  for (; x + kBlock <= end; x += kBlock) {
    float sums[kBlock] = {};
    for (std::size_t k = 0; k < taps.size(); ++k) {
      const float tap = taps[k];
      const float* row = rows[k] + x;
      for (int i = 0; i < kBlock; ++i) sums[i] += tap * row[i];
    }
    std::copy_n(sums, kBlock, out + x);
  }
  for (; x < end; ++x) {
    float sum = 0;
    for (std::size_t k = 0; k < taps.size(); ++k) sum += taps[k] * rows[k][x];
    out[x] = sum;
  }
}

}  // namespace

FilterRegion::FilterRegion(const Image8& a, const Image8& b)
    : width_(a.width),
      height_(a.height),
      stride_((a.width + kBlock - 1) / kBlock),
      blocks_(static_cast<std::size_t>(stride_) * a.height) {
  ParallelForBlocks(0, height_, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * width_;
      for (int block = 0; block < stride_; ++block) {
        const std::size_t begin = row + static_cast<std::size_t>(block) * kBlock;
        const std::size_t end = row + static_cast<std::size_t>(std::min(width_, (block + 1) * kBlock));
        const bool differ = !std::equal(&a.bytes[begin * a.channels], a.bytes.data() + end * a.channels,
                                        &b.bytes[begin * b.channels], b.bytes.data() + end * b.channels);
        blocks_[static_cast<std::size_t>(y) * stride_ + block] = differ;
      }
    }
  });
}

FilterRegion FilterRegion::Grown(int radius_x, int radius_y) const {
  FilterRegion grown = *this;
  const int reach = (radius_x + kBlock - 1) / kBlock;
  ParallelForBlocks(0, height_, 64, [&](int first, int last) {
    std::vector<int> rows(stride_);  // for each block: how many of the rows within radius_y have it
    const auto count = [&](int y, int change) {
      if (y < 0 || y >= height_) return;
      for (int block = 0; block < stride_; ++block)
        rows[block] += change * blocks_[static_cast<std::size_t>(y) * stride_ + block];
    };
    for (int y = first - radius_y; y < first + radius_y; ++y) count(y, 1);
    for (int y = first; y < last; ++y) {
      count(y + radius_y, 1);
      for (int block = 0; block < stride_; ++block) {
        int near = 0;
        for (int i = std::max(0, block - reach); i <= std::min(stride_ - 1, block + reach); ++i)
          near |= rows[i];
        grown.blocks_[static_cast<std::size_t>(y) * stride_ + block] = near != 0;
      }
      count(y - radius_y, -1);
    }
  });
  return grown;
}

bool FilterRegion::empty() const {
  return std::find(blocks_.begin(), blocks_.end(), 1) == blocks_.end();
}

Plane FilterRows(const Plane& plane, const Taps& taps, const FilterRegion& region) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(plane.width, plane.height);
  ParallelForBlocks(0, plane.height, 16, [&](int first, int last) {
    // Make a row with its border repeated on both sides; the shifted rows point into it.
    std::vector<float> padded(static_cast<std::size_t>(plane.width + 2 * radius));
    std::vector<const float*> shifted;
    for (std::size_t k = 0; k < taps.size(); ++k) shifted.push_back(padded.data() + k);
    int made = -1;  // the row that `padded` holds
    region.ForRuns(first, last, [&](int y, int begin, int end) {
      if (y != made) {
        const float* row = plane.row(y);
        std::fill_n(padded.begin(), radius, row[0]);
        std::copy_n(row, plane.width, padded.begin() + radius);
        std::fill_n(padded.end() - radius, radius, row[plane.width - 1]);
        made = y;
      }
      WeighRows(shifted, taps, begin, end, out.row(y));
    });
  });
  return out;
}

Plane FilterColumns(const Plane& plane, const Taps& taps, const FilterRegion& region) {
  const int radius = static_cast<int>(taps.size() / 2);
  Plane out(plane.width, plane.height);
  ParallelForBlocks(0, plane.height, 16, [&](int first, int last) {
    std::vector<const float*> rows(taps.size());
    region.ForRuns(first, last, [&](int y, int begin, int end) {
      for (int k = -radius; k <= radius; ++k)
        rows[static_cast<std::size_t>(k + radius)] = plane.row(std::clamp(y + k, 0, plane.height - 1));
      WeighRows(rows, taps, begin, end, out.row(y));
    });
  });
  return out;
}

Plane Filter(const Plane& plane, const Taps& along_x, const Taps& along_y, const FilterRegion& region) {
  const FilterRegion rows = region.Grown(0, static_cast<int>(along_y.size() / 2));
  return FilterColumns(FilterRows(plane, along_x, rows), along_y, region);
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
