// Film: a picture in linear light. Image8: the same as people's screens want it.
//
//  1. Film holds linear Rec. 709 red, green, blue, multiplied by alpha, and alpha; row-major, row 0 on top.
//  2. Image8 holds sRGB-encoded bytes, alpha not multiplied in; three channels where everything is opaque,
//     else four.
//  3. Encode gives the same bytes on every machine: its curve is a table of exact thresholds, no library's
//     pow.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/base/large_pages.h"
#include "render/base/result.h"

namespace facetless {

struct Film {
  int width = 0, height = 0;
  std::vector<std::array<float, 4>, LargePages<std::array<float, 4>>> pixels;  // r·a, g·a, b·a, a
};

struct Image8 {
  int width = 0, height = 0, channels = 3;  // 3: RGB; 4: RGBA
  std::vector<std::uint8_t> bytes;          // width·height·channels

  const std::uint8_t* at(int x, int y) const { return &bytes[(std::size_t(y) * width + x) * channels]; }
  std::uint8_t* at(int x, int y) { return &bytes[(std::size_t(y) * width + x) * channels]; }
};

// Box filter: each pixel of the result is the mean of samples_x × samples_y of the film's, in linear light,
// summed in a fixed order. Requires that samples_x divides the width and samples_y the height
// (kSizeMismatch).
Result<Film> Resolve(Film samples, int samples_x, int samples_y);

// Numbers outside 0 … 1 are clamped. Error: kNotFinite names the first pixel with a NaN or an infinity.
Result<Image8> Encode(const Film& film);

// The sRGB transfer curve, within 1e-7 of the exact one, the same on every machine; 0 … 1, clamped.
double SrgbToLinear(double encoded);
double LinearToSrgb(double linear);

// One sRGB byte for a linear value: the nearest of the 256.
std::uint8_t EncodeByte(float linear);

}  // namespace facetless
