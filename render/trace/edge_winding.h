// Edge winding: whether the image of an edge crosses the half-line from a pixel towards +x an odd or an even
// number of times. The sum over the border of a face shows whether the border winds around the pixel an odd
// number of times.
//
//  1. The image of an edge is its projected curve, joined to the images of its two vertices by straight
//     lines. Edges that share a vertex therefore meet in it exactly, however far from it their curves end.
//     The image of an edge without vertices is the curve alone.
//  2. Crossings are counted by the half-open rule y < 0 <= y'. A closed chain of edges therefore either
//     crosses the half-line an even number of times or winds around the pixel, whatever the rounding.
//  3. The answer depends only on the edge, the view and the pixel, so all faces that use the edge get the
//     same answer.
//  4. There is no answer if the edge has no curve, or if part of it is not in front of the eye.
#pragma once

#include <optional>

#include "render/trace/projected_edges.h"

namespace facetless {

// Returns whether `edge` crosses the half-line from the pixel coordinates (x, y) an odd number of times.
std::optional<bool> CrossesHalfLine(const ProjectedEdges& edges, std::uint32_t edge, double x, double y);

}  // namespace facetless
