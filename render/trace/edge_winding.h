// How an edge's image crosses the half-line from a pixel towards +x: odd or even. Summed over the border of a
// face, it says whether the border winds around the pixel an odd number of times.
//
//  1. The image of an edge is its projected curve, joined to the images of its two vertices by straight
//     lines: edges that share a vertex meet in it to the last bit, however far from it their curves end.
//     Without vertices it is the curve alone.
//  2. A crossing is counted by the half-open rule y < 0 <= y', so a chain that closes in its vertices crosses
//     the half-line an even number of times or winds around the pixel, whatever the rounding.
//  3. The answer depends on nothing but edge, view and pixel: all faces that use the edge get the same.
//  4. Nothing where the edge has no curve, or where part of it isn't in front of the eye.
#pragma once

#include <optional>

#include "render/trace/projected_edges.h"

namespace facetless {

// Whether `edge` crosses the half-line from pixel coordinates (x, y) an odd number of times.
std::optional<bool> CrossesHalfLine(const ProjectedEdges& edges, std::uint32_t edge, double x, double y);

}  // namespace facetless
