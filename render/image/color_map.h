// The colour maps of pictures that show numbers. They use no libm function and give the same bytes on every
// machine.
#pragma once

#include <array>
#include <cstdint>

namespace facetless {

// The sRGB colour of t in −1 … 1 (clamped): from blue through near white at 0 to orange-red. Equal steps of t
// are equal steps of lightness and chroma in Oklab (Ottosson 2020), symmetric about 0. Blue and orange remain
// distinct for all common kinds of colour blindness.
std::array<std::uint8_t, 3> DivergingColor(double t);

// The sRGB colour of t in 0 … 1 (clamped): from dark violet through green to light yellow. Equal steps of t
// are equal steps of lightness, so the order is visible in greyscale, too.
std::array<std::uint8_t, 3> SequentialColor(double t);

// An sRGB colour for each category. Consecutive numbers differ in hue, and the lightness cycles through three
// levels.
std::array<std::uint8_t, 3> CategoryColor(std::uint32_t number);

}  // namespace facetless
