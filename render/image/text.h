// Drawing words and numbers in pictures, without a font file.
//
//     const TextStyle style{.size_px = 14};
//     DrawText(image, 10 - TextWidth("10 mm", style) / 2, 20, "10 mm", style);
//
//  1. Glyphs are strokes of constant width, consisting of lines and elliptical arcs. They are antialiased by
//     their distance from the centre of a pixel.
//  2. The font has the digits, the Latin letters, µ, and . , : - _ − + ± × / % ( ). Other characters are not
//     drawn; CanDraw checks a text for them.
//  3. No libm function is used, so the bytes are the same on every machine.
#pragma once

#include <cstdint>
#include <string_view>

#include "render/image/film.h"

namespace facetless {

struct TextStyle {
  double size_px = 12;                   // height of a digit
  double weight = 0.13;                  // stroke width as a share of the size
  std::uint8_t color[3] = {40, 40, 44};  // sRGB
};

// Returns whether the font has all characters of the text.
bool CanDraw(std::string_view utf8);

// The width of the text as drawn by DrawText, px.
double TextWidth(std::string_view utf8, const TextStyle& style);

// Draws the text over `image`, with the left end of the baseline at (x, y). The text is clipped to the image.
void DrawText(Image8& image, double x, double y, std::string_view utf8, const TextStyle& style);

}  // namespace facetless
