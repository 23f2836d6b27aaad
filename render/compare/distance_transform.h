// Exact Euclidean distances in a mask.
#pragma once

#include <cstdint>
#include <vector>

namespace facetless {

// For each pixel the squared distance, in pixels, from its centre to the centre of the nearest set pixel of
// `mask` (row-major, width·height); −1 everywhere if none is set. Felzenszwalb and Huttenlocher 2012, in
// integers, so exact; O(pixels).
std::vector<std::int64_t> SquaredDistances(const std::vector<std::uint8_t>& mask, int width, int height);

}  // namespace facetless
