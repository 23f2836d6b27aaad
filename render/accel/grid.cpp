#include "render/accel/grid.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

VoxelPlanes GridPlanes(const BoxSet& boxes, GridSettings settings) {
  std::uint32_t c = settings.c;
  if (c == 0)
    c = static_cast<std::uint32_t>(std::clamp(std::round(std::cbrt(Grid::kVoxelsPerObject * boxes.size())),
                                              1.0, double(Grid::kMostIntervals)));
  VoxelPlanes planes = EvenPlanes(boxes.bounds(), {c, c, c});
  while (c > 1 &&
         static_cast<double>(CountReferences(boxes, planes)) > Grid::kMostReferences * boxes.size()) {
    c = (c + 1) / 2;
    planes = EvenPlanes(boxes.bounds(), {c, c, c});
  }
  return planes;
}

}  // namespace

double EstimatedShare(double d, const StructureFigures& figures, double objects) {
  return objects > 0 ? d * figures.references / (objects * figures.regions) : 0;
}

Grid::Grid(std::span<const Box3> boxes, GridSettings settings)
    : boxes_(boxes), planes_(GridPlanes(boxes_, settings)), lists_(boxes_, planes_) {}

}  // namespace facetless
