// Columns of voxels as rays: the camera whose pixels are the columns, and the parts of a column that lie inside closed
// solids.
//
//     VisitCrossings(scene, ColumnCamera(grid, VoxelAxis::kZ), accuracy, execution, [&](const TileCrossings& tile) {
//       const bool odd = parts.List(tile.Of(i, j));
//       for (const ColumnPart& part : parts.list()) Fill(part.begin, part.end);
//     });
//
//  1. The pixels of ColumnCamera are the columns along an axis. Its eye plane is the upper side of the grid, so that a depth
//     is the distance from there.
//  2. A part lies between two crossings of the same closed solid. Parts of different solids may overlap. The crossings of
//     faces that belong to no closed solid are ignored.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/trace/view_crossings.h"
#include "render/view/camera.h"
#include "render/view/section.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

enum class VoxelAxis : std::uint8_t { kX, kY, kZ };

Camera ColumnCamera(const VoxelGrid& grid, VoxelAxis axis);

// A part of a column along z inside a solid, in voxels from the bottom of the grid.
struct ColumnPart {
  double begin, end;
  std::uint32_t solid, lower_face, upper_face;
};

// Lists the parts of one column after another, and reuses its storage.
class ColumnParts {
 public:
  // Both must outlive the object.
  ColumnParts(const VoxelGrid& grid, const SectionSolids& solids) : grid_(grid), solids_(solids) {}

  // Lists the parts of a column, sorted by their ends, the highest first. Returns whether a solid is crossed an odd number
  // of times.
  bool List(std::span<const RayCrossing> crossings);
  const std::vector<ColumnPart>& list() const { return list_; }

 private:
  struct Open {
    std::uint32_t solid;
    double at;
    std::uint32_t face;
  };
  const VoxelGrid& grid_;
  const SectionSolids& solids_;
  std::vector<ColumnPart> list_;
  std::vector<Open> open_;
};

}  // namespace facetless
