// The voxels of a model slice by slice, for formats that store them so.
//
//  1. A slice across an axis has the voxels with one coordinate along it. The other two coordinates run through the slice in
//     their order, the earlier one fastest: slices across z have x fastest, and those across x have y fastest.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxels/run_model.h"

namespace facetless {

// The width and the height of a slice across an axis (0, 1, 2), and the number of slices.
struct SliceShape {
  int width = 0, height = 0, count = 0;
  std::size_t area() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};
SliceShape ShapeOfSlices(VoxelPoint size, int axis);
// The size of the model that has these slices.
VoxelPoint SizeOfSlices(const SliceShape& shape, int axis);

// Calls visit(index, slice) for each slice, ascending, until it returns an error, which is returned. Error of its own:
// kCancelled.
Result<void> VisitSlices(const VoxelModel& model, int axis, const std::atomic<bool>* cancel,
                         const std::function<Result<void>(int index, std::span<const Voxel> slice)>& visit);

// The same across z, for visits that do not fail.
void VisitSlices(const VoxelModel& model,
                 const std::function<void(int z, std::span<const Voxel> slice)>& visit);

// Makes a model of slices that are read one after the other.
class SliceCollector {
 public:
  // Of the options, max_bytes and cancel are used. Error: kLimitExceeded (the columns alone need more than max_bytes); the
  // message names `path`.
  static Result<SliceCollector> Of(const std::string& path, VoxelPoint size, int axis,
                                   const VoxelFileOptions& options);
  const SliceShape& shape() const { return shape_; }
  // Adds the next slice. Errors: kLimitExceeded (the runs need more than max_bytes), kCancelled.
  Result<void> Add(std::span<const Voxel> slice);
  RunModel Take();

 private:
  SliceCollector(const std::string& path, VoxelPoint size, int axis, const VoxelFileOptions& options);

  std::string path_;
  VoxelPoint size_;
  int axis_;
  std::uint64_t max_bytes_, runs_ = 0;
  const std::atomic<bool>* cancel_;
  SliceShape shape_;
  int next_ = 0;
  std::vector<std::vector<VoxelRun>> columns_;  // x·size.y + y
};

}  // namespace facetless
