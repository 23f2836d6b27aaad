// Patches that are seen edge-on. The image of such a patch is a line, and no piece of the patch has a
// certificate, however small it is.
//
//  1. Every ray of the picture that meets the patch, or could meet it within the errors of its net, passes
//     within half_width of the line.
//  2. is_line is true if half_width consists of errors and rounding only. A ray within that distance runs
//     along the patch: arithmetic of this precision cannot decide whether and where it hits.
#pragma once

#include "render/nurbs/bezier.h"

namespace facetless {

struct LineImage {
  bool is_line = false;
  double x = 0, y = 0;                // a point on the line, in pixels relative to the image centre
  double normal_x = 0, normal_y = 0;  // unit
  double half_width = 0;

  double DistanceToLine(double px, double py) const;
};

// The line through the image of the first control point and the image farthest from it. If a weight may be
// zero within its error, the patch may lie anywhere, and the half width is infinite.
LineImage FitLine(const BezierNet& net);

}  // namespace facetless
