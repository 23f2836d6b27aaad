// The diverging colour map of difference pictures.
#pragma once

#include <array>
#include <cstdint>

namespace facetless {

// sRGB of t in −1 … 1 (clamped): blue, near white at 0, orange-red. Even steps of t are even steps of
// lightness and chroma in Oklab (Ottosson 2020), the same on both sides; blue and orange differ for every
// common colour blindness.
std::array<std::uint8_t, 3> DivergingColor(double t);

}  // namespace facetless
