// Approximates curves and surfaces that have no exact rational form by Bézier pieces: each piece interpolates
// at Chebyshev points, and is halved until it is accurate enough. The native parametrisation is preserved.
// This file does not use OpenCASCADE.
#pragma once

#include <functional>
#include <vector>

#include "import/bezier_pieces.h"

namespace facetless {

// The degree of approximating pieces. It is high enough for a few pieces to approximate a smooth stretch to
// 1e-10 of its size, and low enough for the Bernstein coefficients to lose no more than three digits.
inline constexpr int kApproximationDegree = 8;

// Returns pieces over `breaks` (increasing, at least two). A piece is halved until its distance to the curve,
// measured between the nodes, is at most `tolerance`, or until it has been halved `max_depth` times.
// *deviation receives the largest distance measured.
std::vector<CurvePiece> ApproximateCurve(const std::function<Vec3(double)>& curve,
                                         const std::vector<double>& breaks, double tolerance, int max_depth,
                                         double* deviation);

// A grid of polynomial patches of bidegree kApproximationDegree. Its points are ordered as in a Surface
// (model.h).
struct ApproximateGrid {
  std::vector<double> u_breaks, v_breaks;
  std::vector<Vec4> points;
  double deviation = 0;
};
ApproximateGrid ApproximateSurface(const std::function<Vec3(double, double)>& surface,
                                   std::vector<double> u_breaks, std::vector<double> v_breaks,
                                   double tolerance);

}  // namespace facetless
