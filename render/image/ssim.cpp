// SSIM: Wang, Bovik, Sheikh, Simoncelli: "Image Quality Assessment: From Error Visibility to Structural
// Similarity", 2004.
#include <algorithm>
#include <cmath>

#include "render/image/compare_input.h"
#include "render/image/metrics.h"
#include "render/image/plane.h"

namespace facetless {
namespace {

constexpr int kWindow = 11;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // (K·L)² with L = 1

// Encoded luma, Rec. 601, 0 … 1.
Plane Luma(const Image8& image) {
  const std::array<Plane, 3> linear = LinearChannels(image);
  Plane luma(image.width, image.height);
  for (std::size_t i = 0; i < luma.values.size(); ++i) {
    if (image.channels == 3) {
      const std::uint8_t* p = &image.bytes[3 * i];
      luma.values[i] = static_cast<float>((0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]) / 255);
    } else {
      luma.values[i] = static_cast<float>(0.299 * LinearToSrgb(linear[0].values[i]) +
                                          0.587 * LinearToSrgb(linear[1].values[i]) +
                                          0.114 * LinearToSrgb(linear[2].values[i]));
    }
  }
  return luma;
}

// The taps of a window whose length is odd and at most `size`.
Taps GaussianTaps(int size) {
  const int length = std::min(kWindow, size % 2 == 1 ? size : size - 1);
  const int radius = std::max(length / 2, 0);
  const auto gauss = [](int i) { return std::exp(-i * i / (2 * kSigma * kSigma)); };
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) sum += gauss(i);
  Taps taps;
  for (int i = -radius; i <= radius; ++i) taps.push_back(static_cast<float>(gauss(i) / sum));
  return taps;
}

Plane Product(const Plane& a, const Plane& b) {
  Plane product(a.width, a.height);
  for (std::size_t i = 0; i < product.values.size(); ++i) product.values[i] = a.values[i] * b.values[i];
  return product;
}

}  // namespace

Result<double> Ssim(const Image8& a, const Image8& b) {
  if (Result<void> same = CheckSameSize(a, b); !same.ok()) return same.error();
  const Taps across = GaussianTaps(a.width), down = GaussianTaps(a.height);
  const int margin_x = static_cast<int>(across.size() / 2), margin_y = static_cast<int>(down.size() / 2);
  const std::size_t windows =
      static_cast<std::size_t>(a.width - 2 * margin_x) * static_cast<std::size_t>(a.height - 2 * margin_y);
  // A window without a difference has a similarity of 1.
  const FilterRegion region = FilterRegion(a, b).Grown(margin_x, margin_y);
  if (region.empty()) return 1.0;
  const Plane x = Luma(a), y = Luma(b);
  const Plane mean_x = Filter(x, across, down, region), mean_y = Filter(y, across, down, region);
  const Plane xx = Filter(Product(x, x), across, down, region),
              yy = Filter(Product(y, y), across, down, region);
  const Plane xy = Filter(Product(x, y), across, down, region);

  // Average over the windows that lie entirely inside the picture.
  double less = 0;  // the sum of 1 − similarity
  region.ForRuns(margin_y, a.height - margin_y, [&](int row, int begin, int end) {
    for (int column = std::max(begin, margin_x); column < std::min(end, a.width - margin_x); ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * a.width + column;
      const double mx = mean_x.values[i], my = mean_y.values[i];
      const double vx = xx.values[i] - mx * mx, vy = yy.values[i] - my * my, cov = xy.values[i] - mx * my;
      less += 1 - (2 * mx * my + kC1) * (2 * cov + kC2) / ((mx * mx + my * my + kC1) * (vx + vy + kC2));
    }
  });
  return 1 - less / static_cast<double>(windows);
}

}  // namespace facetless
