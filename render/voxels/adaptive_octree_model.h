// The encoding "adaptive-octree": an octree in which a raw brick replaces a subtree exactly when the brick is no larger;
// P. Procházka, "Optimalizace vykreslování voxelové grafiky" (2013), section 5.
//
//  1. A node is a leaf, has eight children, or is a brick: the voxels of its cube inside the model, column after column.
//     A brick replaces a subtree below the root if and only if it takes no more bytes than the blocks and bricks of the
//     subtree. A single brick replaces the whole tree if and only if the voxels of the model take fewer bytes than it.
//  2. Theorem: the model takes no more bytes than the raw one, except for the 8 bytes of the root. This follows from the
//     rule of law 1 for the whole tree. encoded_bytes() counts the bytes of the theorem; bytes() is the memory, which grows
//     in steps.
//  3. Inner nodes and bricks have the mean of the filled voxels of their whole cubes. GetMean does not use these means; it
//     computes each mean from the voxels.
#pragma once

#include <array>
#include <vector>

#include "render/voxels/encodings.h"
#include "render/voxels/rebuilt_model.h"

namespace facetless {

// A node of an octree whose subtrees may be bricks.
struct AdaptiveNode {
  Voxel voxel;  // of a leaf; else the mean
  std::uint32_t content =
      0;  // 0: a leaf; else the kind in the highest bit, and the index of a block or a brick
  static constexpr std::uint32_t kBrick = 0x80000000u;
  bool leaf() const { return content == 0; }
  bool brick() const { return (content & kBrick) != 0; }
  std::uint32_t index() const { return content & ~kBrick; }
  bool operator==(const AdaptiveNode&) const = default;
};

class AdaptiveOctreeModel final : public RebuiltModel {
 public:
  explicit AdaptiveOctreeModel(VoxelPoint size);
  explicit AdaptiveOctreeModel(const RunModel& runs);

  std::string_view encoding() const override { return "adaptive-octree"; }
  Voxel Get(int x, int y, int z) const override;
  void VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const override;
  std::uint64_t bytes() const override;
  std::uint64_t encoded_bytes() const;  // the bytes of law 2, without the root
  std::uint64_t brick_count() const { return bricks_.size() - 1; }

  int level() const { return level_; }
  const AdaptiveNode& root() const { return root_; }
  const AdaptiveNode* Children(const AdaptiveNode& node) const { return blocks_[node.index()].data(); }
  // A voxel of the model in a brick, whose cube has its lowest corner at `low`.
  Voxel InBrick(const AdaptiveNode& node, VoxelPoint low, VoxelPoint p) const {
    const Brick& brick = bricks_[node.index()];
    return voxels_[brick.first +
                   (static_cast<std::size_t>(p.x - low.x) * brick.y + static_cast<std::size_t>(p.y - low.y)) *
                       brick.z +
                   static_cast<std::size_t>(p.z - low.z)];
  }

 private:
  using Block = std::array<AdaptiveNode, 8>;
  struct Brick {
    std::size_t first = 0;       // into voxels_
    std::uint32_t y = 0, z = 0;  // its size along these axes: the cube, clipped to the model
  };
  struct Subtree {
    AdaptiveNode node;
    std::uint64_t filled = 0, bytes = 0;
  };
  void Compile(const RunModel& runs) override;
  Subtree Compile(const RunModel& runs, const VoxelCube& cube);
  std::pair<AdaptiveNode, VoxelCube> Find(VoxelPoint p) const;

  int level_;
  AdaptiveNode root_;
  std::vector<Block> blocks_;  // the first block and the first brick are not used
  std::vector<Brick> bricks_;
  std::vector<Voxel> voxels_;  // of all bricks
};

}  // namespace facetless
