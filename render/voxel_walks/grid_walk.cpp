// The walk "grid": the voxels of a raw model, one by one.
#include "render/voxel_walks/grid_steps.h"
#include "render/voxel_walks/walks.h"
#include "render/voxels/raw_model.h"

namespace facetless {
namespace {

VoxelHit WalkGrid(const RawModel& model, const VoxelRay& ray, const WalkOptions&, WalkCounters* counters) {
  ++counters->rays;
  double t = ray.t_first();
  return StepThrough(
      ray, model.box(), &t, [&](VoxelPoint p) { return model.At(p); }, counters);
}

}  // namespace

std::unique_ptr<const BoundWalk> BindGrid(const VoxelModel& model, int setting) {
  return BindFunction<RawModel, WalkGrid>(model, setting);
}

}  // namespace facetless
