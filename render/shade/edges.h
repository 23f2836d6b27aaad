// Lines at silhouettes and creases, drawn over a shaded film. Private to render/shade.
#pragma once

#include "render/image/film.h"
#include "render/shade/shade.h"
#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

// Draws the edges of law 5 of shade.h over `film`, which was shaded from `samples`. Requires equal sizes.
// Runs in the task arena of the caller.
void DrawEdges(const SampleBuffer& samples, const CameraFrame& frame, const ShadeOptions& options,
               Film& film);

}  // namespace facetless
