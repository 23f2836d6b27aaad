// All lines of a view: edges, silhouettes and outlines of cuts, each marked as visible or hidden.
#pragma once

#include <vector>

#include "render/base/execution.h"
#include "render/lines/line.h"
#include "render/trace/direct.h"

namespace facetless {

struct LineOptions {
  double edge_angle_deg = 20;          // an edge with a larger angle is a feature
  std::vector<SectionPlane> sections;  // the sections with which the samples were traced
  Execution execution;                 // if cancelled, the call returns incomplete lines
};

// Finds the lines of a view. `samples` and `sample_frame` belong to the same view, or to a Supersampled
// camera of it. Lines are cut slightly outside the picture. Their order depends only on the model and the
// view.
std::vector<ViewLine> FindLines(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                                const SampleBuffer& samples, const CameraFrame& sample_frame,
                                const LineOptions& options);

}  // namespace facetless
