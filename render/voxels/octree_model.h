// The encoding "octree": a tree over the smallest cube of 2^h voxels on a side that holds the model. A node is empty, is
// filled with equal voxels, or has eight children; P. Procházka, "Optimalizace vykreslování voxelové grafiky" (2013),
// section 4.3.
//
//  1. The tree is optimal: a node whose children are all filled with the same voxel, or all empty, is a leaf. Each edit
//     restores that on its way back to the root.
//  2. An inner node has the mean of its filled voxels, and counts them.
//  3. A node takes 8 bytes. An inner node has the index of a block, which holds its eight children one after the other.
//     Child number x + 2y + 4z has the upper half along each axis whose digit is 1.
#pragma once

#include <array>
#include <vector>

#include "render/base/large_pages.h"
#include "render/voxels/encodings.h"
#include "render/voxels/run_model.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

// The largest level of a root: 2^16 voxels on a side.
inline constexpr int kMostOctreeLevels = 16;

struct OctreeNode {
  Voxel voxel;                 // of a leaf; the mean of an inner node
  std::uint32_t children = 0;  // of an inner node: the index of its block, which is never 0; 0: a leaf
  bool leaf() const { return children == 0; }
  bool operator==(const OctreeNode&) const = default;
};

class OctreeModel final : public VoxelModel {
 public:
  explicit OctreeModel(VoxelPoint size);
  // Compiles a model from the root down to its voxels: only the path to the present node is kept besides the result.
  explicit OctreeModel(const RunModel& runs);
  // Compiles a model from its voxels up: all nodes of a level are made before those of the next level, so that both ways of
  // compiling can be compared. It needs memory for a node of each filled voxel. The result is the same tree.
  static OctreeModel BottomUp(const RunModel& runs);

  std::string_view encoding() const override { return "octree"; }
  Voxel Get(int x, int y, int z) const override;
  VoxelMean GetMean(int x, int y, int z, int level) const override;
  void VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const override;
  void Fill(const VoxelBox& box, Voxel voxel) override;
  void SetColumn(int x, int y, std::span<const VoxelRun> runs) override;
  std::uint64_t Count() const override { return FilledOf(root_, level_); }
  std::uint64_t bytes() const override;

  int level() const { return level_; }  // h: the root is a cube of 2^h voxels on a side
  const OctreeNode& root() const { return root_; }
  // The eight children of an inner node.
  const OctreeNode* Children(const OctreeNode& node) const { return blocks_[node.children].data(); }

  struct Figures {
    std::uint64_t nodes = 0, leaves = 0, filled_leaves = 0;  // leaves include empty ones
  };
  Figures CountNodes() const;
  // Whether both trees have the same nodes, whatever the order of their blocks.
  bool SameTree(const OctreeModel& other) const;

 private:
  using Block = std::array<OctreeNode, 8>;

  std::uint64_t FilledOf(const OctreeNode& node, int level) const {
    if (!node.leaf()) return filled_[node.children];
    return node.voxel.filled() ? std::uint64_t{1} << (3 * level) : 0;
  }
  // Makes the node of eight children of the level below `level`.
  OctreeNode Join(const Block& children, int level);
  std::uint32_t NewBlock();
  void Release(const OctreeNode& node);
  OctreeNode Compile(const RunModel& runs, const VoxelCube& cube);
  void Fill(OctreeNode& node, const VoxelCube& cube, const VoxelBox& region, Voxel voxel);

  int level_;
  OctreeNode root_;
  std::vector<Block, LargePages<Block>> blocks_;  // block 0 is not used
  std::vector<std::uint64_t> filled_;             // filled voxels below each block
  std::vector<std::uint32_t> free_;               // blocks that edits gave back
};

}  // namespace facetless
