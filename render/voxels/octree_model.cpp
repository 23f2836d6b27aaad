#include "render/voxels/octree_model.h"

#include <algorithm>
#include <unordered_map>

namespace facetless {

OctreeModel::OctreeModel(VoxelPoint size) : VoxelModel(size), level_(LevelOf(size)), blocks_(1), filled_(1) {}

OctreeModel::OctreeModel(const RunModel& runs) : OctreeModel(runs.size()) {
  root_ = Compile(runs, {{0, 0, 0}, level_});
}

std::uint32_t OctreeModel::NewBlock() {
  if (!free_.empty()) {
    const std::uint32_t block = free_.back();
    free_.pop_back();
    return block;
  }
  blocks_.emplace_back();
  filled_.push_back(0);
  return static_cast<std::uint32_t>(blocks_.size() - 1);
}

void OctreeModel::Release(const OctreeNode& node) {
  if (node.leaf()) return;
  for (int child = 0; child < 8; ++child) Release(blocks_[node.children][static_cast<std::size_t>(child)]);
  free_.push_back(node.children);
}

OctreeNode OctreeModel::Join(const Block& children, int level) {
  // The test of optimality.
  if (children[0].leaf() && std::all_of(children.begin(), children.end(),
                                        [&](const OctreeNode& child) { return child == children[0]; }))
    return children[0];
  MeanOfVoxels mean;
  for (const OctreeNode& child : children) mean.Add(child.voxel, FilledOf(child, level - 1));
  const std::uint32_t block = NewBlock();
  blocks_[block] = children;
  filled_[block] = mean.filled();
  return {mean.Get(), block};
}

OctreeNode OctreeModel::Compile(const RunModel& runs, const VoxelCube& cube) {
  if (const std::optional<Voxel> uniform = runs.Uniform(cube.box())) return {*uniform, 0};
  Block children;
  for (int child = 0; child < 8; ++child)
    children[static_cast<std::size_t>(child)] = Compile(runs, cube.Child(child));
  return Join(children, cube.level);
}

OctreeModel OctreeModel::BottomUp(const RunModel& runs) {
  OctreeModel tree(runs.size());
  // The nodes of a level that are not empty, by their place among the cubes of that level.
  using Level = std::unordered_map<std::uint64_t, OctreeNode>;
  const auto key = [](std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x << 42 | y << 21 | z; };
  Level nodes;
  for (int x = 0; x < runs.size().x; ++x)
    for (int y = 0; y < runs.size().y; ++y)
      for (const VoxelRun& run : runs.Column(x, y))
        for (int z = run.z_begin; z < run.z_end; ++z)
          nodes[key(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y),
                    static_cast<std::uint64_t>(z))] = {run.voxel, 0};
  for (int level = 1; level <= tree.level_; ++level) {
    std::unordered_map<std::uint64_t, Block> joined;
    for (const auto& [place, node] : nodes) {
      constexpr std::uint64_t kDigits = (std::uint64_t{1} << 21) - 1;
      const std::uint64_t x = place >> 42, y = place >> 21 & kDigits, z = place & kDigits;
      joined[key(x / 2, y / 2, z / 2)][(x & 1) | (y & 1) << 1 | (z & 1) << 2] = node;
    }
    nodes.clear();
    for (const auto& [place, children] : joined) nodes[place] = tree.Join(children, level);
  }
  if (!nodes.empty()) tree.root_ = nodes.begin()->second;
  return tree;
}

Voxel OctreeModel::Get(int x, int y, int z) const {
  if (!box().Holds({x, y, z})) return {};
  OctreeNode node = root_;
  for (int level = level_; !node.leaf(); --level)
    node = blocks_[node.children][static_cast<std::size_t>(ChildOf({x, y, z}, level))];
  return node.voxel;
}

VoxelMean OctreeModel::GetMean(int x, int y, int z, int level) const {
  if (!box().Holds({x, y, z})) return {};
  OctreeNode node = root_;
  int at = level_;
  for (; !node.leaf() && at > level; --at)
    node = blocks_[node.children][static_cast<std::size_t>(ChildOf({x, y, z}, at))];
  const std::uint64_t filled = FilledOf(node, std::min(at, level));
  return {node.voxel, static_cast<double>(filled) / static_cast<double>(std::uint64_t{1} << (3 * level))};
}

void OctreeModel::VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const {
  if (x < 0 || y < 0 || x >= size().x || y >= size().y) return;
  VoxelRun run;
  for (int z = 0; z < size().z;) {
    OctreeNode node = root_;
    int level = level_;
    for (; !node.leaf(); --level)
      node = blocks_[node.children][static_cast<std::size_t>(ChildOf({x, y, z}, level))];
    const int end = std::min(((z >> level) + 1) << level, size().z);
    if (run.voxel.filled() && run.voxel == node.voxel) {
      run.z_end = end;
    } else {
      if (run.voxel.filled()) visit(run);
      run = {z, end, node.voxel};
    }
    z = end;
  }
  if (run.voxel.filled()) visit(run);
}

void OctreeModel::Fill(OctreeNode& node, const VoxelCube& cube, const VoxelBox& region, Voxel voxel) {
  const VoxelBox inside = Intersection(region, cube.box());
  if (inside.empty() || (node.leaf() && node.voxel == voxel)) return;
  if (inside.volume() == cube.volume()) {
    Release(node);
    node = {voxel, 0};
    return;
  }
  Block children;
  if (node.leaf()) {
    children.fill(node);
  } else {
    children = blocks_[node.children];
    free_.push_back(node.children);
  }
  for (int child = 0; child < 8; ++child)
    Fill(children[static_cast<std::size_t>(child)], cube.Child(child), region, voxel);
  node = Join(children, cube.level);
}

void OctreeModel::Fill(const VoxelBox& region, Voxel voxel) {
  Fill(root_, {{0, 0, 0}, level_}, Intersection(region, box()), voxel);
}

void OctreeModel::SetColumn(int x, int y, std::span<const VoxelRun> runs) {
  int z = 0;
  for (const VoxelRun& run : runs) {
    Fill({{x, y, z}, {x + 1, y + 1, run.z_begin}}, {});
    Fill({{x, y, run.z_begin}, {x + 1, y + 1, run.z_end}}, run.voxel);
    z = run.z_end;
  }
  Fill({{x, y, z}, {x + 1, y + 1, size().z}}, {});
}

std::uint64_t OctreeModel::bytes() const {
  return blocks_.capacity() * sizeof(Block) + filled_.capacity() * sizeof(std::uint64_t) +
         free_.capacity() * sizeof(std::uint32_t);
}

OctreeModel::Figures OctreeModel::CountNodes() const {
  Figures figures;
  const auto count = [&](const OctreeNode& node) {
    ++figures.nodes;
    figures.leaves += node.leaf();
    figures.filled_leaves += node.leaf() && node.voxel.filled();
  };
  count(root_);
  std::vector<OctreeNode> waiting{root_};
  while (!waiting.empty()) {
    const OctreeNode node = waiting.back();
    waiting.pop_back();
    if (node.leaf()) continue;
    for (const OctreeNode& child : blocks_[node.children]) {
      count(child);
      if (!child.leaf()) waiting.push_back(child);
    }
  }
  return figures;
}

bool OctreeModel::SameTree(const OctreeModel& other) const {
  std::vector<std::pair<OctreeNode, OctreeNode>> waiting{{root_, other.root_}};
  while (!waiting.empty()) {
    const auto [a, b] = waiting.back();
    waiting.pop_back();
    if (!(a.voxel == b.voxel) || a.leaf() != b.leaf()) return false;
    if (a.leaf()) continue;
    for (std::size_t child = 0; child < 8; ++child)
      waiting.emplace_back(blocks_[a.children][child], other.blocks_[b.children][child]);
  }
  return true;
}

}  // namespace facetless
