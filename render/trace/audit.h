// The audit of a view. It examines all crossings of every ray, not only the nearest one.
//
//  1. Every ray crosses a closed solid an even number of times. A ray that crosses a placed closed solid an
//     odd number of times is an odd ray: light leaks there, or a face is counted twice.
//  2. The same lines are traced again from the opposite side: projected, split and solved anew. A ray is a
//     reverse mismatch if the crossings of both directions differ in number, or in depth by more than
//     kReverseTolerance of the model's diagonal.
//  3. Two leaves of one face that share a border may both find the same root. Two roots of the same face are
//     considered one root if both lie on the border of their leaves, or were found without proof, and if
//     their depths agree to within the error of the solver.
#pragma once

#include <cstdint>
#include <vector>

#include "render/kernels/tile_kernel.h"
#include "render/trace/prepare.h"
#include "render/trace/tile_tracer.h"

namespace facetless {

inline constexpr double kReverseTolerance = 1e-9;

// A crossing, with its depth and sample in the forward view.
struct AuditHit {
  std::uint32_t sample, placed_face;
  RootTwin root;  // includes the depth, mm
};

struct AuditResult {
  bool has_closed_solid = false;
  std::uint64_t crossings = 0;
  std::vector<std::uint32_t> odd_samples;  // row·width + column, ascending
  std::vector<std::uint32_t> mismatched_samples;
  // All crossings of these samples, sorted by sample and depth, in the forward and in the backward view.
  std::vector<AuditHit> forward, backward;
};

// Audits a view. `view` is the forward view, prepared for `frame`. Errors: the errors of PrepareView.
Result<AuditResult> Audit(const Scene::Data& scene, const PreparedView& view, const Camera& camera,
                          const CameraFrame& frame, TileKernel kernel, const DirectOptions& options);

}  // namespace facetless
