// Points of edges, at the parameter of the 3D curve that two faces share.
#pragma once

#include "render/base/vec.h"
#include "render/model/model.h"

namespace facetless {

struct EdgePoint {
  Vec3 position;  // part coordinates, mm
  Vec3 tangent;   // unit; 0 where the curve stands still
};

// The segment of the edge that holds the parameter, at a joint the first of the two; beyond the edge's ends
// the segment there. Requires an edge that is not degenerate.
const EdgeSegment& SegmentAt(const Model& model, const Edge& edge, double parameter);

// Of the edge's 3D curve; beyond its ends the end.
EdgePoint PointOfEdge(const Model& model, const Edge& edge, double parameter);

// Of the coedge's p-curve, native parameters: the point that stands for the edge's `parameter`, or the
// nearest that does for any.
Vec2 PointOfCoedge(const Model& model, const Coedge& coedge, double parameter);

}  // namespace facetless
