// The ray of a pixel, from a view's numbers alone, as docs/cameras.md defines them.
//
//  1. Everything is Real: what rounding does to the ray is 1e-32 of its distance, and is not carried further.
//     The oracle takes the ray as it comes out here for exact.
#pragma once

#include "render/base/vec.h"
#include "tests/verify/oracle/real.h"

namespace facetless::oracle {

// The numbers that every answer echoes.
struct View {
  Vec3 eye, target, up;
  bool perspective = false;
  double height = 1;      // orthographic: mm
  double fov_y_deg = 40;  // perspective
  int width = 1, height_px = 1;
};

// origin + depth·direction has that depth; `direction` has unit component along `forward`.
struct ViewRay {
  Real3 origin, direction;
  Real3 eye, forward;  // depth of a point P is (P − eye)·forward
  Real3 across, down;  // unit, perpendicular to the ray and to each other
  bool perspective = false;
  Real3 At(Real depth) const { return origin + depth * direction; }
  // The same ray moved sideways by so many mm: by all of it in parallel.
  ViewRay Moved(Real along_across, Real along_down) const;
};

// The ray through pixel coordinates (x, y): centres are at halves.
ViewRay ViewPixelRay(const View& view, double x, double y);

}  // namespace facetless::oracle
