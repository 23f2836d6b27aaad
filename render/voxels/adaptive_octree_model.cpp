#include "render/voxels/adaptive_octree_model.h"

#include <algorithm>
#include <utility>

namespace facetless {

AdaptiveOctreeModel::AdaptiveOctreeModel(VoxelPoint size)
    : RebuiltModel(size), level_(LevelOf(size)), blocks_(1), bricks_(1) {}

AdaptiveOctreeModel::AdaptiveOctreeModel(const RunModel& runs) : AdaptiveOctreeModel(runs.size()) {
  Compile(runs);
}

void AdaptiveOctreeModel::Compile(const RunModel& runs) {
  blocks_.assign(1, {});
  bricks_.assign(1, {});
  voxels_.clear();
  root_ = Compile(runs, {{0, 0, 0}, level_}).node;
}

AdaptiveOctreeModel::Subtree AdaptiveOctreeModel::Compile(const RunModel& runs, const VoxelCube& cube) {
  if (const std::optional<Voxel> uniform = runs.Uniform(cube.box()))
    return {{*uniform, 0}, uniform->filled() ? cube.volume() : 0, 0};
  // What the subtree adds is taken back if a brick replaces it.
  const std::size_t blocks = blocks_.size(), bricks = bricks_.size(), voxels = voxels_.size();
  Block children;
  MeanOfVoxels mean;
  std::uint64_t bytes = sizeof(Block);
  for (int child = 0; child < 8; ++child) {
    const Subtree below = Compile(runs, cube.Child(child));
    children[static_cast<std::size_t>(child)] = below.node;
    mean.Add(below.node.voxel, below.filled);
    bytes += below.bytes;
  }
  const VoxelBox inside = Intersection(cube.box(), runs.box());
  const std::uint64_t raw = inside.volume() * sizeof(Voxel) + sizeof(Brick);
  // A single brick for the whole model needs no table of bricks.
  if (bytes < raw && !(cube.level == level_ && bytes > inside.volume() * sizeof(Voxel))) {
    blocks_.push_back(children);
    return {{mean.Get(), static_cast<std::uint32_t>(blocks_.size() - 1)}, mean.filled(), bytes};
  }
  blocks_.resize(blocks);
  bricks_.resize(bricks);
  voxels_.resize(voxels);
  const std::uint32_t size_y = static_cast<std::uint32_t>(inside.high.y - inside.low.y),
                      size_z = static_cast<std::uint32_t>(inside.high.z - inside.low.z);
  bricks_.push_back({voxels, size_y, size_z});
  voxels_.resize(voxels + inside.volume());
  for (int x = inside.low.x; x < inside.high.x; ++x)
    for (int y = inside.low.y; y < inside.high.y; ++y) {
      Voxel* column =
          voxels_.data() + voxels +
          (static_cast<std::size_t>(x - inside.low.x) * size_y + static_cast<std::size_t>(y - inside.low.y)) *
              size_z;
      for (const VoxelRun& run : runs.Column(x, y)) {
        const int begin = std::max(run.z_begin, inside.low.z), end = std::min(run.z_end, inside.high.z);
        if (begin < end) std::fill(column + (begin - inside.low.z), column + (end - inside.low.z), run.voxel);
      }
    }
  return {{mean.Get(), static_cast<std::uint32_t>(bricks_.size() - 1) | AdaptiveNode::kBrick},
          mean.filled(),
          raw};
}

std::pair<AdaptiveNode, VoxelCube> AdaptiveOctreeModel::Find(VoxelPoint p) const {
  AdaptiveNode node = root_;
  VoxelCube cube{{0, 0, 0}, level_};
  while (!node.leaf() && !node.brick()) {
    const int child = ChildOf(p, cube.level);
    node = blocks_[node.index()][static_cast<std::size_t>(child)];
    cube = cube.Child(child);
  }
  return {node, cube};
}

Voxel AdaptiveOctreeModel::Get(int x, int y, int z) const {
  if (!box().Holds({x, y, z})) return {};
  const auto [node, cube] = Find({x, y, z});
  return node.brick() ? InBrick(node, cube.low, {x, y, z}) : node.voxel;
}

void AdaptiveOctreeModel::VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const {
  if (x < 0 || y < 0 || x >= size().x || y >= size().y) return;
  VisitLeaves(
      size().z,
      [&](int z) {
        const auto [node, cube] = Find({x, y, z});
        return node.brick() ? std::pair(InBrick(node, cube.low, {x, y, z}), z + 1)
                            : std::pair(node.voxel, cube.box().high.z);
      },
      visit);
}

std::uint64_t AdaptiveOctreeModel::bytes() const {
  return blocks_.capacity() * sizeof(Block) + bricks_.capacity() * sizeof(Brick) +
         voxels_.capacity() * sizeof(Voxel);
}

std::uint64_t AdaptiveOctreeModel::encoded_bytes() const {
  // A model that is a single brick needs no table of bricks.
  const std::uint64_t table = root_.brick() ? 0 : (bricks_.size() - 1) * sizeof(Brick);
  return (blocks_.size() - 1) * sizeof(Block) + table + voxels_.size() * sizeof(Voxel);
}

}  // namespace facetless
