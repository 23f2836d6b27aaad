// The rows, one function per group.
#pragma once

#include <vector>

#include "tests/verify/extremes/extreme.h"

namespace facetless::extremes {

using Rows = std::vector<Extreme>;

void AddSizes(Rows& rows);          // of models, far from the origin, long and thin
void AddNets(Rows& rows);           // weights, degrees, numbers of control points, knots
void AddSingularities(Rows& rows);  // poles, collapsed edges, cusps, self-intersections, multiple roots
void AddCoincidences(Rows& rows);   // faces upon each other
void AddTrims(Rows& rows);          // loops
void AddViews(Rows& rows);          // fields of view, eyes, image sizes
void AddRanges(Rows& rows);         // ends of what a double holds

}  // namespace facetless::extremes
