// Where the labels of a plot go.
#pragma once

#include <cstddef>
#include <vector>

namespace facetless {

struct PlotBox {
  double x = 0, y = 0, width = 0, height = 0;
};

double OverlapArea(const PlotBox& a, const PlotBox& b);

struct LabelRequest {
  double x = 0, y = 0;           // the point
  double width = 0, height = 0;  // of the text
};

struct LabelPlace {
  PlotBox box;
  bool leader = false;  // so far from its point that a line should lead there
};

// A place for each label, in the order given: the first of the places around its point, near ones first, that
// costs least. What it costs is the area shared with labels already placed and with `obstacles`, what sticks
// out of `bounds`, and a little for distance.
std::vector<LabelPlace> PlaceLabels(const std::vector<LabelRequest>& labels,
                                    const std::vector<PlotBox>& obstacles, const PlotBox& bounds);

}  // namespace facetless
