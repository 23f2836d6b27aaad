#include "render/trade/plot_labels.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// The distances from the point's centre to the nearest label, and from ring to ring, px.
constexpr double kGap = 9, kRingStep = 15;
constexpr int kRings = 7;
// A label on the first ring is close enough to its point; labels farther out need a leader line.
constexpr int kRingsWithoutLeader = 1;

// Returns the box of a label that is attached at (x, y), on the side to which (dx, dy) points, both −1 … 1.
PlotBox Hung(double x, double y, double dx, double dy, const LabelRequest& label) {
  return {x + (dx - 1) * 0.5 * label.width, y + (dy - 1) * 0.5 * label.height, label.width, label.height};
}

}  // namespace

double OverlapArea(const PlotBox& a, const PlotBox& b) {
  const double width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return width > 0 && height > 0 ? width * height : 0;
}

std::vector<LabelPlace> PlaceLabels(const std::vector<LabelRequest>& labels,
                                    const std::vector<PlotBox>& obstacles, const PlotBox& bounds) {
  // Right and left come first: text beside its point is the easiest to read.
  constexpr double kSides[][2] = {{1, 0}, {-1, 0}, {1, -1}, {1, 1}, {-1, -1}, {-1, 1}, {0, -1}, {0, 1}};
  std::vector<LabelPlace> places;
  for (const LabelRequest& label : labels) {
    LabelPlace best;
    double least = INFINITY;
    for (int ring = 0; ring < kRings; ++ring)
      for (const auto& side : kSides) {
        const double reach = kGap + ring * kRingStep;
        const double shrink = side[0] != 0 && side[1] != 0 ? 0.8 : 1;
        const PlotBox box = Hung(label.x + side[0] * reach * shrink, label.y + side[1] * reach * shrink,
                                 side[0], side[1], label);
        const double area = box.width * box.height;
        double cost = 20 * (area - OverlapArea(box, bounds));
        for (const LabelPlace& placed : places) cost += 20 * OverlapArea(box, placed.box);
        for (const PlotBox& obstacle : obstacles) cost += 2 * OverlapArea(box, obstacle);
        // Each further ring costs as much as an overlap with an eighth of the label's area.
        cost += ring * area / 8;
        if (cost < least) {
          least = cost;
          best = {box, ring >= kRingsWithoutLeader};
        }
      }
    places.push_back(best);
  }
  return places;
}

}  // namespace facetless
