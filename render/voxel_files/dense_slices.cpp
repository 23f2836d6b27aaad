#include "render/voxel_files/dense_slices.h"

#include <cassert>
#include <optional>
#include <utility>

namespace facetless {
namespace {

// The voxel of the slice's pixel (i, j).
VoxelPoint PointOf(int axis, int index, int i, int j) {
  if (axis == 0) return {index, i, j};
  if (axis == 1) return {i, index, j};
  return {i, j, index};
}

Error TooManyVoxels(const std::string& path, std::uint64_t max_bytes) {
  return {ErrorCode::kLimitExceeded, path + ": the voxels need more than " + std::to_string(max_bytes >> 20) +
                                         " MB; raise --max-view-memory"};
}

// Copies slices across z, whose pixels lie in columns of their own. Few columns change from one slice to the next, so only
// these are looked up.
class LayersOfRuns {
 public:
  explicit LayersOfRuns(const RunModel& runs)
      : runs_(runs),
        next_(static_cast<std::size_t>(runs.size().x) * static_cast<std::size_t>(runs.size().y)),
        changes_(next_.size(), 0) {}

  // Makes the slice of z from that of z − 1.
  void Advance(int z, std::span<Voxel> slice) {
    std::size_t i = 0;
    for (int y = 0; y < runs_.size().y; ++y)
      for (int x = 0; x < runs_.size().x; ++x, ++i) {
        if (z < changes_[i]) continue;
        const std::span<const VoxelRun> column = runs_.Column(x, y);
        while (next_[i] < column.size() && column[next_[i]].z_end <= z) ++next_[i];
        const VoxelRun* run = next_[i] < column.size() ? &column[next_[i]] : nullptr;
        const bool inside = run != nullptr && run->z_begin <= z;
        slice[i] = inside ? run->voxel : Voxel{};
        changes_[i] = inside ? run->z_end : run != nullptr ? run->z_begin : runs_.size().z;
      }
  }

 private:
  const RunModel& runs_;
  std::vector<std::uint32_t> next_;  // the next run of each column
  std::vector<int> changes_;         // the z at which each column changes next
};

// Copies a slice across x or y: its pixels with the same i are a column.
void CopyColumns(const RunModel& runs, int axis, int index, const SliceShape& shape, std::span<Voxel> slice) {
  std::fill(slice.begin(), slice.end(), Voxel{});
  for (int i = 0; i < shape.width; ++i) {
    const VoxelPoint at = PointOf(axis, index, i, 0);
    for (const VoxelRun& run : runs.Column(at.x, at.y))
      for (int z = run.z_begin; z < run.z_end; ++z)
        slice[static_cast<std::size_t>(z) * static_cast<std::size_t>(shape.width) +
              static_cast<std::size_t>(i)] = run.voxel;
  }
}

}  // namespace

SliceShape ShapeOfSlices(VoxelPoint size, int axis) {
  if (axis == 0) return {size.y, size.z, size.x};
  if (axis == 1) return {size.x, size.z, size.y};
  return {size.x, size.y, size.z};
}

VoxelPoint SizeOfSlices(const SliceShape& shape, int axis) {
  return PointOf(axis, shape.count, shape.width, shape.height);
}

Result<void> VisitSlices(const VoxelModel& model, int axis, const std::atomic<bool>* cancel,
                         const std::function<Result<void>(int index, std::span<const Voxel> slice)>& visit) {
  std::optional<RunModel> copy;
  const auto* runs = dynamic_cast<const RunModel*>(&model);
  if (runs == nullptr) runs = &copy.emplace(RunsOf(model));
  const SliceShape shape = ShapeOfSlices(model.size(), axis);
  std::optional<LayersOfRuns> layers;
  if (axis == 2) layers.emplace(*runs);
  std::vector<Voxel> slice(shape.area());
  for (int index = 0; index < shape.count; ++index) {
    if (Execution{0, cancel}.cancelled())
      return Error{ErrorCode::kCancelled, "the writing of voxels was stopped"};
    if (layers) {
      layers->Advance(index, slice);
    } else {
      CopyColumns(*runs, axis, index, shape, slice);
    }
    if (auto visited = visit(index, slice); !visited.ok()) return visited;
  }
  return {};
}

void VisitSlices(const VoxelModel& model,
                 const std::function<void(int z, std::span<const Voxel> slice)>& visit) {
  const auto visited =
      VisitSlices(model, 2, nullptr, [&](int z, std::span<const Voxel> slice) -> Result<void> {
        visit(z, slice);
        return {};
      });
  assert(visited.ok());
  static_cast<void>(visited);
}

SliceCollector::SliceCollector(const std::string& path, VoxelPoint size, int axis,
                               const VoxelFileOptions& options)
    : path_(path),
      size_(size),
      axis_(axis),
      max_bytes_(options.max_bytes),
      cancel_(options.cancel),
      shape_(ShapeOfSlices(size, axis)),
      columns_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {}

Result<SliceCollector> SliceCollector::Of(const std::string& path, VoxelPoint size, int axis,
                                          const VoxelFileOptions& options) {
  // What a column and a pixel of a slice need.
  constexpr double kColumnBytes = sizeof(std::vector<VoxelRun>) + 2 * sizeof(std::uint32_t), kPixelBytes = 16;
  const double bytes =
      kColumnBytes * size.x * size.y + kPixelBytes * static_cast<double>(ShapeOfSlices(size, axis).area());
  if (bytes > static_cast<double>(options.max_bytes)) return TooManyVoxels(path, options.max_bytes);
  return SliceCollector(path, size, axis, options);
}

Result<void> SliceCollector::Add(std::span<const Voxel> slice) {
  if (Execution{0, cancel_}.cancelled())
    return Error{ErrorCode::kCancelled, path_ + ": the reading was stopped"};
  std::size_t pixel = 0;
  for (int j = 0; j < shape_.height; ++j)
    for (int i = 0; i < shape_.width; ++i, ++pixel) {
      if (!slice[pixel].filled()) continue;
      const VoxelPoint p = PointOf(axis_, next_, i, j);
      std::vector<VoxelRun>& column =
          columns_[static_cast<std::size_t>(p.x) * static_cast<std::size_t>(size_.y) +
                   static_cast<std::size_t>(p.y)];
      if (!column.empty() && column.back().z_end == p.z && column.back().voxel == slice[pixel]) {
        ++column.back().z_end;
      } else {
        column.push_back({p.z, p.z + 1, slice[pixel]});
        ++runs_;
      }
    }
  ++next_;
  // A growing column has up to twice its runs, and the finished model holds them once more.
  constexpr std::uint64_t kRunBytes = 3 * sizeof(VoxelRun);
  if (runs_ * kRunBytes > max_bytes_) return TooManyVoxels(path_, max_bytes_);
  return {};
}

RunModel SliceCollector::Take() {
  RunModel model(size_);
  for (int x = 0; x < size_.x; ++x) {
    std::vector<std::uint32_t> first{0};
    std::vector<VoxelRun> runs;
    for (int y = 0; y < size_.y; ++y) {
      std::vector<VoxelRun> column =
          std::move(columns_[static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y) +
                             static_cast<std::size_t>(y)]);
      runs.insert(runs.end(), column.begin(), column.end());
      first.push_back(static_cast<std::uint32_t>(runs.size()));
    }
    model.SetSlab(x, std::move(first), std::move(runs));
  }
  return model;
}

}  // namespace facetless
