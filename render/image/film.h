// Film: a picture in linear light. Image8: a picture encoded for display.
//
//     Result<Film> film = Resolve(std::move(samples), 2, 2);
//     if (!film) return film.error();
//     Result<Image8> image = Encode(film.value());
//
//  1. A Film holds linear Rec. 709 red, green and blue, multiplied by alpha, and alpha. It is row-major, with
//     row 0 at the top.
//  2. An Image8 holds sRGB-encoded bytes that are not multiplied by alpha. It has three channels if all
//     pixels are opaque, and four otherwise.
//  3. Encode gives the same bytes on every machine: its curve is a table of exact thresholds, and it does not
//     call pow.
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

// Applies a box filter: each pixel of the result is the mean of samples_x × samples_y pixels of `samples`, in
// linear light, summed in a fixed order. Error: kSizeMismatch (samples_x does not divide the width, or
// samples_y the height).
Result<Film> Resolve(Film samples, int samples_x, int samples_y);

// Encodes a film as sRGB. Values outside 0 … 1 are clamped. Error: kNotFinite, which names the first pixel
// with a NaN or an infinity.
Result<Image8> Encode(const Film& film);

// The sRGB transfer curve for 0 … 1 (clamped), within 1e-7 of the exact curve, and the same on every machine.
double SrgbToLinear(double encoded);
double LinearToSrgb(double linear);

// The sRGB byte nearest to a linear value.
std::uint8_t EncodeByte(float linear);

}  // namespace facetless
