// The crossings of rays put in order: what sections ask of the tile tracer, which finds them leaf by leaf.
#pragma once

#include <vector>

#include "render/trace/tile_tracer.h"

namespace facetless {

// Sorts by sample and depth. Of the roots that two leaves of one face own in common (RootTwin) one is left.
// The order is total: it depends on nothing but the view.
void PutInOrder(const PreparedView& view, std::vector<Crossing>* crossings);

}  // namespace facetless
