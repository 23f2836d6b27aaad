// Boxes of trimmed faces, for a model in the making: render/model/bounds.h with the importer's parameters.
#pragma once

#include <vector>

#include "render/model/model.h"

namespace facetless {

// A box that holds the trimmed face, in its part's frame.
Box3 FaceBounds(const Model& model, std::uint32_t face);

// The box of all placed faces.
Box3 PlacedBounds(const Model& model);

}  // namespace facetless
