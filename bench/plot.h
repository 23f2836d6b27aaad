// The first image of each file as a picture: bars of the direct renderer and of both meshes, on a logarithmic
// scale, as SVG.
#pragma once

#include <string>
#include <vector>

#include "bench/aims.h"

namespace facetless {

// Of the values of rows 1 and 2 on `threads` threads; the same values give the same bytes. Without any: a
// picture that says so.
std::string FirstImagePlot(const std::vector<BenchValue>& values, int threads);

}  // namespace facetless
