// Placement of the labels of a plot.
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
  bool leader = false;  // the label is so far from its point that a line should connect them
};

// Chooses a place for each label, in the given order. The candidates are places around its point, near ones
// first, and the first one with the least cost is chosen. The cost is the area shared with placed labels and
// with `obstacles`, the area outside of `bounds`, and a small term for the distance.
std::vector<LabelPlace> PlaceLabels(const std::vector<LabelRequest>& labels,
                                    const std::vector<PlotBox>& obstacles, const PlotBox& bounds);

}  // namespace facetless
