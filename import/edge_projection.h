// The p-curve of an edge for which the file has none: the 3D edge projected onto the surface by continuation.
//
//  1. The edge is followed from its beginning, in steps. Where the surface's parameters have a closed form
//     (cylinder, cone, sphere, torus) they are taken from it, and moved by whole periods next to the step
//     before; elsewhere Newton's iteration starts from the step before.
//  2. At a pole, where the parameters of a point are not unique, they are continued from the steps before and
//     after it.
//  3. The result is a curve of the edge's own parameter. A stretch whose projection is straight, and is run
//     through evenly, is one piece of degree 1.
//  4. Whether the projection is any good the caller measures: a point that is off the surface has a foot, too.
#pragma once

#include <GeomAdaptor_Surface.hxx>
#include <functional>
#include <gp_Pnt.hxx>
#include <vector>

#include "import/bezier_pieces.h"

namespace facetless {

// The pieces over `breaks` (increasing, at least two: where the edge may be less smooth). `edge` gives the
// point at a parameter, in the surface's frame, in mm. `tolerance` bounds the fit's distance to the projection
// in mm, as far as points between the nodes show. Empty where the edge cannot be followed: the parameters turn
// singular, the surface's weights differ by more than 1e8, or the surface is closed without being periodic, so
// that a point of its seam has two parameters.
std::vector<CurvePiece> ProjectEdge(const GeomAdaptor_Surface& surface,
                                    const std::function<gp_Pnt(double)>& edge,
                                    const std::vector<double>& breaks, double tolerance);

}  // namespace facetless
