// What is done to every net on the way to leaves and roots. The bodies are written once on planes
// (kernels/net_kernel.inl.h) and built per instruction set; kernels/dispatch.h chooses.
//
//  1. All builds give the same bits.
//  2. Everything is plain multiplication, addition and division in a fixed order, nothing fused.
#pragma once

#include <cmath>

#include "render/nurbs/bezier.h"
#include "render/nurbs/leaf.h"

namespace facetless {

// A net's image, in samples relative to the image centre.
struct NetBox {
  double x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
  double near_depth = INFINITY, far_depth = -INFINITY;  // no point is nearer, or farther
  double error = 0;                                     // of its sides
  bool in_front = true;                                 // every control point has W > 0: the box is valid
};

// How far a projected net extends along u and v: bounds of the derivatives of its pixel, from first
// differences.
struct Extent {
  double u = 0, v = 0;
};

// F = (X − x·W, Y − y·W) over a net, for the ray through pixel (x, y).
struct Residual {
  bool empty = false;  // no point of the net is on the ray, whatever the errors; then nothing else is set
  double size = 0;     // the longer side of F's box
  double error = 0;    // of F
  double weight = 0;   // the largest W: F is in samples times that
  Extent extent;       // of F
};

struct NetOperations {
  // Halves `net` at the middle of one direction into `low` and `high`, which have its degrees and storage of
  // their own, and their errors. De Casteljau's: both halves share the coefficients of the new border bit by
  // bit.
  void (*halve)(const BezierNet& net, Direction direction, BezierNet* low, BezierNet* high) = nullptr;

  // Makes the certificate of `net` (X and Y relative to the image centre; degrees at least 1). On success
  // fills everything of `leaf` that follows from the net — but not its coefficients, and what they are of — and writes
  // leaf->planes()·points() monomials to `monomials` (room for 4·points()), plane by plane. Fails where the
  // bound of Law 1 or Law 5 of leaf.h does, or where errors leave no root to tell apart.
  Verdict (*certify)(const BezierNet& net, DepthRule rule, const KernelArithmetic& arithmetic,
                     CertifiedLeaf* leaf, double* monomials) = nullptr;

  // `half_window`: half the longer side of the image, which bounds the pixel where the net's own W is off.
  NetBox (*project)(const BezierNet& net, DepthRule rule, double half_window) = nullptr;

  // In samples; for a net that is not in front of the eye, where a sample has no place, of X, Y and W, the
  // last times half the window, which is what X is at the window's border.
  Extent (*measure)(const BezierNet& net, DepthRule rule, double half_window, bool in_front) = nullptr;

  // Empty where the control points of F lie on one side of the origin: along X or Y, or across one of the
  // net's own directions (its sides and diagonals), which is what tells a ray beside a fold.
  Residual (*residual)(const BezierNet& net, double x, double y) = nullptr;
};

}  // namespace facetless
