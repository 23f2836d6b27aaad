// Models made by hand, without an importer: exact rational patches whose every property has a closed form.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless::testing {

// One face without loops (the whole patch grid), one part, one instance; bounds from the control points.
struct PatchGrid {
  SurfaceKind kind = SurfaceKind::kBspline;
  int degree_u = 1, degree_v = 1;
  std::vector<Span> u_spans, v_spans;
  std::vector<Vec4> points;  // in Model's order
};

Model ModelOf(const std::vector<PatchGrid>& grids);

// u is the longitude 0 … 2π, v the latitude −π/2 … π/2; outward Su × Sv.
PatchGrid Sphere(Vec3 center, double radius);
// u around the axis z, v around the tube, both 0 … 2π.
PatchGrid Torus(Vec3 center, double major, double minor);
// u around the axis z; v is the height 0 … height; radius from bottom to top. A top of 0 makes a cone with
// its apex.
PatchGrid Frustum(Vec3 base, double bottom, double top, double height);
// The rectangle origin + u·a + v·b, u, v ∈ [0,1].
PatchGrid Rectangle(Vec3 origin, Vec3 a, Vec3 b);
// Over |x|, |y| ≤ 1 two planes that fall from the ridge x = z = 0 to z = −5: one face of two patches.
PatchGrid Roof();

// A box from the origin to `size`, one closed solid whose faces share edges. The p-curves run along the faces'
// borders; each edge is a parabola with control points up to `gap_mm` off the line, and each vertex lies as far
// off its corner, in directions that `seed` says.
Model LooseBox(Vec3 size, double gap_mm, std::uint64_t seed);

// A sphere of longitude × latitude quads with exact normals, around the part's origin.
MeshPart SphereMesh(double radius, int longitudes, int latitudes);
// It alone, twice as many longitudes as latitudes, as the tessellation of a model.
Mesh BallMesh(double radius, int longitudes);

// A model whose only instance is placed so.
void Place(Model* model, const Placement& placement);

}  // namespace facetless::testing
