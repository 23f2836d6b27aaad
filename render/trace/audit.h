// The audit of a view: every crossing of every ray, not only the nearest.
//
//  1. A closed solid is crossed an even number of times by every ray. A ray that crosses some placed closed
//     solid an odd number of times is an odd ray: light leaks there, or a face is counted twice.
//  2. The same lines are traced once more from the opposite side, projected, split and solved anew. A ray
//     whose crossings differ, in number or in depth by more than kReverseTolerance of the model's diagonal,
//     is a reverse mismatch.
//  3. Two leaves of one face that both own their common border find one root twice. Such twins are told by
//     what they are — roots on the border of their leaves, or met without proof, on the same face — and by
//     depths that agree to within the solver's own error.
#pragma once

#include <cstdint>
#include <vector>

#include "render/kernels/tile_kernel.h"
#include "render/trace/prepare.h"
#include "render/trace/tile_tracer.h"

namespace facetless {

inline constexpr double kReverseTolerance = 1e-9;

// A crossing, as the forward view counts depth and samples.
struct AuditHit {
  std::uint32_t sample, placed_face;
  RootTwin root;  // with its depth, mm
};

struct AuditResult {
  bool has_closed_solid = false;
  std::uint64_t crossings = 0;
  std::vector<std::uint32_t> odd_samples;  // row·width + column, ascending
  std::vector<std::uint32_t> mismatched_samples;
  // All crossings of those samples, by sample and depth, as seen from the front and from behind.
  std::vector<AuditHit> forward, backward;
};

// `view` is the forward view, prepared for `frame`. Errors: those of PrepareView.
Result<AuditResult> Audit(const Scene::Data& scene, const PreparedView& view, const Camera& camera,
                          const CameraFrame& frame, TileKernel kernel, const DirectOptions& options);

}  // namespace facetless
