// A bounding volume hierarchy over the screen boxes of leaves: rectangles of pixels with the depth at which
// their content begins. Nodes are halved at the median of the longer side. It competes with the bitmaps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "render/nurbs/leaf.h"

namespace facetless {

class LeafTree {
 public:
  explicit LeafTree(std::span<const CertifiedLeaf> leaves);

  // Calls meet(leaf) for the leaves whose boxes contain the pixel, roughly front to back. meet returns the
  // nearest depth so far; boxes that begin behind it are skipped.
  template <typename Meet>
  void Visit(int column, int row, Meet&& meet) const {
    std::array<std::uint32_t, kMostWaiting> waiting;
    int count = 0;
    double nearest = INFINITY;
    if (Holds(nodes_[0], column, row)) waiting[count++] = 0;
    while (count > 0) {
      const Node& node = nodes_[waiting[--count]];
      if (node.near_depth > nearest) continue;
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
          if (Holds(boxes_[i], column, row) && boxes_[i].near_depth <= nearest)
            nearest = meet(boxes_[i].first);
        continue;
      }
      // Put the nearer child on top of the stack.
      std::uint32_t near = node.first, far = node.first + 1;
      if (nodes_[far].near_depth < nodes_[near].near_depth) std::swap(near, far);
      if (Holds(nodes_[far], column, row)) waiting[count++] = far;
      if (Holds(nodes_[near], column, row)) waiting[count++] = near;
    }
  }
  std::size_t bytes() const { return (nodes_.size() + boxes_.size()) * sizeof(Node); }

 private:
  static constexpr std::uint32_t kLeavesPerNode = 4;
  // The tree is balanced, so its depth is the logarithm of the number of leaves.
  static constexpr int kMostWaiting = 64;

  struct Node {
    std::int32_t col_begin = INT32_MAX, col_end = INT32_MIN, row_begin = INT32_MAX, row_end = INT32_MIN;
    double near_depth = INFINITY;
    // An inner node has the index of its left child in `first`. A leaf node has a range of boxes, and a box
    // has its leaf.
    std::uint32_t first = 0, count = 0;
  };
  static bool Holds(const Node& node, int column, int row) {
    return (node.col_begin <= column) & (column < node.col_end) & (node.row_begin <= row) &
           (row < node.row_end);
  }
  void Build(std::uint32_t at, std::uint32_t begin, std::uint32_t end);

  std::vector<Node> nodes_, boxes_;
};

}  // namespace facetless
