// The runs of voxels of a grid of OpenVDB.
#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/voxels/run_model.h"

namespace facetless {

// Collects boxes of filled voxels as runs of columns along z.
class RunsOfGrid {
 public:
  // Voxels from `low` on become those of a model of this size. Requires that all boxes lie in it.
  RunsOfGrid(const openvdb::Coord& low, VoxelPoint size, std::uint64_t max_bytes)
      : low_(low),
        size_(size),
        max_bytes_(max_bytes),
        columns_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {}

  // Returns false if the runs need too much memory.
  bool Add(const openvdb::CoordBBox& box) {
    for (int x = box.min().x(); x <= box.max().x(); ++x)
      for (int y = box.min().y(); y <= box.max().y(); ++y) {
        Column(x - low_.x(), y - low_.y())
            .push_back({box.min().z() - low_.z(), box.max().z() + 1 - low_.z()});
        ++runs_;
      }
    return runs_ * sizeof(Run) * 4 <= max_bytes_;
  }

  // The model of the runs, in which voxel_of(x, y, z) gives the voxel at an index of the grid.
  template <typename VoxelOf>
  RunModel Take(const VoxelOf& voxel_of) {
    RunModel model(size_);
    for (int x = 0; x < size_.x; ++x) {
      std::vector<std::uint32_t> first{0};
      std::vector<VoxelRun> runs;
      for (int y = 0; y < size_.y; ++y) {
        std::vector<Run> column = std::move(Column(x, y));
        std::sort(column.begin(), column.end());
        const std::size_t begin = runs.size();
        for (const auto& [z_begin, z_end] : column)
          for (int z = z_begin; z < z_end; ++z) {
            const Voxel voxel = voxel_of(x + low_.x(), y + low_.y(), z + low_.z());
            if (runs.size() > begin && runs.back().z_end == z && runs.back().voxel == voxel) {
              ++runs.back().z_end;
            } else {
              runs.push_back({z, z + 1, voxel});
            }
          }
        first.push_back(static_cast<std::uint32_t>(runs.size()));
      }
      model.SetSlab(x, std::move(first), std::move(runs));
    }
    return model;
  }

 private:
  using Run = std::array<int, 2>;
  std::vector<Run>& Column(int x, int y) {
    return columns_[static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y) +
                    static_cast<std::size_t>(y)];
  }

  openvdb::Coord low_;
  VoxelPoint size_;
  std::uint64_t max_bytes_, runs_ = 0;
  std::vector<std::vector<Run>> columns_;
};

// Calls visit(box) for all boxes of values that inside(value, active) accepts, until it returns false.
template <typename Tree, typename Inside, typename Visit>
bool VisitInside(const Tree& tree, const Inside& inside, const Visit& visit) {
  using Leaf = typename Tree::LeafNodeType;
  // Tiles first, and then the leaves, in whose columns voxels follow one another along z.
  auto values = tree.cbeginValueAll();
  values.setMaxDepth(Tree::DEPTH - 2);
  for (; values; ++values) {
    if (!inside(values.getValue(), values.isValueOn())) continue;
    openvdb::CoordBBox box;
    values.getBoundingBox(box);
    if (!visit(box)) return false;
  }
  constexpr int kDim = static_cast<int>(Leaf::DIM);
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord origin = leaf->origin();
    for (int column = 0; column < kDim * kDim; ++column) {
      const int first = column * kDim;
      for (int z = 0; z < kDim; ++z) {
        const auto at = static_cast<openvdb::Index>(first + z);
        if (!inside(leaf->getValue(at), leaf->isValueOn(at))) continue;
        int end = z + 1;
        while (end < kDim && inside(leaf->getValue(static_cast<openvdb::Index>(first + end)),
                                    leaf->isValueOn(static_cast<openvdb::Index>(first + end))))
          ++end;
        const openvdb::Coord from = origin.offsetBy(column / kDim, column % kDim, z);
        if (!visit(openvdb::CoordBBox(from, from.offsetBy(0, 0, end - z - 1)))) return false;
        z = end;
      }
    }
  }
  return true;
}

}  // namespace facetless
