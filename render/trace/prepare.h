// Preparation of one view: every placed face that may be visible is projected and split into leaves, and the
// leaves are listed per tile.
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
  std::vector<CoefficientArena> arenas;     // own the coefficients of the leaves
  std::vector<LeafLists> between;           // leaves between the pixel centres, for PrepareRefinement
  std::vector<std::uint32_t> unseen_faces;  // placed faces without a leaf, ascending
  std::uint64_t nodes = 0;
  KernelArithmetic arithmetic;          // of the kernel that the leaves were made for
  const NetOperations* nets = nullptr;  // the operations that made the leaves

  std::size_t bytes() const;
};

// Prepares a view. Errors: kCancelled; kLimitExceeded; the errors of ActiveKernels.
Result<PreparedView> PrepareView(const Scene::Data& scene, const Camera& camera, const CameraFrame& frame,
                                 const DirectOptions& options);

// Prepares the samples of some pixels of a view that was prepared with DirectOptions::refine. The leaves of the
// view are valid for every ray, whether it passes a pixel centre or not, and are used again in units of samples.
// `centres` must outlive the result. `camera` and `frame` are those of the samples. Errors: kCancelled,
// kLimitExceeded.
Result<PreparedView> PrepareRefinement(const Scene::Data& scene, const PreparedView& centres,
                                       const Camera& camera, const CameraFrame& frame, SampleGrid grid,
                                       const PixelSet& pixels, const DirectOptions& options);

}  // namespace facetless
