// The colour maps of pictures that show numbers. No libm: the same bytes on every machine.
#pragma once

#include <array>
#include <cstdint>

namespace facetless {

// sRGB of t in −1 … 1 (clamped): blue, near white at 0, orange-red. Even steps of t are even steps of
// lightness and chroma in Oklab (Ottosson 2020), the same on both sides; blue and orange differ for every
// common colour blindness.
std::array<std::uint8_t, 3> DivergingColor(double t);

// sRGB of t in 0 … 1 (clamped): dark violet, green, light yellow. Even steps of t are even steps of
// lightness, so that the order can be read without colours, too.
std::array<std::uint8_t, 3> SequentialColor(double t);

// sRGB colours for things that are only to be told apart: neighbours in number differ in hue, and thirds in
// lightness.
std::array<std::uint8_t, 3> CategoryColor(std::uint32_t number);

}  // namespace facetless
