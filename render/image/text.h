// Plain words and numbers in pictures, without any font file.
//
//  1. Glyphs are strokes of one width: lines and arcs of ellipses, antialiased by their distance to a
//     pixel's centre.
//  2. There are the digits, the Latin letters, µ, and . , : - _ − + ± × / % ( ). Other characters are left
//     out: CanDraw tells.
//  3. The same bytes on every machine: no libm function is used.
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

bool CanDraw(std::string_view utf8);

// The width that DrawText takes, px.
double TextWidth(std::string_view utf8, const TextStyle& style);

// Draws over `image` with the left end of the baseline at (x, y). What lies outside is cut off.
void DrawText(Image8& image, double x, double y, std::string_view utf8, const TextStyle& style);

}  // namespace facetless
