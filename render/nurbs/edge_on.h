// Patches seen edge-on: their image is a line, and no piece of it has a certificate, however small.
//
//  1. Every ray of the picture that meets the patch, or could within the errors of its net, passes the line
//     within half_width.
//  2. is_line: half_width is nothing but errors and rounding. A ray within it runs along the patch: whether
//     it hits, and where, no arithmetic of this precision can tell.
#pragma once

#include "render/nurbs/bezier.h"

namespace facetless {

struct LineImage {
  bool is_line = false;
  double x = 0, y = 0;                // a point of the line, pixels relative to the image centre
  double normal_x = 0, normal_y = 0;  // unit
  double half_width = 0;

  double DistanceOf(double px, double py) const;
};

// The line through the first control point's image and the one farthest from it. Where a weight may be zero
// within its error, the patch may lie anywhere: the line is as wide as the plane.
LineImage FitLine(const BezierNet& net);

}  // namespace facetless
