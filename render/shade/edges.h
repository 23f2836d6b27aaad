// Lines at silhouettes and creases, over a shaded film. Private to shade/.
#pragma once

#include "render/image/film.h"
#include "render/shade/shade.h"
#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

// Draws shade.h's law 5 over `film`, which was shaded from `samples`. Requires equal sizes. Runs in the
// caller's task arena.
void DrawEdges(const SampleBuffer& samples, const CameraFrame& frame, const ShadeOptions& options,
               Film& film);

}  // namespace facetless
