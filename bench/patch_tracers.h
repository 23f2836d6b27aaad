// Two ways to intersect a ray with rational patches by Newton's iteration. All other parts are the same: the
// flattening, the tree, the order of visits, the evaluation of patches, the tolerance and the stopping rules.
//
//  1. W. Martin et al. (2000): the ray is the intersection of two planes with unit normals N1, N2. The
//     iteration finds the zero of the distances N·S(u,v) + d. S and its derivatives are in R³, by the
//     quotient rule. Boxes are in space.
//  2. A. Sisojevs (2011), eq. 10 to 13: patches are projected once per view. An iteration is the step
//     w/M·(M_U, M_V) of Cramer's rule on the homogeneous projection (x*, y*, w). Boxes are on the screen,
//     with a depth.
//  3. An iteration starts in the middle of a piece. It ends with a root if the residual is below the
//     tolerance. It fails if the residual grows, if (u,v) leaves the patch by more than the patch's own
//     length, if a root lies outside the patch, or after kMostSteps steps. At a singular Jacobian, (u,v)
//     moves by a tenth of a random fraction of the way back to the start, as Martin et al. do. A failure
//     counts as a miss: both methods may lose hits, and Differences counts them.
//  4. Only orthographic views are supported. There is one ray through each pixel centre, on one thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/patch_scene.h"
#include "bench/patch_tree.h"
#include "render/view/camera.h"

namespace facetless {

// The iteration ends if the residual is below this many pixels. The root is then far more accurate than any
// picture shows.
inline constexpr double kSceneTolerancePx = 1e-8;
inline constexpr int kMostSteps = 7;

struct PatchImage {
  std::vector<double> depth;  // infinite for a miss
  double prepare_ms = 0, trace_ms = 0;
  std::uint64_t box_tests = 0, solves = 0, iterations = 0, roots = 0, hits = 0;
  std::size_t bytes = 0;  // memory that tracing needs
};

PatchImage TraceMartin(const std::vector<ScenePatch>& patches, const CameraFrame& frame, int width,
                       int height);
PatchImage TraceNewtonCramer(const std::vector<ScenePatch>& patches, const CameraFrame& frame, int width,
                             int height);

// Counts the differences between two depth images.
struct DepthDifferences {
  std::uint64_t both_hit = 0, only_first = 0, only_second = 0,
                // apart: both rays hit, but the depths differ by more than the tolerance.
      apart = 0;
  double largest_mm = 0;  // largest difference among rays that are not apart
};
DepthDifferences CompareDepths(std::span<const double> first, std::span<const double> second,
                               double tolerance_mm);

}  // namespace facetless
