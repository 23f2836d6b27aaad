// Boxes of trimmed faces.
#pragma once

#include <vector>

#include "render/model/model.h"

namespace facetless {

// A box that holds the trimmed face, in its part's frame. Developable faces are bounded by their edges, others by the hulls of the finely
// divided patches over their loops' box. Conservative up to the gaps of the face's edges, which are added.
Box3 FaceBounds(const Model& model, std::uint32_t face);

// The box of all placed faces: part boxes are not turned, their faces' control hulls are.
Box3 PlacedBounds(const Model& model);

}  // namespace facetless
