// Bézier pieces of curves. Curves of all kinds are converted to these pieces before they go into the model.
// This file does not use OpenCASCADE.
//
//  1. Points are homogeneous (w·x, w·y, w·z, w), w > 0; a polynomial piece has w = 1 exactly.
//  2. A piece covers [begin, end] of its curve's native parameter, by the law `map` (model.h).
//  3. Consecutive pieces share their common point bit by bit.
#pragma once

#include <span>
#include <vector>

#include "render/base/vec.h"
#include "render/model/model.h"

namespace facetless {

struct CurvePiece {
  double begin = 0, end = 1;
  SpanMap map = SpanMap::kLinear;
  std::vector<Vec4> points;  // degree + 1

  int degree() const { return static_cast<int>(points.size()) - 1; }
};

// Returns the Bézier points over [a, b] of the polynomial that a B-spline has on the knot span [knots[span],
// knots[span+1]]. Each point is one blossom value, so that the points of a span that already is a Bézier
// curve stay unchanged. Requires knots[span] < knots[span+1] and degree <= span < knots.size() − degree − 1;
// `poles` are all poles of the curve.
std::vector<Vec4> BsplineSpanPoints(std::span<const double> knots, int degree, std::span<const Vec4> poles,
                                    int span, double a, double b);

// Splits [first, last] into stretches that lie in one knot span each, in order. The first and the last span
// also cover parameters beyond the domain. A stretch that is no wider than rounding is merged with its
// neighbour. Requires first < last.
struct KnotStretch {
  int span;
  double begin, end;
};
std::vector<KnotStretch> KnotStretches(std::span<const double> knots, int degree, double first, double last);

// All pieces of a B-spline over [first, last].
std::vector<CurvePiece> BsplinePieces(std::span<const double> knots, int degree, std::span<const Vec4> poles,
                                      double first, double last);

// Returns center + cos(θ)·x + sin(θ)·y for θ in [first, last], as rational quadratic arcs of at most
// `max_width` radians each (max_width < π). The parametrisation is SpanMap::kHalfAngle.
std::vector<CurvePiece> ArcPieces(Vec3 center, Vec3 x, Vec3 y, double first, double last, double max_width);

// Raises the degree of every piece to `degree`, exactly up to rounding. Requires degree >= that of each.
void ElevateDegree(std::vector<CurvePiece>& pieces, int degree);

// Evaluates the piece at its own parameter t in [0, 1] by de Casteljau's algorithm. The result is
// homogeneous.
Vec4 EvaluateBezier(std::span<const Vec4> points, double t);
// Converts the native parameter `native` to the piece's own parameter.
double PieceParameter(double begin, double end, SpanMap map, double native);
// The inverse of PieceParameter.
double NativeParameter(double begin, double end, SpanMap map, double t);

inline Vec3 Cartesian(Vec4 p) {
  return {p.x / p.w, p.y / p.w, p.z / p.w};
}

}  // namespace facetless
