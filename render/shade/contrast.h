// Contrast: the pixels of a shaded picture within which the colour may change, for adaptive supersampling.
//
//  1. A pixel has contrast if along a row, a column or a diagonal its colour differs from the mean of its two
//     neighbours by more than kMostBend / 2, in any channel. A step, a line, a corner or a change of slope has contrast
//     on both of its sides; a smooth gradient has none, and there the mean of samples is the colour of the centre.
//  2. Colours are compared in the square root of linear light, which is close to how they are displayed.
//  3. Beyond the border of the picture, a pixel continues.
#pragma once

#include "render/image/film.h"
#include "render/view/refinement.h"

namespace facetless {

inline constexpr float kMostBend = 5.0f / 255;

// Adds the pixels of `film` with contrast to `pixels`, which has the film's size. Runs in the task arena of the caller.
void AddContrast(const Film& film, PixelSet* pixels);

}  // namespace facetless
