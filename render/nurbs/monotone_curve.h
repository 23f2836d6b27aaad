// Planar rational Bézier curves cut into pieces monotone in both coordinates, and the side of such a piece.
//
//  1. A PlaneCurve is a view of degree + 1 points (w·u, w·v, w) with positive weights; it owns nothing.
//  2. PointOn is off by at most EvaluationError in each coordinate; a turn smaller than that isn't found and
//     doesn't matter.
//  3. SideOf never guesses: kLeft and kRight are proven, rounding included; kOn means nearer than the
//     evaluation can tell.
//  4. Deterministic: the same arguments give the same bits everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/vec.h"

namespace facetless {

struct PlaneCurve {
  const Vec3* points = nullptr;
  int degree = 1;  // 1 … 255
};

// The point at t ∈ [0,1], and the derivative by t. The ends come out as the end points' own quotients.
Vec2 PointOn(const PlaneCurve& curve, double t);
Vec2 TangentOn(const PlaneCurve& curve, double t);

// Bound of the rounding errors of PointOn, per coordinate.
Vec2 EvaluationError(const PlaneCurve& curve);

// Appends the parameters in (0,1), unsorted, where u or v has an extremum; a double root may be appended
// although nothing turns there.
void AppendTurns(const PlaneCurve& curve, std::vector<double>& parameters);

// The control points of the stretch [t0, t1] of `curve` by blossoming: (u, v), weights divided out. Bounds
// the stretch, as its convex hull.
void StretchHull(const PlaneCurve& curve, double t0, double t1, std::vector<Vec2>& hull);

// A stretch of a curve that is monotone in u and in v, running upwards: low.y <= high.y.
struct MonotonePiece {
  PlaneCurve curve;
  double t_low = 0, t_high = 1;  // parameters of the ends; t_low > t_high where the curve runs downwards
  Vec2 low, high;                // the ends
  Vec2 error;                    // EvaluationError of the curve
};

enum class CurveSide : std::int8_t { kRight = -1, kOn = 0, kLeft = 1 };

// Where `q` lies, looking from low to high. Requires q in the box of the ends. About five evaluations of the
// curve; never more than 200.
CurveSide SideOf(const MonotonePiece& piece, Vec2 q);

// The parameter t between t_low and t_high of the point nearest to q in the metric (scale.x·du)² +
// (scale.y·dv)², by damped Gauss–Newton: good to about the square root of the rounding, which is all that a
// starting guess needs.
double NearestParameter(const MonotonePiece& piece, Vec2 q, Vec2 scale);

}  // namespace facetless
