// Sorting the crossings of rays, which the tile tracer finds leaf by leaf and which sections need by depth.
#pragma once

#include <vector>

#include "render/trace/tile_tracer.h"

namespace facetless {

// Sorts the crossings by sample and depth. If two leaves of one face found the same root (RootTwin), only one
// crossing is kept. The order is total and depends only on the view.
void SortCrossings(const PreparedView& view, std::vector<Crossing>* crossings);

}  // namespace facetless
