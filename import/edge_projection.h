// Computes the p-curve of an edge for which the file has none: it projects the 3D edge onto the surface by
// continuation.
//
//  1. The edge is followed in steps, from its middle to both ends, since an end may be a pole. Where the
//     surface's parameters have a closed form (cylinder, cone, sphere, torus), they are computed by it and
//     moved by whole periods to the parameters nearest to those of the previous step. Elsewhere, Newton's
//     iteration starts from the parameters of the previous step.
//  2. At a pole, where the parameters of a point are not unique, they are extrapolated from the steps before
//     and after it.
//  3. The result is parametrised by the edge's own parameter. A stretch whose projection is a straight line
//     with even speed is one piece of degree 1.
//  4. The caller must measure whether the projection is accurate: a point that is off the surface has a foot
//     on it, too.
#pragma once

#include <GeomAdaptor_Surface.hxx>
#include <functional>
#include <gp_Pnt.hxx>
#include <vector>

#include "import/bezier_pieces.h"

namespace facetless {

// Returns the pieces over `breaks` (increasing, at least two; the edge may be less smooth there). `edge`
// gives the point at a parameter, in the surface's frame, in mm. `tolerance` bounds the distance of the fit
// to the projection in mm, as measured at points between the nodes. The result is empty if the edge cannot be
// followed: the parameters become singular, the surface's weights differ by more than a factor of 1e8, or the
// surface is closed without being periodic, so that a point of its seam has two parameters.
std::vector<CurvePiece> ProjectEdge(const GeomAdaptor_Surface& surface,
                                    const std::function<gp_Pnt(double)>& edge,
                                    const std::vector<double>& breaks, double tolerance);

}  // namespace facetless
