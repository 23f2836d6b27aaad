// The edges of a model as lines of a view.
//
//  1. The class of an edge depends on the part, not on the view. An edge is a seam if both of its coedges
//     belong to one face, and a boundary if it is used once. Otherwise the largest angle along the p-curves
//     between the outward normals of its two faces decides whether it is a feature or smooth. An edge of more
//     than two faces is a feature.
//  2. Each segment of an edge is projected as a rational Bézier curve, and halved until its projected control
//     points, whose convex hull contains the curve, lie within kFlatness of the chord. In perspective views,
//     parts that are not in front of the eye are left out. Edges smaller than a tenth of a pixel are left
//     out, too.
#pragma once

#include <vector>

#include "render/base/execution.h"
#include "render/lines/line.h"
#include "render/trace/direct.h"

namespace facetless {

// The class of each edge, indexed like Model::edges. An edge is a feature if the angle exceeds
// `edge_angle_deg`, or if no coedge uses it.
std::vector<LineClass> ClassifyEdges(const Model& model, double edge_angle_deg);

std::vector<ViewLine> EdgeLines(const Model& model, const std::vector<LineClass>& classes,
                                const Camera& camera, const CameraFrame& frame,
                                const Execution& execution = {});

}  // namespace facetless
