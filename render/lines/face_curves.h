// Curves on trimmed faces on which a function vanishes: silhouettes, where the surface turns away from the
// viewer, and cuts, where it meets a section plane.
//
//  1. The curve is searched on a grid over the parameters of the face, with kCellsPerSpan cells per knot span
//     and direction. The grid is coarser if the whole face is small in the picture, and a face smaller than a
//     pixel is skipped. If the function changes its sign along a side of a cell, a point of the curve is
//     found by bracketing. Between two such points, more points on the curve are added until the chords lie
//     within kFlatness of the curve on the screen.
//  2. Parts outside the trimmed face are left out. The point where a curve leaves the face is found by
//     bisection.
//  3. A closed curve that lies within one cell is not found.
//  4. If the function vanishes on a whole face (a cylinder seen along its axis), there is no curve.
#pragma once

#include <vector>

#include "render/base/execution.h"
#include "render/lines/line.h"
#include "render/trace/direct.h"

namespace facetless {

// The curves on curved faces on which n · view = 0.
std::vector<ViewLine> SilhouetteLines(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                                      const Execution& execution = {});

// The curves in which faces meet `plane`.
std::vector<ViewLine> CutLines(const Scene& scene, const SectionPlane& plane, const Camera& camera,
                               const CameraFrame& frame, const Execution& execution = {});

}  // namespace facetless
