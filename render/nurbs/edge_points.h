// Points on edges, at a parameter of the 3D curve that two faces share.
#pragma once

#include "render/base/vec.h"
#include "render/model/model.h"

namespace facetless {

struct EdgePoint {
  Vec3 position;  // part coordinates, mm
  Vec3 tangent;   // unit vector; 0 if the derivative of the curve vanishes
};

// The segment of the edge that contains the parameter. At a joint it is the first of the two segments; beyond
// an end of the edge it is the segment at that end. Requires an edge that is not degenerate.
const EdgeSegment& SegmentAt(const Model& model, const Edge& edge, double parameter);

// The point of the edge's 3D curve at the parameter; beyond an end of the curve, the end point.
EdgePoint EvaluateEdge(const Model& model, const Edge& edge, double parameter);

// The point of the coedge's p-curve, in native surface parameters, that corresponds to the edge's
// `parameter`. If no segment covers that parameter, the point that corresponds to the nearest covered one.
Vec2 EvaluateCoedge(const Model& model, const Coedge& coedge, double parameter);

}  // namespace facetless
