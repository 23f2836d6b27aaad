// Two ways to intersect a ray with rational patches by Newton's iteration, with everything else alike: the
// flattening, the tree, the order of visits, the evaluation of patches, the tolerance and the rules for
// stopping.
//
//  1. W. Martin et al. (2000): the ray is the intersection of two planes with unit normals N1, N2; the
//     iteration drives the distances N·S(u,v) + d to zero, with S and its derivatives in R³ by the quotient
//     rule. Boxes are boxes in space.
//  2. A. Sisojevs (2011), eq. 10 to 13: patches are projected once for the view; the iteration is the step
//     w/M·(M_U, M_V) of Cramer's rule on the homogeneous projection (x*, y*, w). Boxes are boxes on the
//     screen, with a depth.
//  3. An iteration starts in the middle of a piece, and ends: at a root, when the residual is below the
//     tolerance; at a failure, when the residual grows, (u,v) strays from the patch by its length, a root
//     lies outside the patch, or after kMostSteps. A singular Jacobian moves (u,v) by a tenth of a random
//     part of the way back to the start, as Martin et al. do. What fails counts as a miss: both methods may
//     lose hits, and Differences counts them.
//  4. Orthographic views only. One ray through each pixel centre, on one thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/patch_scene.h"
#include "bench/patch_tree.h"
#include "render/view/camera.h"

namespace facetless {

// A residual that ends the iteration, in pixels: what both solve for is then known to far less than any
// picture shows.
inline constexpr double kSceneTolerancePx = 1e-8;
inline constexpr int kMostSteps = 7;

struct PatchImage {
  std::vector<double> depth;  // infinite for a miss
  double prepare_ms = 0, trace_ms = 0;
  std::uint64_t box_tests = 0, solves = 0, iterations = 0, roots = 0, hits = 0;
  std::size_t bytes = 0;  // of what tracing holds
};

PatchImage TraceMartin(const std::vector<ScenePatch>& patches, const CameraFrame& frame, int width,
                       int height);
PatchImage TraceNewtonCramer(const std::vector<ScenePatch>& patches, const CameraFrame& frame, int width,
                             int height);

// How two depth images differ.
struct DepthDifferences {
  std::uint64_t both_hit = 0, only_first = 0, only_second = 0,
                apart = 0;  // apart: both hit, farther than the tolerance
  double largest_mm = 0;    // of those that are not apart
};
DepthDifferences CompareDepths(std::span<const double> first, std::span<const double> second,
                               double tolerance_mm);

}  // namespace facetless
