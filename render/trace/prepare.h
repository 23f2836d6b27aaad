// Preparation of one view: project every placed face that the window can hold, split it into leaves, list the
// leaves per tile.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "render/accel/bmssm.h"
#include "render/nurbs/leaf_splitter.h"
#include "render/trace/scene.h"
#include "render/view/camera.h"

namespace facetless {

struct PreparedView {
  std::unique_ptr<TileLeaves> tiles;
  std::vector<CoefficientArena> arenas;     // own the leaves' coefficients and nets
  std::vector<std::uint32_t> unseen_faces;  // placed faces without a leaf, ascending
  std::uint64_t nodes = 0;
  KernelArithmetic arithmetic;          // of the kernel that the leaves were made for
  const NetOperations* nets = nullptr;  // that made the leaves

  std::size_t bytes() const;
};

// Errors: kCancelled; kLimitExceeded; those of ActiveKernels.
Result<PreparedView> PrepareView(const Scene::Data& scene, const Camera& camera, const CameraFrame& frame,
                                 const DirectOptions& options);

}  // namespace facetless
