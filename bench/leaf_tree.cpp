#include "bench/leaf_tree.h"

namespace facetless {

LeafTree::LeafTree(std::span<const CertifiedLeaf> leaves) {
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    const SampleBox box = leaves[i].box;
    boxes_.push_back(
        {box.col_begin(), box.col_end(), box.row_begin(), box.row_end(), leaves[i].near_depth, i, 0});
  }
  nodes_.reserve(leaves.size());
  nodes_.emplace_back();
  Build(0, 0, static_cast<std::uint32_t>(boxes_.size()));
}

void LeafTree::Build(std::uint32_t at, std::uint32_t begin, std::uint32_t end) {
  Node node;
  for (std::uint32_t i = begin; i < end; ++i) {
    node.col_begin = std::min(node.col_begin, boxes_[i].col_begin);
    node.col_end = std::max(node.col_end, boxes_[i].col_end);
    node.row_begin = std::min(node.row_begin, boxes_[i].row_begin);
    node.row_end = std::max(node.row_end, boxes_[i].row_end);
    node.near_depth = std::min(node.near_depth, boxes_[i].near_depth);
  }
  if (end - begin <= kLeavesPerNode) {
    node.first = begin;
    node.count = end - begin;
    nodes_[at] = node;
    return;
  }
  const bool wide = node.col_end - node.col_begin > node.row_end - node.row_begin;
  const auto middle_of = [&](const Node& box) {
    return wide ? box.col_begin + box.col_end : box.row_begin + box.row_end;
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(boxes_.begin() + begin, boxes_.begin() + middle, boxes_.begin() + end,
                   [&](const Node& a, const Node& b) { return middle_of(a) < middle_of(b); });
  node.first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[at] = node;
  nodes_.resize(nodes_.size() + 2);
  Build(node.first, begin, middle);
  Build(node.first + 1, middle, end);
}

}  // namespace facetless
