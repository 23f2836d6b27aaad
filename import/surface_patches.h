// Converts OpenCASCADE's surfaces to grids of Bézier patches in their native parameters.
#pragma once

#include <Geom_Surface.hxx>
#include <gp_Trsf.hxx>
#include <vector>

#include "render/base/result.h"
#include "render/model/builder.h"

namespace facetless {

struct ParameterBox {
  double u0 = 0, u1 = 1, v0 = 0, v1 = 1;
};

// A surface for the model, and how accurately it represents OpenCASCADE's.
struct PatchGrid : SurfaceGrid {
  bool approximated = false;  // the surface has no exact rational form
  double deviation = 0;  // largest distance to the surface at the checked points, in the surface's own units
  double size = 0;       // largest absolute Cartesian coordinate of a control point, in the same units
};

// Removes Geom_RectangularTrimmedSurface wrappers. The parameters do not change.
Handle(Geom_Surface) Untrimmed(Handle(Geom_Surface) surface);

// Returns the grid over `box`, which is the range of a face's loops. If the face has no loops (`whole`), the
// grid covers the whole surface. Where the surface continues beyond the box, the grid is a little larger, and
// extendable_* says so. Then `placement` is applied. The grid is compared with the surface at a lattice of
// points; `deviation` is the largest distance found. Errors: kFormatBroken (the range is empty, infinite or
// not finite; a weight is not positive), kLimitExceeded (the loops cover more than 4096 periods).
Result<PatchGrid> PatchesOf(const Handle(Geom_Surface) & surface, const ParameterBox& box, bool whole,
                            const gp_Trsf& placement);

// Returns the homogeneous point of a grid at native parameters. Beyond the ends of the grid it extrapolates.
Vec4 Evaluate(const PatchGrid& grid, double u, double v);

}  // namespace facetless
