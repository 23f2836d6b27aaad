#include "render/voxels/run_model.h"

#include <algorithm>
#include <utility>

namespace facetless {
namespace {

// Appends a run, joined to the last one if they touch and are equal.
void Append(std::vector<VoxelRun>& runs, const VoxelRun& run) {
  if (run.z_begin >= run.z_end || !run.voxel.filled()) return;
  if (!runs.empty() && runs.back().z_end == run.z_begin && runs.back().voxel == run.voxel) {
    runs.back().z_end = run.z_end;
  } else {
    runs.push_back(run);
  }
}

}  // namespace

int LevelOf(VoxelPoint size) {
  int level = 0;
  while ((1 << level) < std::max({size.x, size.y, size.z})) ++level;
  return level;
}

RunModel::RunModel(VoxelPoint size) : VoxelModel(size), slabs_(static_cast<std::size_t>(size.x)) {
  for (Slab& slab : slabs_) slab.first.assign(static_cast<std::size_t>(size.y) + 1, 0);
}

Voxel RunModel::Get(int x, int y, int z) const {
  if (!box().Holds({x, y, z})) return {};
  const std::span<const VoxelRun> runs = Column(x, y);
  const auto after = std::upper_bound(runs.begin(), runs.end(), z,
                                      [](int at, const VoxelRun& run) { return at < run.z_end; });
  return after != runs.end() && after->z_begin <= z ? after->voxel : Voxel{};
}

void RunModel::VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const {
  if (x < 0 || y < 0 || x >= size().x || y >= size().y) return;
  for (const VoxelRun& run : Column(x, y)) visit(run);
}

void RunModel::ReplaceColumn(int x, int y, std::vector<VoxelRun>& runs) {
  Slab& slab = slabs_[static_cast<std::size_t>(x)];
  const std::size_t at = static_cast<std::size_t>(y);
  const std::uint32_t begin = slab.first[at], end = slab.first[at + 1];
  const auto first = slab.runs.begin() + begin;
  if (runs.size() == end - begin) {
    std::copy(runs.begin(), runs.end(), first);
    return;
  }
  slab.runs.insert(slab.runs.erase(first, slab.runs.begin() + end), runs.begin(), runs.end());
  const std::uint32_t moved = static_cast<std::uint32_t>(runs.size()) - (end - begin);
  for (std::size_t i = at + 1; i < slab.first.size(); ++i) slab.first[i] += moved;
}

void RunModel::Fill(const VoxelBox& region, Voxel voxel) {
  const VoxelBox inside = Intersection(region, box());
  if (inside.empty()) return;
  const int begin = inside.low.z, end = inside.high.z;
  std::vector<VoxelRun> runs;
  for (int x = inside.low.x; x < inside.high.x; ++x)
    for (int y = inside.low.y; y < inside.high.y; ++y) {
      runs.clear();
      bool written = false;
      const auto write = [&] {
        if (!std::exchange(written, true)) Append(runs, {begin, end, voxel});
      };
      for (const VoxelRun& run : Column(x, y)) {
        Append(runs, {run.z_begin, std::min(run.z_end, begin), run.voxel});
        if (run.z_end > begin) write();
        Append(runs, {std::max(run.z_begin, end), run.z_end, run.voxel});
      }
      write();
      ReplaceColumn(x, y, runs);
    }
}

void RunModel::SetColumn(int x, int y, std::span<const VoxelRun> runs) {
  if (x < 0 || y < 0 || x >= size().x || y >= size().y) return;
  std::vector<VoxelRun> clean;
  for (const VoxelRun& run : runs)
    Append(clean, {std::max(run.z_begin, 0), std::min(run.z_end, size().z), run.voxel});
  ReplaceColumn(x, y, clean);
}

void RunModel::SetSlab(int x, std::vector<std::uint32_t> first, std::vector<VoxelRun> runs) {
  slabs_[static_cast<std::size_t>(x)] = {std::move(first), std::move(runs)};
}

std::uint64_t RunModel::Count() const {
  std::uint64_t count = 0;
  for (const Slab& slab : slabs_)
    for (const VoxelRun& run : slab.runs) count += static_cast<std::uint64_t>(run.z_end - run.z_begin);
  return count;
}

std::uint64_t RunModel::bytes() const {
  std::uint64_t bytes = slabs_.capacity() * sizeof(Slab);
  for (const Slab& slab : slabs_)
    bytes += slab.first.capacity() * sizeof(std::uint32_t) + slab.runs.capacity() * sizeof(VoxelRun);
  return bytes;
}

std::optional<Voxel> RunModel::Uniform(const VoxelBox& region) const {
  const VoxelBox inside = Intersection(region, box());
  if (inside.empty()) return Voxel{};
  const bool clipped = inside.volume() != region.volume();
  std::optional<Voxel> all;
  for (int x = inside.low.x; x < inside.high.x; ++x)
    for (int y = inside.low.y; y < inside.high.y; ++y) {
      const std::span<const VoxelRun> runs = Column(x, y);
      const auto run = std::upper_bound(runs.begin(), runs.end(), inside.low.z,
                                        [](int z, const VoxelRun& r) { return z < r.z_end; });
      Voxel voxel;
      if (run != runs.end() && run->z_begin < inside.high.z) {
        if (run->z_begin > inside.low.z || run->z_end < inside.high.z) return std::nullopt;
        voxel = run->voxel;
      }
      if (all && !(*all == voxel)) return std::nullopt;
      all = voxel;
    }
  if (clipped && all->filled()) return std::nullopt;
  return all;
}

RunModel RunsOf(const VoxelModel& model) {
  RunModel runs(model.size());
  for (int x = 0; x < model.size().x; ++x) {
    std::vector<std::uint32_t> first{0};
    std::vector<VoxelRun> slab;
    for (int y = 0; y < model.size().y; ++y) {
      model.VisitColumn(x, y, [&](const VoxelRun& run) { slab.push_back(run); });
      first.push_back(static_cast<std::uint32_t>(slab.size()));
    }
    runs.SetSlab(x, std::move(first), std::move(slab));
  }
  return runs;
}

}  // namespace facetless
