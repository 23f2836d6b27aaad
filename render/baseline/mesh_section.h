// The area of a cut through a mesh: where a plane meets its triangles, a polygon in closed form.
#pragma once

#include "render/model/mesh.h"
#include "render/view/section.h"

namespace facetless {

// Signed by the triangles' outward sides, so that cavities count against their solids: the area inside a mesh
// whose shells are closed and do not overlap, in mm². Triangles that lie in the plane count as on the removed
// side.
double MeshSectionArea(const Mesh& mesh, const SectionPlane& plane);

}  // namespace facetless
