// Bézier clipping: T. Nishita, T. Sederberg, M. Kakimoto, "Ray tracing trimmed rational surface patches", Computer
// Graphics 24 (SIGGRAPH 1990), pages 337–345. Its name is bezier-clipping.
//
//     const SolverInfo info = BezierClippingInfo();
//     Result<std::unique_ptr<const Solver>> solver = info.make(scene, 0, execution);
//
// How it works, by the paper's section 3:
//
//  1. The ray is the intersection of two planes. The distances of the control points from the planes, times their weights,
//     are two scalar Bézier nets f and g over (u,v). A root is a common zero.
//  2. Line L_u runs through the ray along the sum of the net's two sides in v, so that the distance from it changes mainly
//     with u. The distances are the coefficients of a polynomial. The convex hull of its control points over u meets the
//     axis in an interval [u_min, u_max], outside of which there is no root; the net is cut down to it (render/solve/clip.h).
//     The same is done for v with line L_v, and so on in turn.
//  3. If a clip takes away less than 20 % of the interval, the part of the patch may hold several roots. It is halved in
//     this direction, and both halves are searched, depth first.
//  4. A part whose sides in u and v are both below kClipTolerance is a root if both distances still have zeros: the root is
//     its middle. A clip leaves at least half of kClipTolerance. A direction in which the part is that small is not cut any
//     more, and its line keeps the direction that it had, because the sides of the net have no length there.
//
// The arithmetic is plain, as in the paper. What the method does not promise:
//
//  5. Rounding at the border of a clip, or of the patch, can lose a root: a ray through the border of two patches may meet
//     neither.
//  6. A root exactly on the border of two halves is reported by both, and a multiple root several times.
//  7. If the surface is seen edge-on and its plane holds the ray, L_u and L_v both lie in the plane, and both distances are
//     zero everywhere: the method reports roots that do not lie on the ray. A patch has at most 2·degree_u·degree_v simple
//     roots (Bézout's theorem); the search ends with kSteps when it would report more.
//  8. If the sides of a net cancel or are collapsed, a line has no direction, and the method only halves.
//  9. The tolerance is one of parameters, so that a root is less exact where the surface moves by more than
//     kClipSlope pixels per unit of a parameter.
#pragma once

#include "render/solve/clip.h"
#include "render/solve/solver.h"

namespace facetless {

inline constexpr double kClipTolerance = 0x1p-44;
// Below this speed, a root is as exact as tolerance_px says.
inline constexpr double kClipSlope = 1e5;
// A clip that leaves more than this share of the interval is followed by halving.
inline constexpr double kClipShare = 0.8;

SolverInfo BezierClippingInfo();

// Searches a patch, and appends its roots. Returns why the search ended; the caller counts it.
SolverStop ClipPatch(const SolverScene& scene, std::uint32_t patch, const SolverRay& ray, NetStack& nets,
                     SolverState& state);

// The state of solvers that clip.
struct ClipState : SolverState {
  explicit ClipState(int most_points) : nets(most_points) {}
  NetStack nets;
};

}  // namespace facetless
