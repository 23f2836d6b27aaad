#include "render/accel/bvh.h"

#include <algorithm>

namespace facetless {
namespace {

// The number of objects below each node of a tree.
std::vector<std::uint32_t> CountObjects(const BvhTree& tree) {
  std::vector<std::uint32_t> counts(tree.nodes.size(), 0);
  // Children come before or after their parents, depending on the builder: go down first.
  std::vector<std::uint32_t> order;
  if (!(tree.root & BvhTree::kObject)) order.push_back(tree.root);
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const std::uint32_t child : {tree.nodes[order[i]].left, tree.nodes[order[i]].right})
      if (!(child & BvhTree::kObject)) order.push_back(child);
  for (std::size_t i = order.size(); i-- > 0;)
    for (const std::uint32_t child : {tree.nodes[order[i]].left, tree.nodes[order[i]].right})
      counts[order[i]] += child & BvhTree::kObject ? 1 : counts[child];
  return counts;
}

}  // namespace

Bvh::Bvh(std::span<const Box3> boxes, BvhBuild build) : boxes_(boxes) {
  if (boxes.empty()) return;
  Flatten(build == BvhBuild::kTopDown ? BuildTopDown(boxes_) : BuildBottomUp(boxes_));
  boxes_.ReleaseBoxes();
}

void Bvh::Flatten(const BvhTree& tree) {
  const std::vector<std::uint32_t> counts = CountObjects(tree);
  struct Task {
    std::uint32_t child;   // of the tree
    std::uint32_t parent;  // in nodes_, if this is a right child
    bool right;
    std::size_t depth;
  };
  std::vector<Task> tasks{{tree.root, 0, false, 0}};
  std::vector<std::uint32_t> below;
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    if (task.right) nodes_[task.parent].first = at;
    depth_ = std::max(depth_, task.depth);
    const bool object = task.child & BvhTree::kObject;
    const std::uint32_t count = object ? 1 : counts[task.child];
    Node& node = nodes_.emplace_back();
    node.box = object ? boxes_[task.child & ~BvhTree::kObject] : tree.nodes[task.child].box;
    if (count > kMostInLeaf) {
      tasks.push_back({tree.nodes[task.child].right, at, true, task.depth + 1});
      tasks.push_back({tree.nodes[task.child].left, at, false, task.depth + 1});
      continue;
    }
    // Gather the objects below.
    node.first = static_cast<std::uint32_t>(ids_.size());
    node.count = count;
    ++leaves_;
    below.assign(1, task.child);
    while (!below.empty()) {
      const std::uint32_t child = below.back();
      below.pop_back();
      if (child & BvhTree::kObject) {
        ids_.push_back(child & ~BvhTree::kObject);
        leaf_boxes_.push_back(boxes_[ids_.back()]);
      } else {
        below.push_back(tree.nodes[child].right);
        below.push_back(tree.nodes[child].left);
      }
    }
  }
  nodes_.shrink_to_fit();
}

double Bvh::ExpectedTests() const {
  if (nodes_.empty()) return 0;
  const double whole = HalfSurface(nodes_.front().box);
  double sum = 0;
  for (const Node& node : nodes_) sum += HalfSurface(node.box) * (node.count == 0 ? 2 : node.count);
  return whole > 0 ? sum / whole : sum;
}

}  // namespace facetless
