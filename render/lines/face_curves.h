// Curves on trimmed faces where something vanishes: silhouettes, where the surface turns away from the
// viewer, and cuts, where it meets a section plane.
//
//  1. The curve is sought on a grid over the face's parameters, kCellsPerSpan cells for each of its knot
//     spans and direction; fewer where the whole face is small in the picture, and none where it is smaller
//     than a pixel. Where the value changes its sign along a side of a cell a place of the curve is found by
//     bracketing; between two such places it is refined, point by point on the curve, until chords lie within
//     kFlatness of it on the screen.
//  2. Parts outside the trimming are left out; where a curve leaves the face is bisected.
//  3. A closed curve that lies within one cell is not found.
//  4. What vanishes on a whole face (a cylinder seen along its axis) gives no curve.
#pragma once

#include <vector>

#include "render/base/execution.h"
#include "render/lines/line.h"
#include "render/trace/direct.h"

namespace facetless {

// Where n · view = 0 on curved faces.
std::vector<ViewLine> SilhouetteLines(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                                      const Execution& execution = {});

// Where faces meet `plane`.
std::vector<ViewLine> CutLines(const Scene& scene, const SectionPlane& plane, const Camera& camera,
                               const CameraFrame& frame, const Execution& execution = {});

}  // namespace facetless
