// The encoding "runs": for each column along z, the filled runs of equal voxels. Solids need memory in proportion to their
// surface, and a voxelizer can write column after column.
//
//  1. The columns of one x lie one after the other in a slab. An edit that changes the number of runs of a column moves
//     the runs behind it in the slab.
//  2. The runs of a column are ascending and do not overlap, and two runs that touch have different voxels.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/voxels/encodings.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

class RunModel final : public VoxelModel {
 public:
  explicit RunModel(VoxelPoint size);

  std::string_view encoding() const override { return "runs"; }
  Voxel Get(int x, int y, int z) const override;
  void VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const override;
  void Fill(const VoxelBox& box, Voxel voxel) override;
  void SetColumn(int x, int y, std::span<const VoxelRun> runs) override;
  std::uint64_t Count() const override;
  std::uint64_t bytes() const override;

  // The runs of a column inside the model.
  std::span<const VoxelRun> Column(int x, int y) const {
    const Slab& slab = slabs_[static_cast<std::size_t>(x)];
    return {slab.runs.data() + slab.first[static_cast<std::size_t>(y)],
            slab.runs.data() + slab.first[static_cast<std::size_t>(y) + 1]};
  }
  // Replaces all columns of one x: column y has the runs [first[y], first[y+1]). Other slabs may be set at the same time
  // by other threads. Requires size().y + 1 ascending indices, and runs that keep law 2.
  void SetSlab(int x, std::vector<std::uint32_t> first, std::vector<VoxelRun> runs);

  // The voxel to which all voxels of the box are equal, if there is one. Voxels outside the model count as empty.
  std::optional<Voxel> Uniform(const VoxelBox& box) const;

 private:
  struct Slab {
    std::vector<std::uint32_t> first;  // of each column, and the end
    std::vector<VoxelRun> runs;
  };
  void ReplaceColumn(int x, int y, std::vector<VoxelRun>& runs);

  std::vector<Slab> slabs_;
};

// Copies a model.
RunModel RunsOf(const VoxelModel& model);

}  // namespace facetless
