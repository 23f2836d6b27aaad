// A bounding volume hierarchy of boxes (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der
// Schnittpunktberechnung", section "Nutzen von hierarchischen BoundingVolumes"), built from the top down or
// from the bottom up.
//
//     const Bvh bvh(boxes, BvhBuild::kTopDown);
//     QueryState state(bvh.state_size());
//     bvh.Visit({origin, direction}, state, visit);
//
//  1. Each object is in one leaf of a binary tree, and each node has the common box of its objects. A ray
//     asks the objects of a leaf only if it meets the boxes of all nodes above. Nothing is listed twice.
//  2. kTopDown: objects are divided where the surface area heuristic finds the least cost among kBins planes
//     per axis: N_left·A_left + N_right·A_right (J. Goldsmith, J. Salmon, "Automatic Creation of Object
//     Hierarchies for Ray Tracing"; I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies",
//     section 3).
//  3. kBottomUp: objects in the order of a space-filling curve are the first clusters. Each cluster looks for
//     the neighbour, within kRadius places, with which it has the box of the least surface, and pairs that
//     chose each other become one cluster, until one is left (D. Meister, J. Bittner, "Parallel
//     Locally-Ordered Clustering for Bounding Volume Hierarchy Construction"). Subtrees of few objects become
//     leaves.
//  4. Of the two children, the one that the ray enters first is visited first. Children may overlap, so the
//     visit of a child may find a hit that lies behind the begin of the other: it is left out only if it
//     begins behind the nearest hit.
//  5. In the worst case, a ray asks all objects, as if they were the pearls of a necklace.
#pragma once

#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

enum class BvhBuild : std::uint8_t { kTopDown, kBottomUp };

// A tree while it is built: inner nodes and objects by number.
struct BvhTree {
  struct Node {
    SlabBox box;
    // The children of an inner node: numbers of nodes, or kObject + id.
    std::uint32_t left = 0, right = 0;
  };
  static constexpr std::uint32_t kObject = std::uint32_t{1} << 31;
  std::vector<Node> nodes;
  std::uint32_t root = 0;  // as for a child
};

// The two builders. Both require at least one box.
BvhTree BuildTopDown(const BoxSet& boxes);
BvhTree BuildBottomUp(const BoxSet& boxes);

class Bvh {
 public:
  static constexpr bool kOnce = true;
  static constexpr std::uint32_t kMostInLeaf = 4;

  Bvh(std::span<const Box3> boxes, BvhBuild build);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    QueryState::Waiting* const stack = state.stack();
    std::size_t waiting = 0;
    std::uint32_t at = 0;
    double left_in, right_in, out;
    for (;;) {
      const Node& node = nodes_[at];
      ++state.counters.regions;
      if (node.count == 0) {
        const bool left = Meets(ray, nodes_[at + 1].box, left_in, out);
        const bool right = Meets(ray, nodes_[node.first].box, right_in, out);
        if (left && right) {
          const bool left_first = left_in <= right_in;
          stack[waiting++] = {left_first ? node.first : at + 1, left_first ? right_in : left_in, 0};
          at = left_first ? at + 1 : node.first;
          continue;
        }
        if (left || right) {
          at = left ? at + 1 : node.first;
          continue;
        }
      } else {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          ++state.counters.tests;
          if (Meets(ray, leaf_boxes_[i])) Report(ray, state, ids_[i], visit);
          if (ray.ended()) return;
        }
      }
      do {
        if (waiting == 0) return;
        --waiting;
      } while (stack[waiting].t_in > ray.t_last);
      at = stack[waiting].node;
    }
  }
  StateSize state_size() const { return {.stack = depth_ + 1}; }
  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + leaf_boxes_.capacity() * sizeof(SlabBox) +
           ids_.capacity() * sizeof(std::uint32_t);
  }
  StructureFigures figures() const {
    return {static_cast<double>(leaves_), static_cast<double>(ids_.size()), static_cast<int>(depth_)};
  }
  // The expected number of boxes that a ray through the scene tests: the sum of the surfaces of all nodes,
  // each times its children or objects, over that of the root.
  double ExpectedTests() const;

 private:
  struct Node {
    SlabBox box;
    std::uint32_t first = 0;  // of an inner node, the right child; the left child follows the node
    std::uint32_t count = 0;  // of a leaf, its objects: first … first + count − 1
  };

  void Flatten(const BvhTree& tree);

  BoxSet boxes_;
  std::vector<Node> nodes_;
  std::vector<SlabBox> leaf_boxes_;
  std::vector<std::uint32_t> ids_;
  std::size_t depth_ = 0, leaves_ = 0;
};

}  // namespace facetless
