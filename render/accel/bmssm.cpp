#include "render/accel/bmssm.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "render/base/parallel.h"

namespace facetless {
namespace {

// Fewer leaves than this are not worth another list of counts.
constexpr std::size_t kLeavesPerShare = 4096;
constexpr std::size_t kMostShares = 16;

// Sorted in place of its leaf, which is ten times the size.
struct Key {
  double near_depth;
  const Leaf* leaf;
};

bool FrontToBack(const Key& a, const Key& b) {
  if (a.near_depth != b.near_depth) return a.near_depth < b.near_depth;
  const auto rest = [](const Leaf& leaf) {
    return std::tie(leaf.placed_face, leaf.patch, leaf.u_mid, leaf.v_mid, leaf.u_half, leaf.v_half);
  };
  return rest(*a.leaf) < rest(*b.leaf);
}

}  // namespace

TileLeaves::TileLeaves(const std::vector<std::span<const Leaf>>& parts, int columns, int rows)
    : tiles_x_((columns + kTileSize - 1) / kTileSize), tiles_y_((rows + kTileSize - 1) / kTileSize) {
  std::vector<Key> keys;
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  keys.reserve(count);
  for (const auto& part : parts)
    for (const Leaf& leaf : part) keys.push_back({leaf.near_depth, &leaf});
  ParallelSort(keys.begin(), keys.end(), FrontToBack);

  // Gather and count share by share, then fill: leaves come in order, so each tile's list is sorted.
  const std::size_t shares = std::clamp<std::size_t>(count / kLeavesPerShare, 1, kMostShares);
  const auto first_of = [&](std::size_t share) { return count * share / shares; };
  const auto for_each_tile = [this](const Leaf& leaf, auto&& visit) {
    for (int y = leaf.row_begin / kTileSize; y <= (leaf.row_end - 1) / kTileSize; ++y) {
      for (int x = leaf.col_begin / kTileSize; x <= (leaf.col_end - 1) / kTileSize; ++x)
        visit(y * tiles_x_ + x);
    }
  };
  leaves_.resize(count);
  const std::size_t tiles = std::size_t(tiles_x_) * tiles_y_;
  std::vector<std::vector<std::size_t>> next(shares);
  ParallelFor(std::size_t{0}, shares, [&](std::size_t share) {
    next[share].assign(tiles, 0);
    for (std::size_t i = first_of(share); i < first_of(share + 1); ++i) {
      leaves_[i] = *keys[i].leaf;
      for_each_tile(leaves_[i], [&](int tile) { ++next[share][tile]; });
    }
  });
  begin_.resize(tiles + 1);
  std::size_t listed = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    begin_[tile] = listed;
    for (auto& counts : next) listed += std::exchange(counts[tile], listed);
  }
  begin_[tiles] = listed;
  indices_.resize(listed);
  ParallelFor(std::size_t{0}, shares, [&](std::size_t share) {
    for (std::size_t i = first_of(share); i < first_of(share + 1); ++i)
      for_each_tile(leaves_[i],
                    [&](int tile) { indices_[next[share][tile]++] = static_cast<std::uint32_t>(i); });
  });
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
