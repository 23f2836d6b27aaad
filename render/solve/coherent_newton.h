// Newton's method with the coherence of rays: S.-W. Wang, Z.-C. Shih, R.-C. Chang, "An efficient and stable ray tracing
// algorithm for parametric surfaces", Journal of Information Science and Engineering 18 (2002), pages 541–561 (first
// presented in 2001). Its name is coherent-newton.
//
//     const SolverInfo info = CoherentNewtonInfo();
//     Result<std::unique_ptr<const Solver>> solver = info.make(scene, 0, execution);
//     const auto state = solver.value()->MakeState();
//     solver.value()->BeginRow(row, *state);  // forgets the roots of earlier rows
//
// How it works:
//
//  1. The first root of a row on a patch is found by Bézier clipping (render/solve/bezier_clipping.h), which reports all
//     roots of the patch. The nearest to the eye is kept for the next ray.
//  2. The next rays of the row start Newton's iteration at the kept root of the same patch. It solves f = X − x·W = 0 and
//     g = Y − y·W = 0 with Cramer's rule, until the point lies within tolerance_px of the ray, and then takes one more step.
//     If it does not within kMostCoherentSteps steps, leaves the patch, or meets a singular Jacobian, it has failed.
//  3. Newton's root must be the first one on the patch. The paper asks whether something obstructs it. The test used here
//     shows that nothing else on the patch lies on the ray at all, so that a root behind it, which counts if the first one is
//     trimmed away, is not missed either. First, the patch is cut down to the block of its cells whose boxes on the screen
//     hold the ray (render/solve/patch_cells.h). Then, let p be the differences of the net (f, g) of this block along u, and
//     q those along v. If Cross(p, q) has the same sign for all pairs, f and g together are zero at one point of the block at
//     most, because the difference of the values at two points is a sum of such p and q with factors of one sign each, and
//     p and q are never parallel. Of each set only the two outermost vectors matter. The test does not depend on Newton's
//     root, and is made first.
//  4. Bézier clipping answers where the test does not pass (near folds, and where two parts of the patch are behind each other), or where Newton's
//     method has failed.
//  5. A ray that passes beside the boxes of all cells has no root.
//  6. The state of a thread has a root for each patch, with the stamp of the row in which it was found. BeginRow takes a new
//     stamp, so that it costs the same for any number of patches.
//
// What the method does not promise:
//
//  7. It has the weaknesses of Bézier clipping wherever that answers, among them the first root of each row.
//  8. The test of law 3 is not rounded with bounds, and nothing is proven.
//  9. The root of a ray depends on its neighbours on the left, within the tolerance.
#pragma once

#include <cstdint>
#include <vector>

#include "render/solve/bezier_clipping.h"
#include "render/solve/solver.h"

namespace facetless {

inline constexpr int kMostCoherentSteps = 8;

struct CoherentNewtonState final : ClipState {
  CoherentNewtonState(int most_points, std::size_t patches) : ClipState(most_points), kept(patches) {}

  struct Kept {
    std::uint64_t row = 0;  // the stamp of the row in which it was found
    double u = 0, v = 0;
  };
  std::vector<Kept> kept;  // of each patch
  std::uint64_t row = 1;   // the stamp of the present row
  // How solves were answered: by the boxes of the cells; without a root of a neighbour; by Newton's method; by clipping because a second root could
  // not be excluded, and because Newton's method failed.
  std::uint64_t missed = 0, first = 0, by_newton = 0, obstructed = 0, failed = 0;
};

SolverInfo CoherentNewtonInfo();

// The test of law 3.
bool HasAtMostOneRoot(const RayNet& net);

}  // namespace facetless
