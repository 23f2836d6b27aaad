#include "render/voxels/near_faces.h"

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

namespace facetless {

NearFaces::NearFaces(std::vector<TouchedSlab> slabs, int size_y) : slabs_(std::move(slabs)), size_y_(size_y) {
  first_.reserve(slabs_.size() * (static_cast<std::size_t>(size_y_) + 1));
  for (const TouchedSlab& slab : slabs_) {
    std::size_t at = 0;
    for (int y = 0; y <= size_y_; ++y) {
      while (at < slab.size() && slab[at].y < y) ++at;
      first_.push_back(static_cast<std::uint32_t>(at));
    }
  }
}

std::span<const TouchedVoxel> NearFaces::Between(int x, int y, int low, int high) const {
  if (x < 0 || y < 0 || y >= size_y_ || static_cast<std::size_t>(x) >= slabs_.size()) return {};
  const auto column =
      static_cast<std::size_t>(x) * (static_cast<std::size_t>(size_y_) + 1) + static_cast<std::size_t>(y);
  const TouchedSlab& slab = slabs_[static_cast<std::size_t>(x)];
  const auto begin = slab.begin() + static_cast<std::ptrdiff_t>(first_[column]),
             end = slab.begin() + static_cast<std::ptrdiff_t>(first_[column + 1]);
  const auto from =
      std::lower_bound(begin, end, low, [](const TouchedVoxel& voxel, int z) { return voxel.z < z; });
  auto to = from;
  while (to != end && to->z <= high) ++to;
  return {from, to};
}

std::optional<NearFace> NearFaces::Near(VoxelPoint at, int reach, Vec3 direction) const {
  const auto visit = [&](const auto& act) {
    for (int dx = -reach; dx <= reach; ++dx)
      for (int dy = -reach; dy <= reach; ++dy)
        for (const TouchedVoxel& voxel : Between(at.x + dx, at.y + dy, at.z - reach, at.z + reach)) {
          const int dz = voxel.z - at.z;
          act(voxel, dx * dx + dy * dy + dz * dz);
        }
  };
  // Whether the face turns away, the squared distance, how far the normal turns away, and the face.
  std::optional<std::tuple<bool, int, double, std::uint32_t>> best;
  visit([&](const TouchedVoxel& voxel, int square) {
    const double away = Dot(NormalOfCode(voxel.normal), direction);
    const std::tuple found{!(away < 0), square, away, voxel.placed_face};
    if (!best || found < *best) best = found;
  });
  if (!best) return std::nullopt;
  const std::uint32_t face = std::get<3>(*best);
  Vec3 sum{0, 0, 0};
  visit([&](const TouchedVoxel& voxel, int square) {
    if (voxel.placed_face == face) sum = sum + (1.0 / (1 + square)) * NormalOfCode(voxel.normal);
  });
  const double length = Length(sum);
  return NearFace{face, length > 0 ? (1 / length) * sum : Vec3{0, 0, 0}};
}

std::uint64_t NearFaces::bytes() const {
  std::uint64_t sum = first_.capacity() * sizeof(std::uint32_t) + slabs_.capacity() * sizeof(TouchedSlab);
  for (const TouchedSlab& slab : slabs_) sum += slab.capacity() * sizeof(TouchedVoxel);
  return sum;
}

}  // namespace facetless
