// Models made by hand, without an importer: exact rational patches whose every property has a closed form.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/model/builder.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless::testing {

using PatchGrid = SurfaceGrid;

// The finished model; throws the builder's sentence if it is not valid.
Model Finished(ModelBuilder builder);

// For each grid a face without loops (the whole patch grid), one part, one instance; bounds from the control
// points.
Model ModelOf(const std::vector<PatchGrid>& grids);
// So many unit squares side by side, for tests that look at no geometry.
Model Squares(int faces);
// The same model, which has one part and no solids: all its faces are one closed solid.
Model ClosedSolid(Model model, const std::string& name = "solid");

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

// A box from the origin to `size`, one closed solid whose faces share edges. The p-curves run along the
// faces' borders; each edge is a parabola with control points up to `gap_mm` off the line, and each vertex
// lies as far off its corner, in directions that `seed` says.
Model LooseBox(Vec3 size, double gap_mm, std::uint64_t seed);

// A sphere of longitude × latitude quads with exact normals, around the part's origin.
MeshPart SphereMesh(double radius, int longitudes, int latitudes);
// It alone, twice as many longitudes as latitudes, as the tessellation of a model.
Mesh BallMesh(double radius, int longitudes);

// A model whose only instance is placed so.
void Place(Model* model, const Placement& placement);

}  // namespace facetless::testing
