// Metrics of the difference between two pictures, numerical and perceptual.
//
//     Result<ColorMetrics> metrics = CompareColors(a, b, {.threshold = 2.0 / 255});
//     if (metrics) Print(metrics.value().rms, metrics.value().flip_mean);
//
//  1. The sizes are compared first (kSizeMismatch). The inputs are bytes, so they cannot be NaN. Every result
//     is checked to be finite, except psnr, which is +inf for equal pictures.
//  2. Transparent pictures are first composed over mid grey.
//  3. max, mean, rms, psnr and the share are computed from the encoded values (0 … 1) of all three channels,
//     as defined by idiff (tests/unit/image compares them with OpenImageIO's).
//  4. SSIM follows Wang et al. 2004: on luma, with a Gaussian window of 11 pixels, σ = 1.5, K1 = 0.01, K2 =
//     0.03, and with windows entirely inside the picture. It is 1 for equal pictures. Pictures smaller than
//     the window use the largest window that fits.
//  5. FLIP follows Andersson et al. 2020, LDR. It is an error of 0 … 1 per pixel, for a viewing distance that
//     is given as pixels per degree.
#pragma once

#include <vector>

#include "render/base/result.h"
#include "render/image/film.h"

namespace facetless {

struct ColorMetricOptions {
  double threshold = 1.0 / 255;   // a pixel counts as different if a channel differs by more than this
  double pixels_per_degree = 67;  // for FLIP; 67: a screen 0.7 m wide with 3,840 pixels, seen from 0.7 m
};

struct ColorMetrics {
  double max = 0, mean = 0, rms = 0;            // 0 … 1
  double psnr = 0;                              // dB; +inf for equal pictures
  double ssim = 1;                              // −1 … 1
  double flip_mean = 0, flip_p95 = 0;           // 0 … 1
  double share_over_threshold = 0;              // share of the pixels that differ, 0 … 1
  double threshold = 0, pixels_per_degree = 0;  // the options that were used
};

// Compares two pictures. Errors: kSizeMismatch; kBadUsage (an empty picture, options out of range).
Result<ColorMetrics> CompareColors(const Image8& a, const Image8& b, const ColorMetricOptions& options);

// The FLIP error map, row-major, 0 … 1. Errors: the errors of CompareColors.
Result<std::vector<float>> FlipMap(const Image8& reference, const Image8& test, double pixels_per_degree);

// SSIM alone. Errors: the errors of CompareColors.
Result<double> Ssim(const Image8& a, const Image8& b);

}  // namespace facetless
