// OpenCASCADE's surfaces as grids of Bézier patches in their native parameters.
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

// A surface to be stored, and how well it stands for OpenCASCADE's.
struct PatchGrid : SurfaceGrid {
  bool approximated = false;  // the surface has no exact rational form
  double deviation = 0;  // largest distance to the surface at the checked points, in the surface's own units
  double size = 0;       // largest absolute Cartesian coordinate of a control point, likewise
};

// Removes Geom_RectangularTrimmedSurface wrappers: the parameters stay.
Handle(Geom_Surface) Untrimmed(Handle(Geom_Surface) surface);

// The grid over `box`, which is what a face's loops reach, or the whole surface if the face has none
// (`whole`). Where the surface goes on, the grid reaches a little further, and says so in extendable_*. Then
// `placement` is applied. The grid is compared with the surface at a lattice of points; whatever is found
// stands in `deviation`. Errors: kFormatBroken (empty, infinite or not finite, weights that are not
// positive), kLimitExceeded (more than 4096 periods).
Result<PatchGrid> PatchesOf(const Handle(Geom_Surface) & surface, const ParameterBox& box, bool whole,
                            const gp_Trsf& placement);

// The homogeneous point of a grid at native parameters, extrapolated beyond its ends.
Vec4 Evaluate(const PatchGrid& grid, double u, double v);

}  // namespace facetless
