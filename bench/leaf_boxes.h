// The boxes of a model's surfaces in world space, for comparing structures that find surfaces for a ray.
//
//     const std::vector<Box3> boxes = LeafBoxes(model, 200'000);
//
//  1. Every patch of every placed face is halved until each piece is nearly a parallelogram: until its
//     control points lie within kLeafFlatness of its diagonal from the bilinear patch through its corners. A
//     piece that is trimmed away has no box.
//  2. A box holds the control points of its piece, and therefore the piece.
//  3. Division ends when there are `most` boxes; what is left then gets one box per piece, flat or not.
#pragma once

#include <cstddef>
#include <vector>

#include "render/model/model.h"

namespace facetless {

inline constexpr double kLeafFlatness = 0.05;

std::vector<Box3> LeafBoxes(const Model& model, std::size_t most);

}  // namespace facetless
