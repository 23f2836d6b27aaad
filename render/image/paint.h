// Strokes and areas over a picture, antialiased.
//
//  1. Coordinates are pixels as in camera.h: the centre of pixel (i, j) is (i + 0.5, j + 0.5). What lies
//     outside is cut off.
//  2. Colours are mixed in linear light. On a transparent picture (4 channels) what is drawn covers: alpha
//     grows with it.
//  3. The same bytes on every machine: no libm function is used.
#pragma once

#include <array>
#include <cstdint>

#include "render/base/vec.h"
#include "render/image/film.h"

namespace facetless {

using Rgb8 = std::array<std::uint8_t, 3>;  // sRGB

// Covers `cover` (0 … 1) of a pixel of 3 or 4 channels.
void CoverPixel(std::uint8_t* pixel, int channels, const Rgb8& color, double cover);

// A line with round ends; a dot where both are the same.
void DrawStroke(Image8& image, Vec2 from, Vec2 to, double width, const Rgb8& color, double cover = 1);

// A rectangle; borders that lie on pixel borders are crisp.
void FillRectangle(Image8& image, Vec2 low, Vec2 high, const Rgb8& color, double cover = 1);

// The distance of p to the line from `from` to `to`.
double DistanceToSegment(Vec2 from, Vec2 to, Vec2 p);

}  // namespace facetless
