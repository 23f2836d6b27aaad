// BMSSM (V. Skala, "Memory saving technique for space subdivision technique"). Each sample row i has a bitmap
// R_i and each sample column j a bitmap S_j, with one bit per leaf. The set bits of R_i & S_j are exactly the
// leaves whose screen box contains the sample (i, j).
//
//     const TileLeaves tiles({leaves}, columns, rows);
//     TileBitmaps bitmaps;
//     bitmaps.Build(tiles, tile);
//     for (int w = 0; w < bitmaps.words(); ++w)
//       Visit(tiles.Tile(tile), w, bitmaps.Row(i)[w] & bitmaps.Column(j)[w]);
//
//  1. Bits are numbered per screen tile. A tile lists the leaves whose boxes overlap it, and its bitmaps have
//     one bit per listed leaf.
//  2. The list of a tile is sorted by (near depth, placed face, patch, u, v). Visiting the set bits in
//     ascending order therefore visits the leaves from front to back, and the visit ends at the first leaf
//     that begins behind the hit. The order is total, so it does not depend on the number of threads.
//  3. No ray meets an object whose bit is clear in all rows (the paper's V) or in all columns (W). A leaf is
//     listed only if its box contains a sample centre, so a placed face without leaves is not visible.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/accel/tile_leaf.h"
#include "render/base/large_pages.h"
#include "render/nurbs/leaf.h"

namespace facetless {

// The order of tiles' lists (Law 2), of leaves `a` and `b` of a view.
bool FrontToBack(const LeafSpans& leaves, std::uint32_t a, std::uint32_t b);

// The leaves of all tiles of one view, front to back within each tile.
class TileLeaves {
 public:
  // Sorts the leaves of all parts and lists them per tile, in parallel. The result depends neither on the
  // number of threads nor on the distribution of the leaves over the parts.
  TileLeaves(const std::vector<LeafSpans>& parts, int columns, int rows);

  int tiles_x() const { return tiles_x_; }
  int tiles_y() const { return tiles_y_; }
  // Leaves that begin in the same tile lie side by side in memory, those of each kind front to back.
  LeafSpans leaves() const { return {certified_, places_, hard_, seams_}; }
  // The leaves whose boxes meet the tile, front to back.
  std::span<const TileLeaf> Tile(int tile) const {
    return {listed_.data() + begin_[tile], begin_[tile + 1] - begin_[tile]};
  }
  std::uint64_t bits() const { return listed_.size() * 2 * kTileSize; }  // total size of all bitmaps, in bits
  std::size_t bytes() const;
  std::size_t leaf_bytes() const;  // those of the leaves alone

 private:
  static constexpr std::size_t kLeafKinds = 3;
  // A leaf among those of its kind in a part.
  struct Source {
    std::uint32_t part, index;
  };
  // Copies the leaves of each kind.
  void Gather(const std::vector<LeafSpans>& parts,
              const std::array<std::vector<Source>, kLeafKinds>& sources);
  // The tile in which a leaf's box begins.
  int HomeOf(const SampleBox& box) const;
  // Calls visit(tile) for the tiles that a leaf's box meets.
  template <typename Visit>
  void ForEachTile(const SampleBox& box, const Visit& visit) const;

  int tiles_x_, tiles_y_;
  template <typename T>
  using Array = std::vector<T, LargePages<T>>;
  Array<CertifiedLeaf> certified_;
  Array<LeafPlace> places_;  // of the certified ones
  Array<HardLeaf> hard_;
  Array<SeamLeaf> seams_;
  std::vector<std::size_t> begin_;
  Array<TileLeaf> listed_;  // tile by tile
};

// The row and column bitmaps of one tile. An object is reused for many tiles; its storage only grows.
class TileBitmaps {
 public:
  void Build(const TileLeaves& tiles, int tile);

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
