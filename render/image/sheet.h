// Contact sheets: many pictures side by side, each with its name.
//
//  1. Pictures are reduced to fit kSheetTile pixels, by the mean of what each new pixel covers, in linear
//     light; never enlarged.
//  2. Tiles are of one size, that of the largest picture; they lie row by row on paper, which also shows
//     through what is transparent.
//  3. The same bytes on every machine and for any number of threads.
#pragma once

#include <string>
#include <vector>

#include "render/image/film.h"

namespace facetless {

inline constexpr int kSheetTile = 480;

struct SheetTile {
  Image8 picture;  // as Reduced gives it
  std::string label;
};

// The picture on paper, opaque, at most `most` pixels on a side.
Result<Image8> Reduced(const Image8& picture, int most);

// Columns for `count` pictures of one kind: as many as make the sheet about square.
int SheetColumns(std::size_t count);

// Errors: kBadUsage (no tile), kLimitExceeded (more than 65,536 pixels on a side).
Result<Image8> DrawSheet(const std::vector<SheetTile>& tiles, int columns);

}  // namespace facetless
