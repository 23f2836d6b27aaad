// BMSSM (V. Skala, "Memory saving technique for space subdivision technique"): for each sample row and each
// sample column a bitmap with a bit per leaf. The leaves whose screen box holds the sample (row i, column j)
// are exactly the bits of R_i & S_j.
//
//  1. Bits are numbered per screen tile: a tile lists the leaves whose boxes meet it, and its bitmaps have
//     one bit per listed leaf.
//  2. A tile's list is sorted by (near depth, placed face, patch, u, v): walking set bits upwards goes front
//     to back, and the walk ends at the first leaf that begins behind the hit. The order is total, so it does
//     not depend on threads.
//  3. An object without a bit in some row (the paper's V) or column (W) is met by no ray. Leaves are only
//     kept when their box holds a sample centre, so a placed face without leaves is one that no ray can see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/large_pages.h"
#include "render/nurbs/leaf.h"

namespace facetless {

inline constexpr int kTileSize = 32;  // samples along each side

// The leaves of all tiles of one view, front to back within each tile.
class TileLeaves {
 public:
  // Sorts the leaves of all parts and lists them per tile; in parallel, and the result depends neither on the
  // thread count nor on how the leaves are dealt out to the parts.
  TileLeaves(const std::vector<std::span<const Leaf>>& parts, int columns, int rows);

  int tiles_x() const { return tiles_x_; }
  int tiles_y() const { return tiles_y_; }
  std::span<const Leaf> leaves() const { return leaves_; }
  // Indices into leaves(), ascending.
  std::span<const std::uint32_t> Tile(int tile) const {
    return {indices_.data() + begin_[tile], begin_[tile + 1] - begin_[tile]};
  }
  std::uint64_t bits() const { return indices_.size() * 2 * kTileSize; }  // of all bitmaps together
  std::size_t bytes() const;

 private:
  int tiles_x_, tiles_y_;
  std::vector<Leaf, LargePages<Leaf>> leaves_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> indices_;
};

// The row and column bitmaps of one tile. Reused from tile to tile: storage only grows.
class TileBitmaps {
 public:
  // For the tile whose first sample is (column, row).
  void Build(const TileLeaves& tiles, int tile, int column, int row);

  int words() const { return words_; }
  const std::uint64_t* Row(int i) const { return bits_.data() + std::size_t(i) * words_; }  // R
  const std::uint64_t* Column(int j) const {
    return bits_.data() + std::size_t(kTileSize + j) * words_;
  }  // S
  std::size_t bytes() const { return bits_.capacity() * sizeof(std::uint64_t); }

 private:
  int words_ = 0;
  std::vector<std::uint64_t> bits_;
};

}  // namespace facetless
