// The rows of the catalogue, one function per group.
#pragma once

#include <vector>

#include "tests/verify/extremes/extreme.h"

namespace facetless::extremes {

using Rows = std::vector<Extreme>;

void AddSizes(Rows& rows);          // sizes of models, distances from the origin, long and thin models
void AddNets(Rows& rows);           // weights, degrees, numbers of control points, knots
void AddSingularities(Rows& rows);  // poles, collapsed edges, cusps, self-intersections, multiple roots
void AddCoincidences(Rows& rows);   // faces that coincide
void AddTrims(Rows& rows);          // loops
void AddViews(Rows& rows);          // fields of view, eyes, image sizes
void AddRanges(Rows& rows);         // the ends of the range of double

}  // namespace facetless::extremes
