#include "render/accel/bmssm.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "render/base/parallel.h"

namespace facetless {
namespace {

// The least number of leaves per share; for fewer leaves, a separate list of counts does not pay off.
constexpr std::size_t kLeavesPerShare = 4096;
constexpr std::size_t kMostShares = 16;

// A leaf while the leaves are sorted, which are ten times as large.
struct Key {
  double near_depth;
  std::uint32_t part, leaf;
  SampleBox box;
};

// The order of leaves that begin at the same depth. Leaves of one patch have one rectangle as their root: whichever
// it is, it puts them in the same order.
bool ComesFirst(const LeafSpans& leaves_a, std::uint32_t a, const LeafSpans& leaves_b, std::uint32_t b) {
  const std::uint32_t face_a = leaves_a.Header(a).placed_face, face_b = leaves_b.Header(b).placed_face;
  if (face_a != face_b) return face_a < face_b;
  const LeafPlace place_a = leaves_a.Place(a), place_b = leaves_b.Place(b);
  if (place_a.patch != place_b.patch) return place_a.patch < place_b.patch;
  const ParameterRect rect_a = RectOf(place_a, {}), rect_b = RectOf(place_b, {});
  return std::tie(rect_a.u_mid, rect_a.v_mid, rect_a.u_half, rect_a.v_half) <
         std::tie(rect_b.u_mid, rect_b.v_mid, rect_b.u_half, rect_b.v_half);
}

}  // namespace

bool FrontToBack(const LeafSpans& leaves, std::uint32_t a, std::uint32_t b) {
  const double near_a = leaves.Header(a).near_depth, near_b = leaves.Header(b).near_depth;
  return near_a != near_b ? near_a < near_b : ComesFirst(leaves, a, leaves, b);
}

TileLeaves::TileLeaves(const std::vector<LeafSpans>& parts, int columns, int rows)
    : tiles_x_((columns + kTileSize - 1) / kTileSize), tiles_y_((rows + kTileSize - 1) / kTileSize) {
  std::vector<Key> keys;
  std::size_t count = 0;
  for (const LeafSpans& part : parts) count += part.size();
  keys.reserve(count);
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const auto add = [&](LeafKind kind, const auto& leaves) {
      for (std::size_t i = 0; i < leaves.size(); ++i)
        keys.push_back({leaves[i].near_depth, p, LeafId(kind, i), leaves[i].box});
    };
    add(LeafKind::kCertified, parts[p].certified);
    add(LeafKind::kHard, parts[p].hard);
    add(LeafKind::kSeam, parts[p].seams);
  }
  ParallelSort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
    if (a.near_depth != b.near_depth) return a.near_depth < b.near_depth;
    return ComesFirst(parts[a.part], a.leaf, parts[b.part], b.leaf);
  });

  // Count the leaves by kind and tile, share by share: those that a tile lists, and those that it is the home of.
  const std::size_t shares = std::clamp<std::size_t>(count / kLeavesPerShare, 1, kMostShares);
  const auto first_of = [&](std::size_t share) { return count * share / shares; };
  const std::size_t tiles = std::size_t(tiles_x_) * tiles_y_;
  const auto home_of = [&](const Key& key) {
    return static_cast<std::size_t>(KindOf(key.leaf)) * tiles + std::size_t(HomeOf(key.box));
  };
  std::vector<std::vector<std::size_t>> next(shares), next_at_home(shares);
  ParallelFor(std::size_t{0}, shares, [&](std::size_t share) {
    next[share].assign(tiles, 0);
    next_at_home[share].assign(kLeafKinds * tiles, 0);
    for (std::size_t i = first_of(share); i < first_of(share + 1); ++i) {
      ++next_at_home[share][home_of(keys[i])];
      ForEachTile(keys[i].box, [&](int tile) { ++next[share][tile]; });
    }
  });
  begin_.resize(tiles + 1);
  std::size_t listed = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    begin_[tile] = listed;
    for (auto& counts : next) listed += std::exchange(counts[tile], listed);
  }
  begin_[tiles] = listed;
  std::array<std::vector<Source>, kLeafKinds> sources;
  for (std::size_t kind = 0; kind < kLeafKinds; ++kind) {
    std::size_t placed = 0;
    for (std::size_t tile = 0; tile < tiles; ++tile)
      for (auto& counts : next_at_home) placed += std::exchange(counts[kind * tiles + tile], placed);
    sources[kind].resize(placed);
  }

  // Give each leaf its place and list it. Leaves are processed in order, so the list of each tile is sorted.
  listed_.resize(listed);
  ParallelFor(std::size_t{0}, shares, [&](std::size_t share) {
    for (std::size_t i = first_of(share); i < first_of(share + 1); ++i) {
      const Key& key = keys[i];
      const std::size_t to = next_at_home[share][home_of(key)]++;
      sources[static_cast<std::size_t>(KindOf(key.leaf))][to] = {key.part, IndexWithin(key.leaf)};
      const std::uint32_t leaf = LeafId(KindOf(key.leaf), to);
      ForEachTile(key.box, [&](int tile) {
        listed_[next[share][tile]++] = TileLeaf::Of(key.near_depth, key.box, leaf,
                                                    tile % tiles_x_ * kTileSize, tile / tiles_x_ * kTileSize);
      });
    }
  });
  Gather(parts, sources);
}

void TileLeaves::Gather(const std::vector<LeafSpans>& parts,
                        const std::array<std::vector<Source>, kLeafKinds>& sources) {
  const auto gather = [](const std::vector<Source>& from, const auto& copy) {
    ParallelForBlocks(0, from.size(), kLeavesPerShare, [&](std::size_t first, std::size_t last) {
      for (std::size_t to = first; to < last; ++to) copy(from[to], to);
    });
  };
  certified_.resize(sources[0].size());
  places_.resize(sources[0].size());
  hard_.resize(sources[1].size());
  seams_.resize(sources[2].size());
  gather(sources[0], [&](Source from, std::size_t to) {
    certified_[to] = parts[from.part].certified[from.index];
    places_[to] = parts[from.part].places[from.index];
  });
  gather(sources[1], [&](Source from, std::size_t to) { hard_[to] = parts[from.part].hard[from.index]; });
  gather(sources[2], [&](Source from, std::size_t to) { seams_[to] = parts[from.part].seams[from.index]; });
}

int TileLeaves::HomeOf(const SampleBox& box) const {
  return box.first_row / kTileSize * tiles_x_ + box.first_col / kTileSize;
}

template <typename Visit>
void TileLeaves::ForEachTile(const SampleBox& box, const Visit& visit) const {
  for (int y = box.first_row / kTileSize; y <= box.last_row / kTileSize; ++y) {
    for (int x = box.first_col / kTileSize; x <= box.last_col / kTileSize; ++x) visit(y * tiles_x_ + x);
  }
}

std::size_t TileLeaves::leaf_bytes() const {
  return certified_.capacity() * (sizeof(CertifiedLeaf) + sizeof(LeafPlace)) +
         hard_.capacity() * sizeof(HardLeaf) + seams_.capacity() * sizeof(SeamLeaf);
}

std::size_t TileLeaves::bytes() const {
  return leaf_bytes() + begin_.capacity() * sizeof(std::size_t) + listed_.capacity() * sizeof(TileLeaf);
}

void TileBitmaps::Build(const TileLeaves& tiles, int tile) {
  const auto list = tiles.Tile(tile);
  words_ = static_cast<int>((list.size() + 63) / 64);
  bits_.resize(std::size_t(2 * kTileSize) * words_);
  for (int word = 0; word < words_; ++word) {
    // The bit of a leaf changes at the first row of its box and behind the last one, so each row is the sum modulo 2 of
    // the changes up to it; likewise for columns.
    std::uint64_t row_changes[kTileSize + 1] = {}, column_changes[kTileSize + 1] = {};
    const std::size_t first = std::size_t(64) * word, end = std::min(first + 64, list.size());
    for (std::size_t k = first; k < end; ++k) {
      const TileLeaf& leaf = list[k];
      const std::uint64_t bit = std::uint64_t{1} << (k - first);
      row_changes[leaf.first_row] ^= bit;
      row_changes[leaf.last_row + 1] ^= bit;
      column_changes[leaf.first_column] ^= bit;
      column_changes[leaf.last_column + 1] ^= bit;
    }
    std::uint64_t in_row = 0, in_column = 0;
    std::uint64_t* out = bits_.data() + word;
    for (int i = 0; i < kTileSize; ++i) {
      in_row ^= row_changes[i];
      in_column ^= column_changes[i];
      out[std::size_t(i) * words_] = in_row;
      out[std::size_t(kTileSize + i) * words_] = in_column;
    }
  }
}

}  // namespace facetless
