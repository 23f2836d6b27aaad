#include "render/image/metrics.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "render/image/compare_input.h"

namespace facetless {
namespace {

// Bytes over mid grey: what OpenImageIO compares. Opaque pictures pass unchanged.
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

// The value that `share` of the values do not exceed (nearest rank).
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
      return Error{ErrorCode::kBadUsage, "a picture is empty, or its size and its bytes disagree"};
  return {};
}

Result<ColorMetrics> CompareColors(const Image8& a, const Image8& b, const ColorMetricOptions& options) {
  if (Result<void> same = CheckSameSize(a, b); !same.ok()) return same.error();
  if (!(options.threshold >= 0 && options.threshold <= 1))
    return Error{ErrorCode::kBadUsage, "the colour threshold must lie between 0 and 1"};

  // What OpenImageIO offers.
  std::vector<std::uint8_t> bytes_a = Composed(a), bytes_b = Composed(b);
  const OIIO::ImageSpec spec(a.width, a.height, 3, OIIO::TypeDesc::UINT8);
  const OIIO::ImageBuf buffer_a(spec, bytes_a.data()), buffer_b(spec, bytes_b.data());
  const float threshold = static_cast<float>(options.threshold);
  const OIIO::ImageBufAlgo::CompareResults compared =
      OIIO::ImageBufAlgo::compare(buffer_a, buffer_b, threshold, threshold);
  // CompareResults::error says nothing (OpenImageIO 2.4 sets it where it succeeded); the buffers keep what went wrong.
  if (buffer_a.has_error() || buffer_b.has_error())
    return Error{ErrorCode::kInternal,
                 "OpenImageIO cannot compare the pictures: " + buffer_a.geterror() + buffer_b.geterror()};
  ColorMetrics metrics;
  metrics.threshold = options.threshold;
  metrics.pixels_per_degree = options.pixels_per_degree;
  metrics.max = compared.maxerror;
  metrics.mean = compared.meanerror;
  metrics.rms = compared.rms_error;
  metrics.psnr = compared.rms_error > 0 ? compared.PSNR : std::numeric_limits<double>::infinity();
  metrics.share_over_threshold =
      static_cast<double>(compared.nfail) / (static_cast<double>(a.width) * a.height);

  // What it does not.
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
