// Drawing antialiased strokes and rectangles over a picture.
//
//     DrawStroke(image, {10, 10}, {90, 10}, 2.0, {255, 0, 0});
//
//  1. Coordinates are pixels as in camera.h: the centre of pixel (i, j) is (i + 0.5, j + 0.5). Strokes and
//     rectangles are clipped to the picture.
//  2. Colours are mixed in linear light. In a picture with an alpha channel, drawing increases alpha.
//  3. No libm function is used, so the bytes are the same on every machine.
#pragma once

#include <array>
#include <cstdint>

#include "render/base/vec.h"
#include "render/image/film.h"

namespace facetless {

using Rgb8 = std::array<std::uint8_t, 3>;  // sRGB

// Paints the share `cover` (0 … 1) of a pixel with 3 or 4 channels.
void CoverPixel(std::uint8_t* pixel, int channels, const Rgb8& color, double cover);

// Draws a line with round ends, or a dot if both ends are the same point. `width` is in pixels.
void DrawStroke(Image8& image, Vec2 from, Vec2 to, double width, const Rgb8& color, double cover = 1);

// Fills a rectangle. Its borders are sharp if they lie on pixel borders.
void FillRectangle(Image8& image, Vec2 low, Vec2 high, const Rgb8& color, double cover = 1);

// The distance of p from the line segment between `from` and `to`.
double DistanceToSegment(Vec2 from, Vec2 to, Vec2 p);

}  // namespace facetless
