// A uni-tree (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der Schnittpunktberechnung", section
// "Uni-tree"): an octree whose voxels don't share objects. What a plane cuts gets universes of its own.
//
//     const UniTree tree(boxes);
//     QueryState state(tree.state_size());
//     tree.Visit({origin, direction}, state, visit);
//
//  1. The three planes through the middle of a universe's box divide its objects: on each axis, an object is
//     below the plane, above it, or cut by it. Objects that agree on all three axes form a universe, so there
//     are up to 27 of them. Each object is in one leaf, and nothing is listed twice.
//  2. A universe has the common box of its objects. The boxes of universes overlap, so those below a node are
//     searched by plane traversal (PassPlanes): a ray visits them in the order in which it enters them, and
//     leaves out those that it enters behind the nearest hit. The nearest hit may come from any of them.
//  3. A universe is a leaf if it has kFew objects or fewer, if all its objects fall into one universe, and at
//     kDeepest levels below the root. The objects of a leaf are tested one after the other.
//  4. Rays from so far away that rounding exceeds the boxes' margin (BoxSet::TooFar) are answered by a scan.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/accel/plane_traversal.h"
#include "render/accel/structure.h"

namespace facetless {

class UniTree {
 public:
  static constexpr bool kOnce = true;
  static constexpr std::uint32_t kFew = 4;
  static constexpr int kDeepest = 40;
  static constexpr std::uint32_t kMostChildren = 27;

  explicit UniTree(std::span<const Box3> boxes);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    VisitUniverse(0, ray, state, visit);
  }
  StateSize state_size() const { return {}; }
  std::size_t bytes() const;
  StructureFigures figures() const {
    return {static_cast<double>(leaves_), static_cast<double>(ids_.size()), depth_};
  }

 private:
  struct Node {
    SlabBox box;
    std::uint32_t first = 0;   // the first child, or of a leaf its place in ids_
    std::uint32_t count = 0;   // children, or objects of a leaf
    std::uint32_t planes = 0;  // the place of the children's planes
    bool leaf = true;
  };

  template <typename Visitor>
  void VisitUniverse(std::uint32_t at, SlabRay& ray, QueryState& state, Visitor& visit) const {
    const Node& node = nodes_[at];
    ++state.counters.regions;
    if (node.leaf) {
      for (std::uint32_t i = node.first; i < node.first + node.count && !ray.ended(); ++i) {
        ++state.counters.tests;
        if (Meets(ray, boxes_[ids_[i]])) Report(ray, state, ids_[i], visit);
      }
      return;
    }
    std::array<std::int8_t, kMostChildren> inside{};
    PassPlanes(
        ray, planes_.data() + node.planes, node.count,
        [&](std::uint32_t child, int by) {
          return inside[child] = static_cast<std::int8_t>(inside[child] + by);
        },
        [&](std::uint32_t child) {
          if (Meets(ray, nodes_[node.first + child].box))
            VisitUniverse(node.first + child, ray, state, visit);
        });
  }
  void Divide(std::uint32_t node, const std::vector<std::uint32_t>& objects, int depth);

  BoxSet boxes_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
  std::vector<BoxPlane> planes_;
  std::size_t leaves_ = 0;
  int depth_ = 0;
};

}  // namespace facetless
