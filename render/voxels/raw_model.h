// The encoding "raw": every voxel, column after column along z. Voxel (x, y, z) is number (x·size.y + y)·size.z + z.
#pragma once

#include <vector>

#include "render/voxels/run_model.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

class RawModel final : public VoxelModel {
 public:
  explicit RawModel(VoxelPoint size);
  explicit RawModel(const RunModel& runs);

  std::string_view encoding() const override { return "raw"; }
  Voxel Get(int x, int y, int z) const override { return box().Holds({x, y, z}) ? At({x, y, z}) : Voxel{}; }
  // Requires a voxel inside the model.
  Voxel At(VoxelPoint p) const { return voxels_[Index(p)]; }
  void VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const override;
  void Fill(const VoxelBox& box, Voxel voxel) override;
  void SetColumn(int x, int y, std::span<const VoxelRun> runs) override;
  std::uint64_t bytes() const override { return voxels_.capacity() * sizeof(Voxel); }
  static std::uint64_t BytesOf(VoxelPoint size) { return VoxelBox{{0, 0, 0}, size}.volume() * sizeof(Voxel); }

 private:
  std::size_t Index(VoxelPoint p) const {
    return (static_cast<std::size_t>(p.x) * static_cast<std::size_t>(size().y) +
            static_cast<std::size_t>(p.y)) *
               static_cast<std::size_t>(size().z) +
           static_cast<std::size_t>(p.z);
  }

  std::vector<Voxel> voxels_;
};

}  // namespace facetless
