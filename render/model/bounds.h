// Bounding boxes of trimmed faces and of placed instances.
//
//  1. The box of a developable face bounds its edges. The box of any other face bounds the control hulls of
//     its patches, finely divided, over the box of its loops. The gaps between the face and its edges are
//     added, so the boxes are conservative.
//  2. The caller supplies the map from native to Bézier parameters: the importer uses the tangent of the C
//     library, the renderer its own, which gives the same bits on every processor.
#pragma once

#include <vector>

#include "render/model/model.h"

namespace facetless {

// Maps a native parameter in the span to the span's Bézier parameter.
using SpanToBezier = double (*)(const Span& span, double native);

// A box that contains the trimmed face, in the frame of its part.
Box3 FaceBounds(const Model& model, std::uint32_t face, SpanToBezier to_bezier);

// The boxes of all placed instances. They bound the transformed control hulls of the faces, not the
// transformed box of the part. The box of an instance without faces is empty.
std::vector<Box3> InstanceBounds(const Model& model, SpanToBezier to_bezier);

// The smallest box that contains all boxes.
Box3 Union(const std::vector<Box3>& boxes);

}  // namespace facetless
