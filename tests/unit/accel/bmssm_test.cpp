// BMSSM: R_i & S_j is exactly the set of boxes that hold the sample, and bits are ordered front to back.
#include "render/accel/bmssm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

namespace facetless {
namespace {

std::vector<Leaf> RandomBoxes(int count, int columns, int rows) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> column(0, columns - 1), row(0, rows - 1), size(1, 40);
  std::uniform_real_distribution<double> depth(0, 1);
  std::vector<Leaf> leaves(count);
  for (int i = 0; i < count; ++i) {
    Leaf& leaf = leaves[i];
    leaf.col_begin = column(random);
    leaf.col_end = std::min(columns, leaf.col_begin + size(random));
    leaf.row_begin = row(random);
    leaf.row_end = std::min(rows, leaf.row_begin + size(random));
    leaf.near_depth = depth(random);
    leaf.placed_face = static_cast<std::uint32_t>(i);
  }
  return leaves;
}

TEST(Bmssm, RowAndColumnBitsMeetExactlyInTheBoxesThatHoldTheSample) {
  const int columns = 131, rows = 77;  // no multiples of a tile
  const std::vector<Leaf> leaves = RandomBoxes(400, columns, rows);
  const TileLeaves tiles({leaves}, columns, rows);
  TileBitmaps bitmaps;
  for (int tile = 0; tile < tiles.tiles_x() * tiles.tiles_y(); ++tile) {
    const int column = tile % tiles.tiles_x() * kTileSize, row = tile / tiles.tiles_x() * kTileSize;
    bitmaps.Build(tiles, tile, column, row);
    const auto list = tiles.Tile(tile);
    for (int i = 0; i < kTileSize && row + i < rows; ++i) {
      for (int j = 0; j < kTileSize && column + j < columns; ++j) {
        std::size_t next = 0;
        for (std::size_t k = 0; k < list.size(); ++k) {
          const bool bit =
              bitmaps.Row(i)[k / 64] & bitmaps.Column(j)[k / 64] & (std::uint64_t{1} << (k % 64));
          const Leaf& leaf = tiles.leaves()[list[k]];
          const bool holds = leaf.row_begin <= row + i && row + i < leaf.row_end &&
                             leaf.col_begin <= column + j && column + j < leaf.col_end;
          ASSERT_EQ(bit, holds);
          next += holds;
        }
        // No leaf that holds the sample is missing from the tile's list.
        std::size_t all = 0;
        for (const Leaf& leaf : tiles.leaves()) {
          all += leaf.row_begin <= row + i && row + i < leaf.row_end && leaf.col_begin <= column + j &&
                 column + j < leaf.col_end;
        }
        ASSERT_EQ(next, all);
      }
    }
  }
}

TEST(Bmssm, TheOrderDoesNotDependOnHowLeavesAreDealtOut) {
  // Enough for several shares, and depths that repeat.
  std::vector<Leaf> leaves = RandomBoxes(20000, 256, 256);
  for (Leaf& leaf : leaves) leaf.near_depth = std::floor(100 * leaf.near_depth);
  const std::span<const Leaf> all(leaves);
  const TileLeaves whole({all}, 256, 256), dealt({all.subspan(7000), {}, all.first(7000)}, 256, 256);
  ASSERT_EQ(whole.leaves().size(), dealt.leaves().size());
  for (std::size_t i = 0; i < whole.leaves().size(); ++i)
    ASSERT_EQ(whole.leaves()[i].placed_face, dealt.leaves()[i].placed_face);
  for (int tile = 0; tile < whole.tiles_x() * whole.tiles_y(); ++tile)
    ASSERT_TRUE(std::ranges::equal(whole.Tile(tile), dealt.Tile(tile)));
}

TEST(Bmssm, BitsGoFrontToBack) {
  const std::vector<Leaf> leaves = RandomBoxes(1000, 256, 256);
  const TileLeaves tiles({leaves}, 256, 256);
  for (int tile = 0; tile < tiles.tiles_x() * tiles.tiles_y(); ++tile) {
    const auto list = tiles.Tile(tile);
    for (std::size_t k = 1; k < list.size(); ++k) {
      EXPECT_LT(list[k - 1], list[k]);
      EXPECT_LE(tiles.leaves()[list[k - 1]].near_depth, tiles.leaves()[list[k]].near_depth);
    }
  }
}

}  // namespace
}  // namespace facetless
