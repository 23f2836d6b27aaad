// Vertex normals for a mesh that has none.
//
//  1. A corner's normal is the sum of the unit normals of the triangles around its position, each weighted
//     by its angle there (Thürmer and Wüthrich 1998), over those triangles whose normals lie within
//     `crease_deg` of its own triangle's.
//  2. Positions are the same if their coordinates are equal; −0 equals +0. A vertex is made for each
//     different pair of position and normal; the order of triangles is kept.
//  3. Where more than 64 triangles meet, they are put into groups, each around the first triangle that no
//     earlier group takes; so the time is n·log n whatever the mesh.
//  4. A triangle without area takes no part, and its corners get whatever the others around them agree on,
//     or (0,0,0).
#pragma once

#include "render/model/mesh.h"

namespace facetless {

// Replaces positions, normals and the indices of `part`. Requires indices in range and finite positions.
void MakeSmoothNormals(MeshPart& part, double crease_deg);

}  // namespace facetless
