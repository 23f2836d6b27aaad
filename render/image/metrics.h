// How different two pictures are, for numbers and for eyes.
//
//  1. Sizes are compared first (kSizeMismatch). Inputs are bytes, so there is no NaN to hide; every number
//     that comes out is checked to be finite, psnr excepted, which is +inf for equal pictures.
//  2. Transparent pictures are composed over mid grey first, both alike.
//  3. max, mean, rms, psnr and the share are over the encoded values (0 … 1), all three channels: what
//     idiff calls them (tests/unit/image holds them to OpenImageIO's).
//  4. SSIM: Wang et al. 2004, on luma, Gaussian window of 11 pixels with σ = 1.5, K1 = 0.01, K2 = 0.03,
//     windows wholly inside the picture; 1 for equal pictures. Pictures smaller than the window use the
//     window that fits.
//  5. FLIP: Andersson et al. 2020, LDR; an error of 0 … 1 per pixel at a viewing distance stated as pixels
//     per degree.
#pragma once

#include <vector>

#include "render/base/result.h"
#include "render/image/film.h"

namespace facetless {

struct ColorMetricOptions {
  double threshold = 1.0 / 255;   // a pixel counts as different if one channel differs by more
  double pixels_per_degree = 67;  // FLIP: a 0.7 m wide screen of 3,840 pixels seen from 0.7 m
};

struct ColorMetrics {
  double max = 0, mean = 0, rms = 0;            // 0 … 1
  double psnr = 0;                              // dB; +inf for equal pictures
  double ssim = 1;                              // −1 … 1
  double flip_mean = 0, flip_p95 = 0;           // 0 … 1
  double share_over_threshold = 0;              // of the pixels, 0 … 1
  double threshold = 0, pixels_per_degree = 0;  // as they were used
};

// Errors: kSizeMismatch; kBadUsage (an empty picture, options out of range).
Result<ColorMetrics> CompareColors(const Image8& a, const Image8& b, const ColorMetricOptions& options);

// FLIP's error map, row-major, 0 … 1. Errors as above.
Result<std::vector<float>> FlipMap(const Image8& reference, const Image8& test, double pixels_per_degree);

// SSIM alone. Errors as above.
Result<double> Ssim(const Image8& a, const Image8& b);

}  // namespace facetless
