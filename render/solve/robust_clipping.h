// Robust Bézier clipping: A. Efremov, V. Havran, H.-P. Seidel, "Robust and numerically stable Bézier clipping method for
// ray tracing NURBS surfaces", Spring Conference on Computer Graphics 2005, pages 127–135. Its name is robust-clipping.
//
//     const SolverInfo info = RobustClippingInfo();
//     Result<std::unique_ptr<const Solver>> solver = info.make(scene, 0, execution);
//
// It clips as render/solve/bezier_clipping.h does, with the paper's improvements. How they are realised here:
//
//  1. Intervals that lose no root by rounding. The paper makes each clipped interval larger by a small constant. Here the
//     rounding error of the control points is bounded through all steps, and the convex hull is made higher and lower by
//     this bound before it is cut with the axis. A root on the border of two patches is therefore found by at least one.
//  2. Lines of clips. L_u and L_v run along the sums of the sides, as in the original method. If a sum is short against
//     the net (collapsed, opposite or cancelling sides), or if both lines are nearly parallel (a fold), then a clip uses
//     two perpendicular lines, and its interval is the intersection of both. So no direction stays unbounded.
//  3. The direction. The original method clips u and v in turn. Here, the direction in which the net is longer on the
//     screen is clipped first. If that takes away less than 20 %, the other one is clipped. Only if that fails, too, the
//     part is halved in the longer direction. At a pole, where one direction has no extent, only the other one is divided.
//  4. The end. A part is a candidate when it is small in parameters (kRobustParameters) and on the screen (half of
//     tolerance_px), or when its net is so close to its rounding error that no division makes sense. The candidate is the
//     middle of the part. It is a root if the surface, evaluated there, lies within the tolerance of the ray (or within
//     the rounding error, law 6).
//  5. Equivalent intersections. A candidate whose part touches, or nearly touches, the part of an earlier root is the same
//     root: a root on the border of two halves, a double root, or a pole, which a whole collapsed edge describes. It is
//     reported once.
//
// The paper's preparation of NURBS surfaces, its hierarchy of boxes, and its trimming are not part of this file: all methods
// share those of the renderer.
//
// What the method does not promise:
//
//  6. Nothing is proven. Where the rounding error of the projected control points, or a step of the parameters, is more
//     than tolerance_px (patches of more than about 10^6 pixels, steep weights), roots are only as exact as that; they are
//     reported nevertheless. Rays that miss the surface by less than the rounding error may be reported as hits. At a
//     root of multiplicity n, parameters are only as exact as the n-th root of the rounding error.
//  7. Two roots that rounding cannot distinguish, or whose parameters differ by less than 2^-44, are reported as one.
//  8. If a whole curve of the surface lies on the ray (a surface that is seen edge-on), the limit of work, or that of
//     roots (2·degree_u·degree_v), ends the search.
#pragma once

#include "render/solve/solver.h"

namespace facetless {

// The size of a candidate in parameters (law 4).
inline constexpr double kRobustParameters = 0x1p-40;

SolverInfo RobustClippingInfo();

}  // namespace facetless
