// The walk "bresenham": Bresenham's algorithm with three axes, in floating point, through a raw model; P. Procházka (2013),
// sections 3.2 and 6.10. The point advances by one voxel along the axis of the largest component with each step, so that the
// walk misses voxels that the ray enters and leaves between two steps. Its hits are those of the points: t is that of the
// point, and the side is the first axis whose index changed with the step.
#include <cmath>

#include "render/voxel_walks/walks.h"
#include "render/voxels/raw_model.h"

namespace facetless {
namespace {

VoxelHit WalkBresenham(const RawModel& model, const VoxelRay& ray, const WalkOptions&,
                       WalkCounters* counters) {
  ++counters->rays;
  const double start = ray.t_first();
  const Vec3 direction = ray.direction();
  const double length =
      std::max(std::max(std::abs(direction.x), std::abs(direction.y)), std::abs(direction.z));
  const Vec3 step = length > 0 ? (1 / length) * direction : Vec3{0, 0, 0};
  // The first voxel is the exact one.
  VoxelHit hit = ray.HitAt(start, {}, 0);
  Vec3 point = ray.PointAt(start);
  for (int k = 0;; ++k) {
    ++counters->steps;
    hit.voxel = model.At(hit.at);
    if (hit.voxel.filled()) {
      hit.t = length > 0 ? start + k / length : start;
      return hit;
    }
    point = point + step;
    if (!(length > 0) || !(point.x >= 0 && point.y >= 0 && point.z >= 0)) return {};
    const VoxelPoint at{static_cast<int>(std::min(point.x, 1e6)), static_cast<int>(std::min(point.y, 1e6)),
                        static_cast<int>(std::min(point.z, 1e6))};
    if (!model.box().Holds(at)) return {};
    if (!(at == hit.at)) hit.side = at.x != hit.at.x ? 0 : at.y != hit.at.y ? 1 : 2;
    hit.at = at;
  }
}

}  // namespace

std::unique_ptr<const BoundWalk> BindBresenham(const VoxelModel& model, int setting) {
  return BindFunction<RawModel, WalkBresenham>(model, setting);
}

}  // namespace facetless
