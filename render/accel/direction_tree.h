// A direction tree (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der Schnittpunktberechnung",
// section "Direction-tree"): a ray has five dimensions, three of its start and two of its direction, and the
// tree divides all of them. A leaf is the beam of all rays that start in a voxel and point through a part of
// one face of a cube around it, and lists the objects that the beam meets, sorted in depth.
//
//     const DirectionTree tree(boxes, {.most_bytes = std::size_t{1} << 26});
//     QueryState state(tree.state_size());
//     tree.Visit({origin, direction}, state, visit);  // builds what this ray needs
//
//  1. The direction's largest component names the face, one of six, and u and v in [−1, 1] are the other two
//     components divided by its size. Each level halves x, y, z, u and v, so a node has 32 children.
//  2. A beam lists each object whose box it can meet; a few more, since its sides are taken as intervals for
//     each depth. A ray runs within one beam, so it descends once, and asks the objects of one leaf. They are
//     sorted by the depth at which their boxes begin, and the ray stops at the first that begins behind its
//     nearest hit.
//  3. A ray that starts outside of the scene's box is taken from where it enters it.
//  4. Nodes are made when a ray first needs them, from the objects of their parent. This is the only
//     structure whose queries change it. Each child is an atomic pointer: threads that need the same child at
//     the same time both make it, and one of the two is kept. Answers don't depend on it.
//  5. When the nodes take `most_bytes`, no more are made (beyond one for each thread that is making one), and
//     rays ask the objects of the deepest node that exists on their way.
//  6. A node is divided no further if it lists kFew objects or fewer, and at the depth kDeepest.
//  7. With c levels, of which each multiplies the references by k, the source estimates k^c·n / 2^(5c) tests
//     per ray; c = 3 and k = 8 give 0.0156.
//  8. Rays from so far away that rounding exceeds the boxes' margin (BoxSet::TooFar) are answered by a scan.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

struct DirectionTreeSettings {
  std::size_t most_bytes = std::size_t{1} << 28;  // of the nodes
};

// The share of n tests that remains by the source's estimate (law 7).
double DirectionTreeEstimate(int levels, double copies_per_level);

class DirectionTree {
 public:
  static constexpr bool kOnce = true;
  static constexpr std::uint32_t kFew = 8;
  static constexpr int kDeepest = 6;

  explicit DirectionTree(std::span<const Box3> boxes, DirectionTreeSettings settings = {});
  ~DirectionTree();
  DirectionTree(const DirectionTree&) = delete;
  DirectionTree& operator=(const DirectionTree&) = delete;

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    int levels = 0;
    const Node& node = Find(ray, levels);
    state.counters.regions += static_cast<std::uint64_t>(levels);
    const int axis = node.beam.axis, near = ray.near_side[axis];
    for (const std::uint32_t id : node.ids) {
      const double begin = (boxes_[id].side[near][axis] - ray.origin[axis]) * ray.near_inverse[axis];
      if (begin > ray.t_last || ray.ended()) return;
      ++state.counters.tests;
      if (Meets(ray, boxes_[id])) Report(ray, state, id, visit);
    }
  }
  StateSize state_size() const { return {}; }
  // What is built so far.
  std::size_t bytes() const { return boxes_.bytes() + node_bytes(); }
  std::size_t node_bytes() const { return bytes_.load(std::memory_order_relaxed); }
  StructureFigures figures() const;

 private:
  // The rays that start in a voxel, and whose direction has |d[axis]| = 1 with the given sign and the other
  // two components, of the axes after it in cyclic order, in an interval each.
  struct Beam {
    int axis = 0;
    bool positive = true;
    double low[3], high[3];  // the voxel
    double slope_low[2], slope_high[2];
  };
  struct Node {
    Beam beam;
    int depth = 0;
    std::vector<std::uint32_t> ids;                  // by the depth at which boxes begin
    std::unique_ptr<std::atomic<Node*>[]> children;  // 32 of them; none: a leaf
    ~Node();
  };
  static constexpr int kChildren = 32;

  // The deepest node for the ray, which is made if it is missing. `levels`: how many were passed.
  const Node& Find(const SlabRay& ray, int& levels) const;
  const Node* Child(const Node& node, int child) const;
  std::unique_ptr<Node> MakeNode(const Beam& beam, int depth,
                                 std::span<const std::uint32_t> candidates) const;
  bool BeamMeets(const Beam& beam, const SlabBox& box) const;
  static std::size_t BytesOf(const Node& node);
  static void AddFigures(const Node& node, StructureFigures& figures);

  BoxSet boxes_;
  DirectionTreeSettings settings_;
  double margin_ = 0;  // of a ray's start
  std::unique_ptr<Node> roots_[6];
  mutable std::atomic<std::size_t> bytes_{0};
};

}  // namespace facetless
