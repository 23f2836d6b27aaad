#include "render/accel/uni_tree.h"

#include <numeric>

namespace facetless {
namespace {

// The universe of a box among the 27: on each axis 0 below, 1 cut, 2 above.
std::uint32_t UniverseOf(const SlabBox& box, const double (&middle)[3]) {
  std::uint32_t universe = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const bool below = box.side[1][axis] <= middle[axis], above = box.side[0][axis] >= middle[axis];
    universe = 3 * universe + (below ? 0 : above ? 2 : 1);
  }
  return universe;
}

}  // namespace

UniTree::UniTree(std::span<const Box3> boxes) : boxes_(boxes) {
  std::vector<std::uint32_t> all(boxes_.size());
  std::iota(all.begin(), all.end(), 0u);
  nodes_.emplace_back();
  nodes_.front().box = boxes_.bounds();
  Divide(0, all, 0);
  nodes_.shrink_to_fit();
  ids_.shrink_to_fit();
  planes_.shrink_to_fit();
}

// Divides the universe `node`, whose box is set, or makes it a leaf.
void UniTree::Divide(std::uint32_t node, const std::vector<std::uint32_t>& objects, int depth) {
  depth_ = std::max(depth_, depth);
  std::array<std::vector<std::uint32_t>, kMostChildren> universes;
  std::uint32_t children = 0;
  if (objects.size() > kFew && depth < kDeepest) {
    double middle[3];
    const SlabBox& box = nodes_[node].box;
    for (int axis = 0; axis < 3; ++axis) middle[axis] = 0.5 * box.side[0][axis] + 0.5 * box.side[1][axis];
    for (const std::uint32_t id : objects) {
      std::vector<std::uint32_t>& universe = universes[UniverseOf(boxes_[id], middle)];
      children += universe.empty();
      universe.push_back(id);
    }
  }
  if (children < 2) {
    ++leaves_;
    nodes_[node].first = static_cast<std::uint32_t>(ids_.size());
    nodes_[node].count = static_cast<std::uint32_t>(objects.size());
    ids_.insert(ids_.end(), objects.begin(), objects.end());
    return;
  }
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].leaf = false;
  nodes_[node].first = first;
  nodes_[node].count = children;
  nodes_[node].planes = static_cast<std::uint32_t>(planes_.size());
  nodes_.resize(nodes_.size() + children);
  std::vector<SlabBox> boxes;
  for (const std::vector<std::uint32_t>& universe : universes) {
    if (universe.empty()) continue;
    SlabBox box = boxes_[universe.front()];
    for (const std::uint32_t id : universe) box = UnionOf(box, boxes_[id]);
    nodes_[first + boxes.size()].box = box;
    boxes.push_back(box);
  }
  AppendPlanes(boxes, planes_);
  std::uint32_t child = first;
  for (std::vector<std::uint32_t>& universe : universes) {
    if (universe.empty()) continue;
    Divide(child++, universe, depth + 1);
    std::vector<std::uint32_t>().swap(universe);
  }
}

std::size_t UniTree::bytes() const {
  return boxes_.bytes() + nodes_.capacity() * sizeof(Node) + ids_.capacity() * sizeof(std::uint32_t) +
         planes_.capacity() * sizeof(BoxPlane);
}

}  // namespace facetless
