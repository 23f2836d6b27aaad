// The walks "kd-restart", "kd-backtrack" and "kd-shortstack" through octrees; P. Procházka (2013), section 4.3.2. A ray goes
// from leaf to leaf. Each next leaf is found from the root, or from a node on the path to the last leaf that still holds the
// ray, the restart node:
//
//     kd-restart     keeps nothing, so that the root is always the restart node;
//     kd-backtrack   keeps the whole path, and goes back along it;
//     kd-shortstack  keeps the lowest K nodes of the path, and takes the root if none of them holds the ray.
#include <algorithm>

#include "render/voxel_walks/cube_exit.h"
#include "render/voxel_walks/octree_path.h"
#include "render/voxel_walks/walks.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

// An inner node, and its cube.
struct Place {
  OctreeNode node;
  VoxelPoint low;
  int level;
};

// Stacks keep the lowest nodes of a path, the last one on top.
class NoStack {
 public:
  explicit NoStack(int) {}
  void Push(const Place&) {}
  bool Pop(Place*) { return false; }
};
class WholeStack {
 public:
  explicit WholeStack(int) {}
  void Push(const Place& place) { places_[size_++] = place; }
  bool Pop(Place* place) {
    if (size_ == 0) return false;
    *place = places_[--size_];
    return true;
  }

 private:
  Place places_[kMostOctreeLevels + 1];
  int size_ = 0;
};
class ShortStack {
 public:
  explicit ShortStack(int capacity) : capacity_(capacity) {}
  void Push(const Place& place) {
    places_[next_] = place;
    next_ = next_ + 1 == capacity_ ? 0 : next_ + 1;
    size_ = std::min(size_ + 1, capacity_);
  }
  bool Pop(Place* place) {
    if (size_ == 0) return false;
    --size_;
    next_ = next_ == 0 ? capacity_ - 1 : next_ - 1;
    *place = places_[next_];
    return true;
  }

 private:
  Place places_[kMostShortstack];
  const int capacity_;
  int next_ = 0, size_ = 0;
};

template <typename Stack, typename Exit>
VoxelHit WalkKd(const OctreeModel& model, const VoxelRay& ray, const WalkOptions& options, int capacity,
                WalkCounters* counters) {
  ++counters->rays;
  const Exit cube_exit(ray, model.level());
  const bool levels = options.footprint_0 + options.footprint * std::min(ray.t_last(), 1e300) >= 2;
  Stack stack(capacity);
  double t = ray.t_first();
  std::uint64_t steps = 0, nodes = 1;
  OctreeNode node = model.root();
  VoxelPoint low{0, 0, 0};
  int level = model.level();
  VoxelHit hit;
  for (;;) {
    // Address the leaf that holds t, from the restart node down.
    while (!node.leaf()) {
      if (levels && StopsAt(ray, options, low, level, t)) {
        hit = ray.HitAt(ray.EnterAt(low, 1 << level), node.voxel, level);
        break;
      }
      const OctreeNode* const children = model.Children(node);
      stack.Push({node, low, level});
      --level;
      const int x = ray.IsAbove(0, low.x + (1 << level), t), y = ray.IsAbove(1, low.y + (1 << level), t),
                z = ray.IsAbove(2, low.z + (1 << level), t);
      low = {low.x + (x << level), low.y + (y << level), low.z + (z << level)};
      node = children[x | y << 1 | z << 2];
      ++nodes;
    }
    if (hit.hit()) break;
    ++steps;
    if (node.voxel.filled()) {
      hit = LeafHit(ray, t, node.voxel, low, level);
      break;
    }
    t = cube_exit.Leave(low, 1 << level);
    if (!(t < ray.t_last())) break;
    // Find the restart node.
    Place place;
    bool found = false;
    while (!found && stack.Pop(&place)) found = t < cube_exit.Leave(place.low, 1 << place.level);
    if (!found) {
      place = {model.root(), {0, 0, 0}, model.level()};
      ++nodes;
    }
    node = place.node;
    low = place.low;
    level = place.level;
  }
  counters->steps += steps;
  counters->nodes += nodes;
  return hit;
}

template <typename Stack, typename Exit>
class BoundKd final : public BoundWalk {
 public:
  BoundKd(const OctreeModel& model, int capacity) : model_(model), capacity_(capacity) {}
  VoxelHit Walk(const VoxelRay& ray, const WalkOptions& options, WalkCounters* counters) const override {
    return WalkKd<Stack, Exit>(model_, ray, options, capacity_, counters);
  }

 private:
  const OctreeModel& model_;
  const int capacity_;
};

template <typename Stack, typename Exit>
std::unique_ptr<const BoundWalk> Bind(const VoxelModel& model, int setting) {
  return std::make_unique<BoundKd<Stack, Exit>>(static_cast<const OctreeModel&>(model), setting);
}

}  // namespace

std::unique_ptr<const BoundWalk> BindKdRestart(const VoxelModel& model, int setting) {
  return Bind<NoStack, LeastExit>(model, setting);
}
std::unique_ptr<const BoundWalk> BindKdRestartSorted(const VoxelModel& model, int setting) {
  return Bind<NoStack, SortedExit>(model, setting);
}
std::unique_ptr<const BoundWalk> BindKdBacktrack(const VoxelModel& model, int setting) {
  return Bind<WholeStack, LeastExit>(model, setting);
}
std::unique_ptr<const BoundWalk> BindKdShortstack(const VoxelModel& model, int setting) {
  return Bind<ShortStack, LeastExit>(model, setting);
}

}  // namespace facetless
