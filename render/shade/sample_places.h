// Where the samples lie in the picture that they are samples of. Private to render/shade.
#pragma once

#include <cstddef>

#include "render/view/refinement.h"
#include "render/view/samples.h"

namespace facetless {

// Returns a function that gives the column and the row of sample i of a view.
inline auto PlacesOf(const SampleBuffer& samples) {
  return [width = static_cast<std::size_t>(samples.width)](std::size_t i) {
    return SamplePlace{static_cast<int>(i % width), static_cast<int>(i / width)};
  };
}

// The same for the samples of refined pixels, in the supersampled picture. The refinement must outlive the function.
inline auto PlacesOf(const Refinement& refinement) {
  return [&refinement, count = static_cast<std::size_t>(refinement.grid.count())](std::size_t i) {
    return PlaceOfSample(refinement.pixels.pixels()[i / count], refinement.pixels.width(), refinement.grid,
                         static_cast<int>(i % count));
  };
}

}  // namespace facetless
