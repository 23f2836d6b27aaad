// The ray of a pixel, computed only from a view's numbers as docs/cameras.md defines them.
//
//  1. All numbers are Real: rounding changes the ray by 1e-32 of its distance, and is ignored. The oracle
//     takes the resulting ray as exact.
#pragma once

#include "render/base/vec.h"
#include "tests/verify/oracle/real.h"

namespace facetless::oracle {

// The numbers that every report repeats.
struct View {
  Vec3 eye, target, up;
  bool perspective = false;
  double height = 1;      // orthographic: mm
  double fov_y_deg = 40;  // perspective
  int width = 1, height_px = 1;
};

// The point origin + depth·direction has that depth. The component of `direction` along `forward` is 1.
struct ViewRay {
  Real3 origin, direction;
  Real3 eye, forward;  // depth of a point P is (P − eye)·forward
  Real3 across, down;  // unit, perpendicular to the ray and to each other
  bool perspective = false;
  Real3 At(Real depth) const { return origin + depth * direction; }
  // Returns the same ray moved sideways, in parallel, by the given distances in mm.
  ViewRay Moved(Real along_across, Real along_down) const;
};

// Returns the ray through pixel coordinates (x, y). Pixel centres are at halves.
ViewRay ViewPixelRay(const View& view, double x, double y);

}  // namespace facetless::oracle
