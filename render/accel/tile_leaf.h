// A leaf in the list of a tile: what a walk through the list needs to know of the leaf before it is tested. Most leaves
// of a list are hidden by nearer ones, so their own data, which lie anywhere in memory, are never read.
#pragma once

#include <algorithm>
#include <cstdint>

#include "render/nurbs/leaf.h"

namespace facetless {

inline constexpr int kTileSize = 32;  // samples along each side of a tile

struct TileLeaf {
  double near_depth;   // the leaf's
  std::uint32_t leaf;  // its LeafId
  // The part of its box within the tile, in rows and columns of the tile.
  std::uint8_t first_column, last_column, first_row, last_row;

  // Requires a box that meets the tile whose first sample is (column, row).
  static TileLeaf Of(double near_depth, const SampleBox& box, std::uint32_t leaf, int column, int row) {
    const auto within = [](int sample, int first) {
      return static_cast<std::uint8_t>(std::clamp(sample - first, 0, kTileSize - 1));
    };
    return {near_depth,
            leaf,
            within(box.first_col, column),
            within(box.last_col, column),
            within(box.first_row, row),
            within(box.last_row, row)};
  }
  friend bool operator==(const TileLeaf&, const TileLeaf&) = default;
};
static_assert(sizeof(TileLeaf) == 16);

}  // namespace facetless
