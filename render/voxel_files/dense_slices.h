// The voxels of a model slice by slice, for formats that store them with x fastest and z slowest.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "render/voxels/run_model.h"

namespace facetless {

// Calls visit(z, slice) for each z, ascending; a slice has size.x·size.y voxels, x fastest.
void VisitSlices(const VoxelModel& model,
                 const std::function<void(int z, std::span<const Voxel> slice)>& visit);

// Makes a model of slices that are read one after the other.
class SliceCollector {
 public:
  explicit SliceCollector(VoxelPoint size);
  // Adds the next slice.
  void Add(std::span<const Voxel> slice);
  RunModel Take();

 private:
  VoxelPoint size_;
  int z_ = 0;
  std::vector<std::vector<VoxelRun>> columns_;  // x·size.y + y
};

}  // namespace facetless
