// The base of encodings that are compiled as a whole. An edit decodes the model to runs, edits them and compiles them again,
// which takes time in proportion to the whole model. Make many edits in "runs" or "octree", and convert the result.
#pragma once

#include "render/voxels/run_model.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

class RebuiltModel : public VoxelModel {
 public:
  void Fill(const VoxelBox& region, Voxel voxel) final {
    RunModel runs = RunsOf(*this);
    runs.Fill(region, voxel);
    Compile(runs);
  }
  void SetColumn(int x, int y, std::span<const VoxelRun> column) final {
    RunModel runs = RunsOf(*this);
    runs.SetColumn(x, y, column);
    Compile(runs);
  }

 protected:
  using VoxelModel::VoxelModel;
  // Replaces the voxels by those of a model of the same size.
  virtual void Compile(const RunModel& runs) = 0;
};

// Calls visit for the filled runs of a column. leaf_at(z) returns the voxel at z, and the end of the voxels from z upwards
// that are known to be equal to it.
template <typename LeafAt>
void VisitLeaves(int z_end, const LeafAt& leaf_at, const std::function<void(const VoxelRun&)>& visit) {
  VoxelRun run;
  for (int z = 0; z < z_end;) {
    const auto [voxel, end] = leaf_at(z);
    if (run.voxel.filled() && run.voxel == voxel) {
      run.z_end = std::min(end, z_end);
    } else {
      if (run.voxel.filled()) visit(run);
      run = {z, std::min(end, z_end), voxel};
    }
    z = end;
  }
  if (run.voxel.filled()) visit(run);
}

}  // namespace facetless
