#include "render/accel/bsp_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace facetless {
namespace {

// The sides of boxes that are tried on each axis: these quantiles of them.
constexpr double kQuantiles[] = {0.5, 0.44, 0.56, 0.38, 0.62, 0.3, 0.7};
constexpr int kMoreDepth = 8;  // than the logarithm of the number of objects

}  // namespace

BspTree::BspTree(std::span<const Box3> boxes) : boxes_(boxes) {
  deepest_ = kMoreDepth + static_cast<int>(std::ceil(std::log2(boxes.size() + 1.0)));
  std::vector<std::uint32_t> all(boxes_.size());
  std::iota(all.begin(), all.end(), 0u);
  Divide(all, 0);
  nodes_.shrink_to_fit();
  ids_.shrink_to_fit();
}

BspTree::Division BspTree::CountSides(const std::vector<std::uint32_t>& objects, int axis,
                                      double plane) const {
  Division division{axis, plane};
  for (const std::uint32_t id : objects) {
    const bool below = boxes_[id].side[1][axis] <= plane, above = boxes_[id].side[0][axis] >= plane;
    division.below += below;
    division.above += above;
    division.cut += !below && !above;
  }
  return division;
}

BspTree::Division BspTree::BestDivision(const std::vector<std::uint32_t>& objects) const {
  Division best;
  double least = INFINITY;
  std::vector<double> sides;
  for (int axis = 0; axis < 3; ++axis) {
    sides.clear();
    for (const std::uint32_t id : objects) {
      sides.push_back(boxes_[id].side[0][axis]);
      sides.push_back(boxes_[id].side[1][axis]);
    }
    for (const double quantile : kQuantiles) {
      const auto place = sides.begin() + static_cast<std::ptrdiff_t>(quantile * (sides.size() - 1.0));
      std::nth_element(sides.begin(), place, sides.end());
      const Division division = CountSides(objects, axis, *place);
      const double cost =
          std::fabs(static_cast<double>(division.below) - static_cast<double>(division.above)) +
          kCutWeight * static_cast<double>(division.cut);
      if (cost < least) least = cost, best = division;
    }
  }
  return best;
}

void BspTree::Divide(const std::vector<std::uint32_t>& objects, int depth) {
  const std::size_t at = nodes_.size(), count = objects.size();
  nodes_.emplace_back();
  depth_ = std::max(depth_, depth);
  Division division;
  bool leaf = count <= kFew || depth == deepest_;
  if (!leaf) {
    division = BestDivision(objects);
    leaf = division.below + division.cut == count || division.above + division.cut == count ||
           static_cast<double>(count + division.cut) > kMostCopies * static_cast<double>(count);
  }
  if (leaf) {
    ++leaves_;
    nodes_[at] = {0, static_cast<std::uint32_t>(ids_.size()), static_cast<std::uint32_t>(count), kLeaf};
    ids_.insert(ids_.end(), objects.begin(), objects.end());
    return;
  }
  std::vector<std::uint32_t> side;
  for (const std::uint32_t id : objects)
    if (boxes_[id].side[0][division.axis] < division.plane) side.push_back(id);
  Divide(side, depth + 1);
  side.clear();
  for (const std::uint32_t id : objects)
    if (boxes_[id].side[1][division.axis] > division.plane) side.push_back(id);
  nodes_[at] = {division.plane, static_cast<std::uint32_t>(nodes_.size()), 0,
                static_cast<std::uint8_t>(division.axis)};
  Divide(side, depth + 1);
}

}  // namespace facetless
