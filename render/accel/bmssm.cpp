#include "render/accel/bmssm.h"

#include <algorithm>
#include <tuple>

#include "render/trace/parallel.h"

namespace facetless {
namespace {

bool FrontToBack(const Leaf& a, const Leaf& b) {
  return std::tie(a.near_depth, a.placed_face, a.patch, a.u_mid, a.v_mid, a.u_half, a.v_half) <
         std::tie(b.near_depth, b.placed_face, b.patch, b.u_mid, b.v_mid, b.u_half, b.v_half);
}

}  // namespace

TileLeaves::TileLeaves(std::vector<Leaf> leaves, int columns, int rows)
    : tiles_x_((columns + kTileSize - 1) / kTileSize),
      tiles_y_((rows + kTileSize - 1) / kTileSize),
      leaves_(std::move(leaves)) {
  ParallelSort(leaves_.begin(), leaves_.end(), FrontToBack);

  // Count, then fill: leaves come in order, so each tile's list is sorted.
  const auto for_each_tile = [this](const Leaf& leaf, auto&& visit) {
    for (int y = leaf.row_begin / kTileSize; y <= (leaf.row_end - 1) / kTileSize; ++y) {
      for (int x = leaf.col_begin / kTileSize; x <= (leaf.col_end - 1) / kTileSize; ++x)
        visit(y * tiles_x_ + x);
    }
  };
  begin_.assign(std::size_t(tiles_x_) * tiles_y_ + 1, 0);
  for (const Leaf& leaf : leaves_) for_each_tile(leaf, [this](int tile) { ++begin_[tile + 1]; });
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  indices_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t i = 0; i < leaves_.size(); ++i)
    for_each_tile(leaves_[i], [&](int tile) { indices_[next[tile]++] = i; });
}

std::size_t TileLeaves::bytes() const {
  return leaves_.capacity() * sizeof(Leaf) + begin_.capacity() * sizeof(std::size_t) +
         indices_.capacity() * sizeof(std::uint32_t);
}

void TileBitmaps::Build(const TileLeaves& tiles, int tile, int column, int row) {
  const auto list = tiles.Tile(tile);
  words_ = static_cast<int>((list.size() + 63) / 64);
  bits_.assign(std::size_t(2 * kTileSize) * words_, 0);
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Leaf& leaf = tiles.leaves()[list[k]];
    const std::uint64_t bit = std::uint64_t{1} << (k % 64);
    std::uint64_t* word = bits_.data() + k / 64;
    const int row_end = std::min(leaf.row_end - row, kTileSize),
              col_end = std::min(leaf.col_end - column, kTileSize);
    for (int i = std::max(leaf.row_begin - row, 0); i < row_end; ++i) word[std::size_t(i) * words_] |= bit;
    for (int j = std::max(leaf.col_begin - column, 0); j < col_end; ++j)
      word[std::size_t(kTileSize + j) * words_] |= bit;
  }
}

}  // namespace facetless
