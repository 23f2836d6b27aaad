#include "render/accel/ssm_lists.h"

#include "render/accel/bmssm_slices.h"

namespace facetless {

double MemoryEfficiency(double slices, double objects, double per_supervoxel) {
  return objects > 0 ? 16.0 / 3 * (per_supervoxel + 2) / objects * slices * slices : 0;
}

SsmLists::SsmLists(std::span<const Box3> boxes, std::uint32_t slices)
    : boxes_(boxes),
      planes_(EvenPlanes(boxes_.bounds(), SliceCounts(boxes_.size(), slices))),
      lists_(boxes_, planes_) {}

}  // namespace facetless
