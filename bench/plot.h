// Draws the times of the first images of each file: bars for the direct renderer and for both meshes, on a
// logarithmic scale, as SVG.
#pragma once

#include <string>
#include <vector>

#include "bench/aims.h"

namespace facetless {

// Plots the values of rows 1 and 2 for `threads` threads. The same values give the same bytes. Without
// values, the picture says so.
std::string FirstImagePlot(const std::vector<BenchValue>& values, int threads);

}  // namespace facetless
