// The walk "columns": a grid walk through the columns of a model of runs, which looks at the runs of each column.
#include <algorithm>

#include "render/voxel_walks/walks.h"
#include "render/voxels/run_model.h"

namespace facetless {
namespace {

// The first run of a column that the ray visits between t and t_out, and the t at which it does; infinite if there is none.
double EnterRun(const VoxelRay& ray, std::span<const VoxelRun> runs, double t, double t_out, Voxel* voxel) {
  if (runs.empty()) return INFINITY;
  const int z = ray.CellAt(t).z, sign = ray.sign(2);
  auto run =
      std::upper_bound(runs.begin(), runs.end(), z, [](int at, const VoxelRun& r) { return at < r.z_end; });
  if (run != runs.end() && run->z_begin <= z) {
    *voxel = run->voxel;
    return t;
  }
  // No run holds z: `run` is the next one above, and the one before it is the next one below.
  while (sign > 0 ? run != runs.end() : sign < 0 && run != runs.begin()) {
    if (sign < 0) --run;
    const double in = ray.Pass(2, sign > 0 ? run->z_begin : run->z_end),
                 out = ray.Pass(2, sign > 0 ? run->z_end : run->z_begin);
    if (!(in < t_out)) break;
    *voxel = run->voxel;
    // A run whose planes are passed at the same t is not visited.
    if (in < out) return in;
    if (sign > 0) ++run;
  }
  return INFINITY;
}

VoxelHit WalkColumns(const RunModel& model, const VoxelRay& ray, const WalkOptions&, WalkCounters* counters) {
  ++counters->rays;
  double t = ray.t_first();
  const VoxelPoint first = ray.CellAt(t), size = model.size();
  int index[2] = {first.x, first.y};
  double leave[2];
  for (int axis = 0; axis < 2; ++axis) leave[axis] = ray.Leave(axis, index[axis], index[axis] + 1);
  while (index[0] >= 0 && index[0] < size.x && index[1] >= 0 && index[1] < size.y) {
    ++counters->steps;
    const double t_out = std::min(std::min(leave[0], leave[1]), ray.t_last());
    Voxel voxel;
    const double in = EnterRun(ray, model.Column(index[0], index[1]), t, t_out, &voxel);
    if (in < INFINITY) return ray.HitAt(in, voxel, 0);
    t = t_out;
    if (!(t < ray.t_last())) break;
    for (int axis = 0; axis < 2; ++axis)
      if (leave[axis] == t) {
        index[axis] = ray.IndexAt(axis, t, index[axis] + ray.sign(axis));
        leave[axis] = ray.Leave(axis, index[axis], index[axis] + 1);
      }
  }
  return {};
}

}  // namespace

std::unique_ptr<const BoundWalk> BindColumns(const VoxelModel& model, int setting) {
  return BindFunction<RunModel, WalkColumns>(model, setting);
}

}  // namespace facetless
