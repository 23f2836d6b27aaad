// All lines of a view: edges, silhouettes and the outlines of cuts, with what hides them.
#pragma once

#include <vector>

#include "render/base/execution.h"
#include "render/lines/line.h"
#include "render/trace/direct.h"

namespace facetless {

struct LineOptions {
  double edge_angle_deg = 20;          // above it an edge is a feature
  std::vector<SectionPlane> sections;  // as the samples were traced with
  Execution execution;                 // cancelled, the call ends with whatever there is
};

// `samples`: of the same view, or of Supersampled of it, with their frame. Lines end a little beside the
// picture, and come in an order that depends on nothing but model and view.
std::vector<ViewLine> FindLines(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                                const SampleBuffer& samples, const CameraFrame& sample_frame,
                                const LineOptions& options);

}  // namespace facetless
