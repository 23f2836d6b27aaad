// Parts of a view that are thinner than a pixel: rays through pixel centres pass beside them.
//
//  1. A pixel is marked if a piece of a face passes through it, may be nearer than what its centre shows, and the
//     face is shown at none of the nine centres around.
//  2. Pieces are found in two ways. The edges of faces are walked: a narrow face has edges in each pixel that it
//     crosses. The leaves whose image is narrower than a pixel are walked along their length: wires and tips have
//     such leaves, and no edges beside them.
//  3. A mark costs samples and changes nothing else. Where depths are close, pixels may therefore be marked without need.
#pragma once

#include "render/trace/prepare.h"
#include "render/view/refinement.h"

namespace facetless {

// Adds the pixels of law 1 to `pixels`. `view` was prepared with DirectOptions::refine; `centres` are the samples of its
// pixel centres.
void MarkThinParts(const Scene::Data& scene, const PreparedView& view, const CameraFrame& frame,
                   const SampleBuffer& centres, PixelSet* pixels);

}  // namespace facetless
