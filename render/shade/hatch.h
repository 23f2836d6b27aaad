// Hatching of section caps: parallel lines in the plane of the picture, as in technical drawings.
//
//  1. The lines are kHatchSpacing pixels apart and fixed in the picture. The lines of the first solid have an
//     angle of 45°, those of the second 135°, and others lie in between, so that adjacent solids can be
//     distinguished.
//  2. The coverage is that of a sample one pixel wide, so the lines are smooth even with one sample per
//     pixel.
//  3. No libm function is used.
#pragma once

#include <cstdint>

namespace facetless {

inline constexpr double kHatchSpacing = 9, kHatchWidth = 1.1;  // pixels

// The share, 0 … 1, of the sample at the pixel coordinates (x, y) that the lines of `solid` cover.
float HatchCover(double x, double y, std::uint32_t solid);

}  // namespace facetless
