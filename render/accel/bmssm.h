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

// The order of tiles' lists (Law 2), of leaves `a` and `b` of a view.
bool FrontToBack(const LeafSpans& leaves, std::uint32_t a, std::uint32_t b);

// The leaves of all tiles of one view, front to back within each tile.
class TileLeaves {
 public:
  // Sorts the leaves of all parts and lists them per tile; in parallel, and the result depends neither on the
  // thread count nor on how the leaves are dealt out to the parts.
  TileLeaves(const std::vector<LeafSpans>& parts, int columns, int rows);

  int tiles_x() const { return tiles_x_; }
  int tiles_y() const { return tiles_y_; }
  // Those of each kind front to back.
  LeafSpans leaves() const { return {certified_, places_, hard_, seams_}; }
  // The leaves whose boxes meet the tile, front to back.
  std::span<const std::uint32_t> Tile(int tile) const {
    return {indices_.data() + begin_[tile], begin_[tile + 1] - begin_[tile]};
  }
  std::uint64_t bits() const { return indices_.size() * 2 * kTileSize; }  // of all bitmaps together
  std::size_t bytes() const;
  std::size_t leaf_bytes() const;  // those of the leaves alone

 private:
  // Copies a leaf of `part` to index `to` of its kind, and returns its name there.
  std::uint32_t Gather(const LeafSpans& part, std::uint32_t leaf, std::size_t to);
  // Calls visit(tile) for the tiles that a leaf's box meets.
  template <typename Visit>
  void ForEachTile(std::uint32_t leaf, const Visit& visit) const;

  int tiles_x_, tiles_y_;
  template <typename T>
  using Array = std::vector<T, LargePages<T>>;
  Array<CertifiedLeaf> certified_;
  Array<LeafPlace> places_;  // of the certified ones
  Array<HardLeaf> hard_;
  Array<SeamLeaf> seams_;
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
