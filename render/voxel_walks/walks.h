// The walks behind voxel_walk.h, a file each: what binds them to a model.
#pragma once

#include <memory>

#include "render/voxel_walks/voxel_walk.h"

namespace facetless {

// The largest K of kd-shortstack. No path is longer than 16 nodes.
inline constexpr int kMostShortstack = 25;

using WalkBinder = std::unique_ptr<const BoundWalk>(const VoxelModel& model, int setting);

WalkBinder BindGrid;       // grid_walk.cpp
WalkBinder BindBresenham;  // bresenham_walk.cpp
WalkBinder BindColumns;    // column_walk.cpp
WalkBinder BindDescent;    // descent_walk.cpp
WalkBinder BindKdRestart;  // kd_walks.cpp
WalkBinder BindKdRestartSorted;
WalkBinder BindKdBacktrack;
WalkBinder BindKdShortstack;
WalkBinder BindNeighbours;  // neighbour_walk.cpp
WalkBinder BindAdaptive;    // adaptive_walk.cpp
WalkBinder BindN3;          // n3_walk.cpp

// Binds a function, Walk(model, ray, options, counters), that needs nothing besides the model.
template <typename Model, auto kWalk>
std::unique_ptr<const BoundWalk> BindFunction(const VoxelModel& model, int) {
  class Bound final : public BoundWalk {
   public:
    explicit Bound(const Model& m) : model_(m) {}
    VoxelHit Walk(const VoxelRay& ray, const WalkOptions& options, WalkCounters* counters) const override {
      return kWalk(model_, ray, options, counters);
    }

   private:
    const Model& model_;
  };
  return std::make_unique<Bound>(static_cast<const Model&>(model));
}

}  // namespace facetless
