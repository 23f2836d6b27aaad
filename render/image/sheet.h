// Contact sheets: many pictures side by side, each with its label.
//
//     Result<Image8> picture = Reduced(image, kSheetTile);
//     if (picture) tiles.push_back({std::move(picture).value(), "front"});
//     Result<Image8> sheet = DrawSheet(tiles, SheetColumns(tiles.size()));
//
//  1. Pictures are reduced to fit kSheetTile pixels, and never enlarged. Each new pixel is the mean of the
//     area that it covers, in linear light.
//  2. All tiles have the size of the largest picture. They are arranged row by row on a paper-coloured
//     background, which also shows through transparent pixels.
//  3. The bytes are the same on every machine and for any number of threads.
#pragma once

#include <string>
#include <vector>

#include "render/image/film.h"

namespace facetless {

inline constexpr int kSheetTile = 480;

struct SheetTile {
  Image8 picture;  // a result of Reduced
  std::string label;
};

// The picture, composed over the paper colour and reduced to at most `most` pixels on a side.
Result<Image8> Reduced(const Image8& picture, int most);

// The number of columns for `count` pictures that makes the sheet about square.
int SheetColumns(std::size_t count);

// Draws the sheet. Errors: kBadUsage (there is no tile), kLimitExceeded (more than 65,536 pixels on a side).
Result<Image8> DrawSheet(const std::vector<SheetTile>& tiles, int columns);

}  // namespace facetless
