// The walk "neighbours": from a leaf of an octree, a ray goes to the neighbour beyond the side through which it leaves, by a
// link; P. Procházka (2013), section 4.3.2. H. Samet's survey calls such links ropes.
//
//  1. Each node has six links, one for each side: to the node of its own size that lies beyond the side, or to the leaf that
//     holds this place if the leaf is larger. Outside the root there is none.
//  2. A ray that passes planes of two axes at once, or of two nodes along an axis as they are rounded, does not enter the
//     linked node. It starts again at the root. So does a ray that may stop at a node larger than the linked one.
#include <algorithm>
#include <array>
#include <vector>

#include "render/voxel_walks/octree_path.h"
#include "render/voxel_walks/walks.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

class BoundNeighbours final : public BoundWalk {
 public:
  explicit BoundNeighbours(const OctreeModel& model) : model_(model), first_(model.Children({})) {
    std::vector<Id> waiting{kRoot};
    links_.resize(1);
    levels_.resize(1);
    links_[kRoot].fill(kNone);
    levels_[kRoot] = static_cast<std::uint8_t>(model.level());
    while (!waiting.empty()) {
      const Id id = waiting.back();
      waiting.pop_back();
      const OctreeNode& node = At(id);
      if (node.leaf()) continue;
      const Id children = ChildrenOf(node);
      if (children + 8 > links_.size()) {
        links_.resize(children + 8);
        levels_.resize(children + 8);
      }
      for (Id child = 0; child < 8; ++child) {
        levels_[children + child] = static_cast<std::uint8_t>(levels_[id] - 1);
        waiting.push_back(children + child);
        for (unsigned axis = 0; axis < 3; ++axis)
          for (unsigned up = 0; up < 2; ++up)
            links_[children + child][2 * axis + up] = LinkOf(id, children, child, axis, up);
      }
    }
  }

  VoxelHit Walk(const VoxelRay& ray, const WalkOptions& options, WalkCounters* counters) const override;
  std::uint64_t bytes() const override {
    return links_.capacity() * sizeof(Links) + levels_.capacity() * sizeof(std::uint8_t);
  }

 private:
  // A node is named by its place in the blocks. The first block is not used, so that the root takes its first place.
  using Id = std::uint32_t;
  using Links = std::array<Id, 6>;
  static constexpr Id kRoot = 0, kNone = 0xffffffffu;

  const OctreeNode& At(Id id) const { return id == kRoot ? model_.root() : first_[id]; }
  Id ChildrenOf(const OctreeNode& node) const { return static_cast<Id>(model_.Children(node) - first_); }
  Id LinkOf(Id parent, Id children, Id child, unsigned axis, unsigned up) const {
    const Id beyond = child ^ (1u << axis);
    // The neighbour is a sibling, or lies in the neighbour of the parent.
    if ((child >> axis & 1) != up) return children + beyond;
    const Id neighbour = links_[parent][2 * axis + up];
    if (neighbour == kNone || At(neighbour).leaf()) return neighbour;
    return ChildrenOf(At(neighbour)) + beyond;
  }

  const OctreeModel& model_;
  const OctreeNode* const first_;
  std::vector<Links> links_;
  std::vector<std::uint8_t> levels_;
};

VoxelHit BoundNeighbours::Walk(const VoxelRay& ray, const WalkOptions& options,
                               WalkCounters* counters) const {
  ++counters->rays;
  const bool levels = options.footprint_0 + options.footprint * std::min(ray.t_last(), 1e300) >= 2;
  double t = ray.t_first();
  Id id = kRoot;
  VoxelPoint low{0, 0, 0};
  std::uint64_t steps = 0, nodes = 1;
  VoxelHit hit;
  for (;;) {
    int level = levels_[id];
    const OctreeNode* node = &At(id);
    while (!node->leaf()) {
      if (levels && StopsAt(ray, options, low, level, t)) {
        hit = ray.HitAt(ray.EnterAt(low, 1 << level), node->voxel, level);
        break;
      }
      --level;
      const int x = ray.IsAbove(0, low.x + (1 << level), t), y = ray.IsAbove(1, low.y + (1 << level), t),
                z = ray.IsAbove(2, low.z + (1 << level), t);
      low = {low.x + (x << level), low.y + (y << level), low.z + (z << level)};
      id = ChildrenOf(*node) + static_cast<Id>(x | y << 1 | z << 2);
      node = &first_[id];
      ++nodes;
    }
    if (hit.hit()) break;
    ++steps;
    if (node->voxel.filled()) {
      hit = LeafHit(ray, t, node->voxel, low, level);
      break;
    }
    int* const lows[3] = {&low.x, &low.y, &low.z};
    double leave[3];
    for (int axis = 0; axis < 3; ++axis)
      leave[axis] = ray.Leave(axis, *lows[axis], *lows[axis] + (1 << level));
    t = std::min(std::min(leave[0], leave[1]), leave[2]);
    if (!(t < ray.t_last())) break;
    const int side = leave[0] == t ? 0 : leave[1] == t ? 1 : 2;
    const bool one_side = (leave[0] == t) + (leave[1] == t) + (leave[2] == t) == 1;
    const Id link = links_[id][static_cast<std::size_t>(2 * side + (ray.sign(side) > 0))];
    ++nodes;
    if (one_side && link != kNone) {
      // The linked cube holds the place beyond the side.
      const int edge = 1 << levels_[link];
      *lows[side] += ray.sign(side) > 0 ? 1 << level : -1;
      low = {low.x & -edge, low.y & -edge, low.z & -edge};
      if (t < ray.Leave(side, *lows[side], *lows[side] + edge) &&
          !(levels && 2.0 * edge <= options.footprint_0 + options.footprint * t)) {
        id = link;
        continue;
      }
    }
    id = kRoot;
    low = {0, 0, 0};
  }
  counters->steps += steps;
  counters->nodes += nodes;
  return hit;
}

}  // namespace

std::unique_ptr<const BoundWalk> BindNeighbours(const VoxelModel& model, int) {
  return std::make_unique<BoundNeighbours>(static_cast<const OctreeModel&>(model));
}

}  // namespace facetless
