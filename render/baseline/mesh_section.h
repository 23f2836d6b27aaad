// The area of a cut through a mesh, computed in closed form from the polygon in which the plane cuts the
// triangles.
#pragma once

#include "render/model/mesh.h"
#include "render/view/section.h"

namespace facetless {

// The area inside the mesh, in mm², for a mesh whose shells are closed and do not overlap. The orientation of
// the triangles determines the sign of their contributions, so that cavities are subtracted. Triangles that
// lie in the plane count as being on the removed side.
double MeshSectionArea(const Mesh& mesh, const SectionPlane& plane);

}  // namespace facetless
