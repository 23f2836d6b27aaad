#include "render/accel/lattice.h"

namespace facetless {
namespace {

constexpr double kVoxelsPerObject = 4;
constexpr double kMostReferences = 32;  // per object, on average
constexpr std::uint32_t kMostIntervals = 256;

VoxelPlanes LatticePlanes(const BoxSet& boxes) {
  std::array<std::uint32_t, 3> counts = CubicCounts(boxes, kVoxelsPerObject, kMostIntervals);
  VoxelPlanes planes = BoundaryPlanes(boxes, counts);
  while (planes.voxels() > 1 &&
         static_cast<double>(CountReferences(boxes, planes)) > kMostReferences * boxes.size()) {
    for (std::uint32_t& count : counts) count = (count + 1) / 2;
    planes = BoundaryPlanes(boxes, counts);
  }
  return planes;
}

}  // namespace

Lattice::Lattice(std::span<const Box3> boxes)
    : boxes_(boxes), planes_(LatticePlanes(boxes_)), lists_(boxes_, planes_) {}

}  // namespace facetless
