#include "render/accel/octree.h"

#include <cmath>
#include <numeric>

#include "render/accel/voxels.h"

namespace facetless {
namespace {

// The depth at which evenly spread objects would be alone, and three more levels for clusters.
int DepthFor(std::size_t objects) {
  constexpr int kMore = 3;
  int depth = 0;
  while (depth < Octree::kDeepest && std::pow(8.0, depth) < static_cast<double>(objects)) ++depth;
  return objects <= Octree::kFew ? 0 : std::min(Octree::kDeepest, depth + kMore);
}

}  // namespace

Octree::Octree(std::span<const Box3> boxes, OctreeRestart restart)
    : boxes_(boxes), restart_(restart), depth_(DepthFor(boxes.size())) {
  const std::uint32_t width = std::uint32_t{1} << depth_;
  const VoxelPlanes planes = EvenPlanes(boxes_.bounds(), {width, width, width});
  for (int axis = 0; axis < 3; ++axis) planes_[axis].assign(planes.axis(axis), planes.axis(axis) + width + 1);
  std::vector<Reach> reaches(boxes_.size());
  for (std::uint32_t id = 0; id < boxes_.size(); ++id)
    for (int axis = 0; axis < 3; ++axis) {
      const VoxelPlanes::Range range = planes.Reach(boxes_[id], axis);
      reaches[id].first[axis] = static_cast<std::uint16_t>(range.first);
      reaches[id].last[axis] = static_cast<std::uint16_t>(range.last);
    }
  std::vector<std::uint32_t> all(boxes_.size());
  std::iota(all.begin(), all.end(), 0u);
  nodes_.emplace_back();
  Divide(0, depth_, {0, 0, 0}, all, reaches);
  nodes_.shrink_to_fit();
  ids_.shrink_to_fit();
}

// Divides the voxel `node` of a level, whose first smallest voxel is `first`, or makes it a leaf.
void Octree::Divide(std::uint32_t node, int level, const std::array<std::uint32_t, 3>& first,
                    const std::vector<std::uint32_t>& objects, const std::vector<Reach>& reaches) {
  std::array<std::vector<std::uint32_t>, 8> parts;
  bool leaf = level == 0 || objects.size() <= kFew;
  if (!leaf) {
    const std::uint32_t half = std::uint32_t{1} << (level - 1);
    std::size_t copies = 0;
    for (const std::uint32_t id : objects) {
      bool side[3][2];
      for (int axis = 0; axis < 3; ++axis) {
        side[axis][0] = reaches[id].first[axis] < first[axis] + half;
        side[axis][1] = reaches[id].last[axis] >= first[axis] + half;
      }
      for (std::uint32_t part = 0; part < 8; ++part)
        if (side[0][part & 1] && side[1][part >> 1 & 1] && side[2][part >> 2]) {
          parts[part].push_back(id);
          ++copies;
        }
    }
    leaf = static_cast<double>(copies) > kMostCopies * static_cast<double>(objects.size());
  }
  if (leaf) {
    ++leaves_;
    nodes_[node] = {static_cast<std::uint32_t>(ids_.size()), static_cast<std::uint32_t>(objects.size()),
                    false};
    ids_.insert(ids_.end(), objects.begin(), objects.end());
    return;
  }
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node] = {children, 0, true};
  nodes_.resize(nodes_.size() + 8);
  const std::uint32_t half = std::uint32_t{1} << (level - 1);
  for (std::uint32_t part = 0; part < 8; ++part) {
    Divide(children + part, level - 1,
           {first[0] + half * (part & 1), first[1] + half * (part >> 1 & 1), first[2] + half * (part >> 2)},
           parts[part], reaches);
    std::vector<std::uint32_t>().swap(parts[part]);
  }
}

std::size_t Octree::bytes() const {
  std::size_t bytes =
      boxes_.bytes() + nodes_.capacity() * sizeof(Node) + ids_.capacity() * sizeof(std::uint32_t);
  for (const std::vector<double>& planes : planes_) bytes += planes.capacity() * sizeof(double);
  return bytes;
}

}  // namespace facetless
