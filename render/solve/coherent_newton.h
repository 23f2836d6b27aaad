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
//     roots that it finds on the patch. The solver keeps the nearest of them for the next ray.
//  2. The next rays of the row start Newton's iteration at the kept root of the same patch. It solves f = X − x·W = 0 and
//     g = Y − y·W = 0 with Cramer's rule, until the point lies within tolerance_px of the ray, and then takes one more
//     step. Newton's method has failed if it needs more than kMostCoherentSteps steps, if an iterate is outside the patch
//     by more than the length of the patch, if the root is outside by more than kRootBorder, or if the Jacobian is
//     singular.
//  3. Newton's root must be the first one on the patch. The paper asks whether something obstructs it. The test used here
//     asks for more: no other point of the patch may lie on the ray. So a root behind the first one is not missed either,
//     which counts if the first one is trimmed away. First, the patch is cut down to the block of its cells whose boxes on
//     the screen hold the ray (render/solve/patch_cells.h). Then, let p be the differences of the net (f, g) of this block
//     along u, and q those along v. The test passes if Cross(p, q) has the same sign for all pairs. Then f and g are both
//     zero at one point of the block at most: the difference of their values at two points is a sum of such p, with
//     factors of one sign, plus a sum of such q, with factors of one sign, and the two sums are never parallel. Of the
//     vectors p, only the two outermost need be compared with every q. The test does not depend on Newton's root, and is
//     made first.
//  4. Bézier clipping answers where the test does not pass (near folds, and where one part of the patch hides another),
//     and where Newton's method has failed.
//  5. A ray that meets the box of no cell has no root.
//  6. The state of a thread has a root for each patch, with the stamp of the row in which it was found. BeginRow takes a new
//     stamp, so that its cost does not depend on the number of patches.
//
// What the method does not promise:
//
//  7. It has the weaknesses of Bézier clipping wherever that answers, which includes the first ray of each row that meets
//     a patch.
//  8. The test of law 3 does not bound its own rounding, and so it proves nothing.
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
  // How solves were answered: by the boxes of the cells; by clipping, because no ray of this row had found a root on the
  // patch; by Newton's method; by clipping, because a second root could not be excluded; and by clipping, because
  // Newton's method failed.
  std::uint64_t missed = 0, first = 0, by_newton = 0, obstructed = 0, failed = 0;
};

SolverInfo CoherentNewtonInfo();

// The test of law 3.
bool HasAtMostOneRoot(const RayNet& net);

}  // namespace facetless
