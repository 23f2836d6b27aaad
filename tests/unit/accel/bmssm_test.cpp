// BMSSM: R_i & S_j is exactly the set of boxes that contain the sample, and bits are ordered front to back.
#include "render/accel/bmssm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

namespace facetless {
namespace {

// Returns random boxes of all three kinds in turn.
LeafLists RandomBoxes(int count, int columns, int rows) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> column(0, columns - 1), row(0, rows - 1), size(1, 40);
  std::uniform_real_distribution<double> depth(0, 1);
  LeafLists leaves;
  for (int i = 0; i < count; ++i) {
    LeafHeader header;
    const int col_begin = column(random), row_begin = row(random);
    header.box = SampleBox::HalfOpen(col_begin, std::min(columns, col_begin + size(random)), row_begin,
                                     std::min(rows, row_begin + size(random)));
    header.near_depth = depth(random);
    header.placed_face = static_cast<std::uint32_t>(i);
    if (i % 3 == 0) {
      leaves.certified.emplace_back();
      static_cast<LeafHeader&>(leaves.certified.back()) = header;
      leaves.places.push_back({0, static_cast<std::uint32_t>(i), 0, 0});
    } else if (i % 3 == 1) {
      leaves.hard.emplace_back();
      static_cast<LeafHeader&>(leaves.hard.back()) = header;
    } else {
      leaves.seams.emplace_back();
      static_cast<LeafHeader&>(leaves.seams.back()) = header;
    }
  }
  return leaves;
}

// Returns the names of all leaves.
std::vector<std::uint32_t> NamesOf(const LeafSpans& leaves) {
  std::vector<std::uint32_t> names;
  const auto add = [&](LeafKind kind, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) names.push_back(LeafId(kind, i));
  };
  add(LeafKind::kCertified, leaves.certified.size());
  add(LeafKind::kHard, leaves.hard.size());
  add(LeafKind::kSeam, leaves.seams.size());
  return names;
}

TEST(Bmssm, RowAndColumnBitsMeetExactlyInTheBoxesThatHoldTheSample) {
  const int columns = 131, rows = 77;  // not multiples of the tile size
  const LeafLists leaves = RandomBoxes(400, columns, rows);
  const TileLeaves tiles({leaves.spans()}, columns, rows);
  ASSERT_EQ(tiles.leaves().size(), 400u);
  TileBitmaps bitmaps;
  for (int tile = 0; tile < tiles.tiles_x() * tiles.tiles_y(); ++tile) {
    const int column = tile % tiles.tiles_x() * kTileSize, row = tile / tiles.tiles_x() * kTileSize;
    bitmaps.Build(tiles, tile);
    const auto list = tiles.Tile(tile);
    for (int i = 0; i < kTileSize && row + i < rows; ++i) {
      for (int j = 0; j < kTileSize && column + j < columns; ++j) {
        std::size_t next = 0;
        for (std::size_t k = 0; k < list.size(); ++k) {
          const bool bit =
              bitmaps.Row(i)[k / 64] & bitmaps.Column(j)[k / 64] & (std::uint64_t{1} << (k % 64));
          const bool holds = tiles.leaves().Header(list[k].leaf).box.Holds(column + j, row + i);
          ASSERT_EQ(bit, holds);
          next += holds;
        }
        // Every leaf that contains the sample must be in the tile's list.
        std::size_t all = 0;
        for (const std::uint32_t leaf : NamesOf(tiles.leaves()))
          all += tiles.leaves().Header(leaf).box.Holds(column + j, row + i);
        ASSERT_EQ(next, all);
      }
    }
  }
}

TEST(Bmssm, TheOrderDoesNotDependOnHowLeavesAreDealtOut) {
  // The number is large enough for several parallel shares, and some depths are equal.
  LeafLists leaves = RandomBoxes(20000, 256, 256);
  const auto coarsen = [](auto& some) {
    for (LeafHeader& leaf : some) leaf.near_depth = std::floor(100 * leaf.near_depth);
  };
  coarsen(leaves.certified);
  coarsen(leaves.hard);
  coarsen(leaves.seams);
  const LeafSpans all = leaves.spans();
  const LeafSpans front{all.certified.first(1000), all.places.first(1000), all.hard.first(5000), {}},
      back{all.certified.subspan(1000), all.places.subspan(1000), all.hard.subspan(5000), all.seams};
  const TileLeaves whole({all}, 256, 256), dealt({back, {}, front}, 256, 256);
  ASSERT_EQ(whole.leaves().size(), dealt.leaves().size());
  for (const std::uint32_t leaf : NamesOf(whole.leaves())) {
    ASSERT_EQ(whole.leaves().Header(leaf).placed_face, dealt.leaves().Header(leaf).placed_face);
    ASSERT_EQ(whole.leaves().Place(leaf).patch, dealt.leaves().Place(leaf).patch);
  }
  // A certified leaf keeps its place.
  for (std::size_t i = 0; i < whole.leaves().certified.size(); ++i)
    ASSERT_EQ(whole.leaves().places[i].patch, whole.leaves().certified[i].placed_face);
  for (int tile = 0; tile < whole.tiles_x() * whole.tiles_y(); ++tile)
    ASSERT_TRUE(std::ranges::equal(whole.Tile(tile), dealt.Tile(tile)));
}

TEST(Bmssm, BitsGoFrontToBack) {
  const LeafLists leaves = RandomBoxes(1000, 256, 256);
  const TileLeaves tiles({leaves.spans()}, 256, 256);
  for (int tile = 0; tile < tiles.tiles_x() * tiles.tiles_y(); ++tile) {
    const auto list = tiles.Tile(tile);
    for (std::size_t k = 1; k < list.size(); ++k) {
      EXPECT_TRUE(FrontToBack(tiles.leaves(), list[k - 1].leaf, list[k].leaf));
      EXPECT_LE(list[k - 1].near_depth, list[k].near_depth);
      EXPECT_EQ(tiles.leaves().Header(list[k].leaf).near_depth, list[k].near_depth);
    }
  }
}

}  // namespace
}  // namespace facetless
