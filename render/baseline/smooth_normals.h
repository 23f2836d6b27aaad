// Vertex normals for a mesh without normals.
//
//  1. The normal of a corner is the sum of the unit normals of the triangles around its position, weighted by
//     their angles there (Thürmer and Wüthrich 1998), over those triangles whose normals are within
//     `crease_deg` of the normal of the corner's own triangle.
//  2. Positions are the same if their coordinates are equal; −0 equals +0. One vertex is created for each
//     distinct pair of position and normal. The order of the triangles does not change.
//  3. If more than 64 triangles meet at a position, they are divided into groups, each around the first
//     triangle that belongs to no earlier group. The time is therefore n·log n for any mesh.
//  4. A triangle without area contributes to no normal. Its corners get the normal of the other triangles
//     around them, or (0,0,0).
#pragma once

#include "render/model/mesh.h"

namespace facetless {

// Replaces the positions, the normals and the indices of `part`. Requires indices in range and finite
// positions.
void MakeSmoothNormals(MeshPart& part, double crease_deg);

}  // namespace facetless
