// Models made by hand, without an importer: exact rational patches with closed forms for all their
// properties.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/model/builder.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless::testing {

using PatchGrid = SurfaceGrid;

// Returns the finished model. Throws the builder's sentence if the model is not valid.
Model Finished(ModelBuilder builder);

// Returns a model with one part and one instance, and for each grid a face without loops that is the whole
// grid. The bounds come from the control points.
Model ModelOf(const std::vector<PatchGrid>& grids);
// Returns the given number of unit squares side by side, for tests that do not use the geometry.
Model Squares(int faces);
// Returns the same model, which must have one part and no solids, with all its faces as one closed solid.
Model ClosedSolid(Model model, const std::string& name = "solid");

// u is the longitude 0 … 2π, v the latitude −π/2 … π/2; outward Su × Sv.
PatchGrid Sphere(Vec3 center, double radius);
// u around the axis z, v around the tube, both 0 … 2π.
PatchGrid Torus(Vec3 center, double major, double minor);
// u runs around the axis z; v is the height 0 … height; the radius changes linearly from bottom to top. If
// the top is 0, this is a cone with its apex.
PatchGrid Frustum(Vec3 base, double bottom, double top, double height);
// The rectangle origin + u·a + v·b, u, v ∈ [0,1].
PatchGrid Rectangle(Vec3 origin, Vec3 a, Vec3 b);
// Two planes over |x|, |y| ≤ 1, which fall from the ridge x = z = 0 to z = −5: one face of two patches.
PatchGrid Roof();

// A box from the origin to `size`: one closed solid whose faces share edges. The p-curves run along the
// faces' borders. Each edge is a parabola with control points up to `gap_mm` off the line, and each vertex is
// as far off its corner. `seed` determines the directions.
Model LooseBox(Vec3 size, double gap_mm, std::uint64_t seed);

// A sphere of longitude × latitude quads with exact normals, around the part's origin.
MeshPart SphereMesh(double radius, int longitudes, int latitudes);
// A mesh of such a sphere alone, with twice as many longitudes as latitudes, as the tessellation of a model.
Mesh BallMesh(double radius, int longitudes);

// Applies the placement to a model's only instance.
void Place(Model* model, const Placement& placement);

}  // namespace facetless::testing
