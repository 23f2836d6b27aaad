// The edges of a model as lines of a view.
//
//  1. An edge's class is the part's own, not the view's: a seam if both of its coedges belong to one face, a
//     boundary if it is used once, else a feature or smooth by the largest angle between the outward normals
//     of its two faces, along the p-curves. An edge of more than two faces is a feature.
//  2. Each edge is projected segment by segment as the rational Bézier curve that it is, and halved until its
//     projected control points lie within kFlatness of the chord: the convex hull holds the curve. In
//     perspective what is not in front of the eye is left out; so is an edge that is smaller than a tenth of
//     a pixel.
#pragma once

#include <vector>

#include "render/base/execution.h"
#include "render/lines/line.h"
#include "render/trace/direct.h"

namespace facetless {

// By edge, as Model::edges. `edge_angle_deg`: above it an edge is a feature. Edges of no coedge count as
// features.
std::vector<LineClass> ClassifyEdges(const Model& model, double edge_angle_deg);

std::vector<ViewLine> EdgeLines(const Model& model, const std::vector<LineClass>& classes,
                                const Camera& camera, const CameraFrame& frame,
                                const Execution& execution = {});

}  // namespace facetless
