// Hatching of cut faces: parallel lines in the picture's plane, as drawings have them.
//
//  1. Lines are kHatchSpacing pixels apart and stand still in the picture. The first solid's run at 45°, the
//     second's at 135°, others between, so that neighbours are told apart.
//  2. The cover of a line is that of a sample one pixel wide: smooth with one sample per pixel too.
//  3. No libm function.
#pragma once

#include <cstdint>

namespace facetless {

inline constexpr double kHatchSpacing = 9, kHatchWidth = 1.1;  // pixels

// How much of the sample at pixel coordinates (x, y) a line of `solid` covers, 0 … 1.
float HatchCover(double x, double y, std::uint32_t solid);

}  // namespace facetless
