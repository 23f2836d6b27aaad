#include "render/image/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "render/image/compare_input.h"

namespace facetless {
namespace {

// Composes the picture over mid grey. Opaque pictures are returned unchanged.
std::vector<std::uint8_t> Composed(const Image8& image) {
  if (image.channels == 3) return image.bytes;
  const double grey = SrgbToLinear(0.5);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.bytes.size() / 4 * 3);
  for (std::size_t i = 0; i < image.bytes.size(); i += 4) {
    const std::uint8_t* p = &image.bytes[i];
    const double alpha = p[3] / 255.0;
    for (int c = 0; c < 3; ++c)
      bytes.push_back(p[3] == 255 ? p[c]
                                  : EncodeByte(static_cast<float>(alpha * SrgbToLinear(p[c] / 255.0) +
                                                                  (1 - alpha) * grey)));
  }
  return bytes;
}

// Compares bytes. There are few possible differences, so sums over their counts are exact and independent of
// the order.
void CompareBytes(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
                  ColorMetrics& metrics) {
  std::array<std::uint64_t, 256> counts{};
  std::uint64_t over = 0;
  for (std::size_t i = 0; i < a.size(); i += 3) {
    int largest = 0;
    for (std::size_t c = i; c < i + 3; ++c) {
      const int difference = std::abs(int{a[c]} - int{b[c]});
      ++counts[static_cast<std::size_t>(difference)];
      largest = std::max(largest, difference);
    }
    over += largest / 255.0 > metrics.threshold ? 1 : 0;
  }
  std::uint64_t sum = 0, squares = 0;
  for (std::uint64_t difference = 0; difference < counts.size(); ++difference) {
    if (counts[difference] > 0) metrics.max = static_cast<double>(difference) / 255;
    sum += difference * counts[difference];
    squares += difference * difference * counts[difference];
  }
  const double values = static_cast<double>(a.size());
  metrics.mean = static_cast<double>(sum) / 255 / values;
  metrics.rms = std::sqrt(static_cast<double>(squares) / values) / 255;
  metrics.psnr = squares > 0 ? -20 * std::log10(metrics.rms) : std::numeric_limits<double>::infinity();
  metrics.share_over_threshold = static_cast<double>(over) / (values / 3);
}

// The value that a share `share` of the values does not exceed (nearest rank).
double Percentile(std::vector<float>& values, double share) {
  const std::size_t rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace

Result<void> CheckSameSize(const Image8& a, const Image8& b) {
  if (a.width != b.width || a.height != b.height)
    return Error{ErrorCode::kSizeMismatch, "the pictures have different sizes: " + std::to_string(a.width) +
                                               "×" + std::to_string(a.height) + " and " +
                                               std::to_string(b.width) + "×" + std::to_string(b.height)};
  for (const Image8* image : {&a, &b})
    if (image->width < 1 || image->height < 1 || (image->channels != 3 && image->channels != 4) ||
        image->bytes.size() != static_cast<std::size_t>(image->width) * image->height * image->channels)
      return Error{ErrorCode::kBadUsage,
                   "a picture is empty, or its size and its number of bytes do not match"};
  return {};
}

Result<ColorMetrics> CompareColors(const Image8& a, const Image8& b, const ColorMetricOptions& options) {
  if (Result<void> same = CheckSameSize(a, b); !same.ok()) return same.error();
  if (!(options.threshold >= 0 && options.threshold <= 1))
    return Error{ErrorCode::kBadUsage, "the colour threshold must lie between 0 and 1"};

  const std::vector<std::uint8_t> bytes_a = Composed(a), bytes_b = Composed(b);
  ColorMetrics metrics;
  metrics.threshold = options.threshold;
  metrics.pixels_per_degree = options.pixels_per_degree;
  CompareBytes(bytes_a, bytes_b, metrics);

  const Result<double> ssim = Ssim(a, b);
  if (!ssim.ok()) return ssim.error();
  metrics.ssim = ssim.value();
  Result<std::vector<float>> flip = FlipMap(a, b, options.pixels_per_degree);
  if (!flip.ok()) return flip.error();
  double sum = 0;
  for (float value : flip.value()) sum += value;
  metrics.flip_mean = sum / static_cast<double>(flip.value().size());
  metrics.flip_p95 = Percentile(flip.value(), 0.95);

  for (double value : {metrics.max, metrics.mean, metrics.rms, metrics.ssim, metrics.flip_mean,
                       metrics.flip_p95, metrics.share_over_threshold})
    if (!std::isfinite(value)) return Error{ErrorCode::kNotFinite, "a colour metric is not a number"};
  return metrics;
}

}  // namespace facetless
