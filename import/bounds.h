// Bounding boxes of trimmed faces of a model that is being built: render/model/bounds.h with the importer's
// parameters.
#pragma once

#include <vector>

#include "render/model/model.h"

namespace facetless {

// Returns a box that contains the trimmed face, in its part's frame.
Box3 FaceBounds(const Model& model, std::uint32_t face);

// Returns the box of all placed faces.
Box3 PlacedBounds(const Model& model);

}  // namespace facetless
