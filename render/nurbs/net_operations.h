// The operations on nets that splitting and solving need. They are written once on planes
// (kernels/net_kernel.inl.h) and compiled for each instruction set; kernels/dispatch.h selects one of them.
//
//  1. All builds give the same bits.
//  2. The operations multiply, add and divide in a fixed order, without fused multiply-add.
#pragma once

#include <cmath>

#include "render/nurbs/bezier.h"
#include "render/nurbs/leaf.h"

namespace facetless {

// The bounding box of a net's image, in samples relative to the image centre.
struct NetBox {
  double x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
  double near_depth = INFINITY, far_depth = -INFINITY;  // bounds of the depths
  double error = 0;                                     // error of the sides of the box
  bool in_front = true;  // every control point has W > 0; otherwise the box is not valid
};

// The extent of a projected net along u and v: bounds of the derivatives of its pixel coordinates, computed
// from first differences.
struct Extent {
  double u = 0, v = 0;
};

// F = (X − x·W, Y − y·W) over a net, for the ray through pixel (x, y).
struct Residual {
  bool empty =
      false;  // no point of the net lies on the ray, errors included; the other members are then not set
  double size = 0;    // the longer side of the box of F
  double error = 0;   // error of F
  double weight = 0;  // the largest W; F is in samples times this
  Extent extent;      // extent of F
};

struct NetOperations {
  // Halves `net` at the middle of one direction into `low` and `high`, by de Casteljau's algorithm, and sets
  // their errors. `low` and `high` must have the degrees of `net` and storage of their own. The coefficients
  // of the new border are bit-identical in both halves.
  void (*halve)(const BezierNet& net, Direction direction, BezierNet* low, BezierNet* high) = nullptr;

  // Makes the certificate of `net` (X and Y relative to the image centre; degrees at least 1). On success
  // fills everything of `leaf` that follows from the net — but not its coefficients, and what they are of — and writes
  // leaf->planes()·points() monomials to `monomials` (room for 4·points()), plane by plane. Fails where the
  // bound of Law 1 or Law 5 of leaf.h does, or where errors leave no root to tell apart.
  NetVerdict (*certify)(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic,
                        CertifiedLeaf* leaf, double* monomials) = nullptr;

  // Computes the box of the image. `half_window` is half the longer side of the image; it bounds the pixel
  // coordinates that the error of W is multiplied with.
  NetBox (*project)(const BezierNet& net, DepthRule rule, double half_window) = nullptr;

  // Measures the extent in samples. For a net that is not entirely in front of the eye, pixel coordinates do
  // not exist; the extent is then that of X, Y and half_window·W, which is the value of X at the window's
  // border.
  Extent (*measure)(const BezierNet& net, DepthRule rule, double half_window, bool in_front) = nullptr;

  // Computes the residual F. It is empty if all control points of F lie on one side of the origin, in X, in
  // Y, or perpendicular to a direction of the net (its sides and diagonals). The last test detects rays that
  // pass beside a fold.
  Residual (*residual)(const BezierNet& net, double x, double y) = nullptr;
};

}  // namespace facetless
