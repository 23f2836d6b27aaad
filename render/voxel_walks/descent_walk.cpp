// The walk "descent": down an octree from the root, as descend.h describes.
#include "render/voxel_walks/descend.h"
#include "render/voxel_walks/walks.h"

namespace facetless {
namespace {

VoxelHit WalkDescent(const OctreeModel& model, const VoxelRay& ray, const WalkOptions& options,
                     WalkCounters* counters) {
  ++counters->rays;
  const AscendingRay up = ray.Ascending();
  return Descend(model, RootCube(model, up), ray, up, ray.t_first(), ray.t_last(), options, counters);
}

}  // namespace

std::unique_ptr<const BoundWalk> BindDescent(const VoxelModel& model, int setting) {
  return BindFunction<OctreeModel, WalkDescent>(model, setting);
}

}  // namespace facetless
