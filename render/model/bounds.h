// Boxes of trimmed faces and of what is placed.
//
//  1. Developable faces are bounded by their edges, others by the hulls of the finely divided patches over
//     their loops' box. Conservative up to the gaps of the face's edges, which are added.
//  2. How a native parameter becomes a Bézier one is the caller's to say: the importer uses the C library's
//     tangent, the renderer its own, which is the same on every processor.
#pragma once

#include <vector>

#include "render/model/model.h"

namespace facetless {

// The Bézier parameter of a native parameter in the span.
using SpanToBezier = double (*)(const Span& span, double native);

// A box that holds the trimmed face, in its part's frame.
Box3 FaceBounds(const Model& model, std::uint32_t face, SpanToBezier to_bezier);

// The boxes of all instances, as placed: part boxes are not turned, their faces' control hulls are. Empty for
// an instance without faces.
std::vector<Box3> InstanceBounds(const Model& model, SpanToBezier to_bezier);

// The box of all.
Box3 Union(const std::vector<Box3>& boxes);

}  // namespace facetless
