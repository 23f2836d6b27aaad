// Planar rational Bézier curves, divided into pieces that are monotone in both coordinates, and the test on
// which side of such a piece a point lies.
//
//  1. A PlaneCurve refers to degree + 1 control points (w·u, w·v, w) with positive weights; it owns nothing.
//  2. The error of PointOn is at most EvaluationError in each coordinate. A turn of the curve smaller than
//     that is not found and has no effect.
//  3. SideOf never guesses: kLeft and kRight are proven, rounding included. kOn means that the point is
//     closer to the curve than the evaluation error.
//  4. The same arguments give the same bits on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/vec.h"

namespace facetless {

struct PlaneCurve {
  const Vec3* points = nullptr;
  int degree = 1;  // 1 … 255
};

// The point at t ∈ [0,1], and the derivative with respect to t. At the ends, the point is exactly the
// quotient of the end control point's coordinates by its weight.
Vec2 PointOn(const PlaneCurve& curve, double t);
Vec2 TangentOn(const PlaneCurve& curve, double t);

// A bound of the rounding error of PointOn, per coordinate.
Vec2 EvaluationError(const PlaneCurve& curve);

// Appends the parameters in (0,1), unsorted, at which u or v has an extremum. A double root of the derivative
// may be appended although the curve has no extremum there.
void AppendTurns(const PlaneCurve& curve, std::vector<double>& parameters);

// Computes the control points (u, v) of the part [t0, t1] of `curve` by blossoming, with the weights divided
// out. Their convex hull contains that part of the curve.
void StretchHull(const PlaneCurve& curve, double t0, double t1, std::vector<Vec2>& hull);

// A part of a curve that is monotone in u and in v, and runs upwards: low.y <= high.y.
struct MonotonePiece {
  PlaneCurve curve;
  double t_low = 0, t_high = 1;  // parameters of the ends; t_low > t_high if the curve runs downwards
  Vec2 low, high;                // the ends
  Vec2 error;                    // EvaluationError of the curve
};

enum class CurveSide : std::int8_t { kRight = -1, kOn = 0, kLeft = 1 };

// The side of the piece on which `q` lies, looking from low to high. Requires q in the box of the two ends.
// The function takes about five evaluations of the curve, and never more than 200. A piece along an axis, such as
// a border of the patch, takes none.
CurveSide SideOf(const MonotonePiece& piece, Vec2 q);

// The parameter t between t_low and t_high of the point nearest to q in the metric (scale.x·du)² +
// (scale.y·dv)², computed by damped Gauss–Newton. It is accurate to about the square root of the rounding
// error, which is sufficient for a starting guess.
double NearestParameter(const MonotonePiece& piece, Vec2 q, Vec2 scale);

}  // namespace facetless
