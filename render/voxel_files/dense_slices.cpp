#include "render/voxel_files/dense_slices.h"

#include <optional>
#include <utility>

namespace facetless {

void VisitSlices(const VoxelModel& model,
                 const std::function<void(int z, std::span<const Voxel> slice)>& visit) {
  std::optional<RunModel> copy;
  const auto* runs = dynamic_cast<const RunModel*>(&model);
  if (runs == nullptr) runs = &copy.emplace(RunsOf(model));
  const VoxelPoint n = model.size();
  // The next run of each column.
  std::vector<std::uint32_t> next(static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y));
  std::vector<Voxel> slice(next.size());
  for (int z = 0; z < n.z; ++z) {
    std::size_t i = 0;
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x, ++i) {
        const std::span<const VoxelRun> column = runs->Column(x, y);
        while (next[i] < column.size() && column[next[i]].z_end <= z) ++next[i];
        slice[i] = next[i] < column.size() && column[next[i]].z_begin <= z ? column[next[i]].voxel : Voxel{};
      }
    visit(z, slice);
  }
}

SliceCollector::SliceCollector(VoxelPoint size)
    : size_(size), columns_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {}

void SliceCollector::Add(std::span<const Voxel> slice) {
  std::size_t i = 0;
  for (int y = 0; y < size_.y; ++y)
    for (int x = 0; x < size_.x; ++x, ++i) {
      if (!slice[i].filled()) continue;
      std::vector<VoxelRun>& column =
          columns_[static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y) +
                   static_cast<std::size_t>(y)];
      if (!column.empty() && column.back().z_end == z_ && column.back().voxel == slice[i]) {
        ++column.back().z_end;
      } else {
        column.push_back({z_, z_ + 1, slice[i]});
      }
    }
  ++z_;
}

RunModel SliceCollector::Take() {
  RunModel model(size_);
  for (int x = 0; x < size_.x; ++x) {
    std::vector<std::uint32_t> first{0};
    std::vector<VoxelRun> runs;
    for (int y = 0; y < size_.y; ++y) {
      const std::vector<VoxelRun>& column =
          columns_[static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y) +
                   static_cast<std::size_t>(y)];
      runs.insert(runs.end(), column.begin(), column.end());
      first.push_back(static_cast<std::uint32_t>(runs.size()));
    }
    model.SetSlab(x, std::move(first), std::move(runs));
  }
  return model;
}

}  // namespace facetless
