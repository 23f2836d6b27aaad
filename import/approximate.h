// Bézier pieces for curves and surfaces that have no exact rational form: interpolation at Chebyshev points,
// cut in two until it is good enough. The native parametrisation is kept. Knows no OpenCASCADE.
#pragma once

#include <functional>
#include <vector>

#include "import/bezier_pieces.h"

namespace facetless {

// The degree of approximating pieces: high enough for a few pieces per smooth stretch to reach 1e-10 of its
// size, low enough for Bernstein coefficients to lose no more than three digits.
inline constexpr int kApproximationDegree = 8;

// Pieces over `breaks` (increasing, at least two), cut further until the distance at points between the nodes
// is at most `tolerance`, or a stretch has been halved `max_depth` times. *deviation receives the largest
// distance measured.
std::vector<CurvePiece> ApproximateCurve(const std::function<Vec3(double)>& curve,
                                         const std::vector<double>& breaks, double tolerance, int max_depth,
                                         double* deviation);

// A grid of polynomial patches of bidegree kApproximationDegree; points as in model.h, law of Surface.
struct ApproximateGrid {
  std::vector<double> u_breaks, v_breaks;
  std::vector<Vec4> points;
  double deviation = 0;
};
ApproximateGrid ApproximateSurface(const std::function<Vec3(double, double)>& surface,
                                   std::vector<double> u_breaks, std::vector<double> v_breaks,
                                   double tolerance);

}  // namespace facetless
