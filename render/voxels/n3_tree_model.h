// The encoding "n3-tree": a tree whose inner nodes have N³ children, and whose lowest nodes are bricks of M³ voxels with mip
// maps; C. Crassin et al., "GigaVoxels" (2009), as P. Procházka describes it (2013, section 4.4).
//
//  1. N and M are powers of two, chosen before the model is compiled: 2 ≤ N ≤ 8, 1 ≤ M ≤ 64. The root is a cube of M·Nᵏ
//     voxels on a side, with the least k whose cube holds the model. With N = 2 and M = 1 the tree is the octree, and its
//     lowest nodes need no bricks.
//  2. A node whose cube is empty, or is filled with equal voxels, is a leaf.
//  3. Inner nodes have the mean of their filled voxels. A brick has the means of its cubes of 2, 4, … M voxels on a side.
//     GetMean takes stored means, and counts the filled voxels for the share.
#pragma once

#include <vector>

#include "render/voxels/encodings.h"
#include "render/voxels/rebuilt_model.h"

namespace facetless {

struct N3Node {
  Voxel voxel;  // of a leaf; else the mean
  std::uint32_t content =
      0;  // 0: a leaf; else the index of its children, or of its brick at the lowest level, plus 1
  bool leaf() const { return content == 0; }
};

class N3TreeModel final : public RebuiltModel {
 public:
  static constexpr int kUsualN = 4, kUsualM = 8;

  // Requires N and M that keep law 1.
  explicit N3TreeModel(VoxelPoint size, int n = kUsualN, int m = kUsualM);
  explicit N3TreeModel(const RunModel& runs, int n = kUsualN, int m = kUsualM);

  std::string_view encoding() const override { return "n3-tree"; }
  Voxel Get(int x, int y, int z) const override;
  VoxelMean GetMean(int x, int y, int z, int level) const override;
  void VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const override;
  std::uint64_t bytes() const override;
  int n() const { return 1 << n_level_; }
  int m() const { return 1 << m_level_; }
  std::uint64_t brick_count() const { return voxels_.size() / BrickSize(); }
  std::uint64_t node_count() const { return nodes_.size() + 1; }

  // The root is a cube of 2^level() voxels on a side, a brick one of 2^brick_level(), and a child is 2^digit_level() times
  // smaller than its parent.
  int level() const { return level_; }
  int brick_level() const { return m_level_; }
  int digit_level() const { return n_level_; }
  const N3Node& root() const { return root_; }
  // The N³ children of an inner node above the bricks; x is fastest.
  const N3Node* Children(const N3Node& node) const { return nodes_.data() + (node.content - 1); }
  // The mean of the cube of 2^level voxels on a side that holds a voxel of a brick; 0 ≤ level ≤ brick_level().
  Voxel InBrick(const N3Node& node, VoxelPoint p, int level) const;

 private:
  struct Subtree {
    N3Node node;
    std::uint64_t filled = 0;
  };
  // The voxels of a brick, and those of its mip maps: M³ + (M/2)³ + … + 1.
  std::size_t BrickSize() const { return brick_size_; }
  // Where the mip map of cubes of 2^level voxels begins in a brick.
  std::size_t MipBegin(int level) const;
  void Compile(const RunModel& runs) override;
  Subtree Compile(const RunModel& runs, const VoxelCube& cube);
  Subtree CompileBrick(const RunModel& runs, const VoxelCube& cube);
  struct Found {
    N3Node node;
    int level;  // of its cube
  };
  Found Find(VoxelPoint p, int level) const;

  int n_level_, m_level_, level_;  // logarithms of N, of M, and of the root's edge
  std::size_t brick_size_;
  N3Node root_;
  std::vector<N3Node> nodes_;  // children, N³ at a time; x fastest
  std::vector<Voxel> voxels_;  // of all bricks
};

}  // namespace facetless
