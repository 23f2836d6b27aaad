// A BSP tree with planes across the axes (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der
// Schnittpunktberechnung", section "BSP-tree"), at boundaries of objects.
//
//     const BspTree tree(boxes);
//     QueryState state(tree.state_size());
//     tree.Visit({origin, direction}, state, visit);
//
//  1. Each plane lies at a side of a box. Of the sides near the median of each axis, the plane is taken that
//     leaves the numbers of objects on both sides most alike, and cuts the fewest: the smallest
//     |n_left − n_right| + kCutWeight · n_cut. The axes come in any order.
//  2. A voxel is divided no further if it has kFew objects or fewer, at the greatest depth, and if no plane
//     separates: if both sides together would list more than kMostCopies times its objects.
//  3. A ray visits the side of a plane first in which it begins, and the other one unless the interval ends
//     before the plane. So leaves are visited strictly from front to back.
//  4. The source's estimate is that of Octree for evenly spread objects; the gain is in clusters, where the
//     leaves have about as many objects each.
//  5. An object is asked once per ray, with the numbers of rays of QueryState. Laws 4 and 5 of grid.h hold.
#pragma once

#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

class BspTree {
 public:
  static constexpr bool kOnce = true;
  static constexpr std::uint32_t kFew = 6;
  static constexpr double kCutWeight = 2, kMostCopies = 1.6;

  explicit BspTree(std::span<const Box3> boxes);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    QueryState::Waiting* const stack = state.stack();
    std::size_t waiting = 0;
    stack[waiting++] = {0, ray.t_first, ray.t_last};
    while (waiting > 0) {
      const QueryState::Waiting next = stack[--waiting];
      if (next.t_in > ray.t_last) return;  // those below it on the stack begin even later
      std::uint32_t at = next.node;
      double t_out = next.t_out;
      while (nodes_[at].axis < kLeaf) {
        const Node& node = nodes_[at];
        const double t = ray.Pass(node.axis, node.plane);
        const bool up = ray.near_side[node.axis] == 0;
        const std::uint32_t near = up ? at + 1 : node.first, far = up ? node.first : at + 1;
        if (t < next.t_in) {
          at = far;
        } else if (t > t_out) {
          at = near;
        } else {
          stack[waiting++] = {far, t, t_out};
          t_out = t;
          at = near;
        }
      }
      ++state.counters.regions;
      const Node& leaf = nodes_[at];
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        const std::uint32_t id = ids_[i];
        if (!state.FirstTime(id)) {
          ++state.counters.repeats;
          continue;
        }
        ++state.counters.tests;
        if (!Meets(ray, boxes_[id])) continue;
        Report(ray, state, id, visit);
        if (ray.ended()) return;
      }
    }
  }
  StateSize state_size() const {
    return {.stamps = boxes_.size(), .stack = static_cast<std::size_t>(depth_) + 1};
  }
  std::size_t bytes() const {
    return boxes_.bytes() + nodes_.capacity() * sizeof(Node) + ids_.capacity() * sizeof(std::uint32_t);
  }
  StructureFigures figures() const {
    return {static_cast<double>(leaves_), static_cast<double>(ids_.size()), depth_};
  }

 private:
  static constexpr std::uint8_t kLeaf = 3;  // in place of an axis
  struct Node {
    double plane = 0;
    std::uint32_t first =
        0;  // of a leaf: in ids_; otherwise the child above the plane; the one below follows
    std::uint32_t count = 0;  // of a leaf
    std::uint8_t axis = kLeaf;
  };
  struct Division {
    int axis = -1;
    double plane = 0;
    std::size_t below = 0, above = 0, cut = 0;  // below and above: those that are cut are in neither
  };

  void Divide(const std::vector<std::uint32_t>& objects, int depth);
  Division BestDivision(const std::vector<std::uint32_t>& objects) const;
  Division CountSides(const std::vector<std::uint32_t>& objects, int axis, double plane) const;

  BoxSet boxes_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
  std::size_t leaves_ = 0;
  int depth_ = 0, deepest_ = 0;
};

}  // namespace facetless
