// The flattening of W. Martin, E. Cohen, R. Fish and P. Shirley, "Practical Ray Tracing of Trimmed NURBS Surfaces"
// (2000), section 3: surfaces are divided into pieces that are nearly flat, so that Newton's iteration converges from
// the middle of a piece.
//
//     Result<std::vector<SolverPiece>> pieces = FlattenedPieces(scene, SolverUnit::kFace, max_bytes, execution);
//
//  1. A patch is divided along u, and along v, into n = C·max|c''| / sqrt(avg|c'|) equal pieces, where n is the maximum
//     over the rows of its control net. This bounds the curvature times the arc length to the power 3/2. The paper's C is
//     a constant, and so n depends on the unit of length. Here, C is kFlattening divided by the square root of the
//     diagonal of the face, so that n depends neither on the unit, nor on the view, nor on the rest of the scene.
//  2. Each piece has the box of the control points of that part of its patch. The box holds the surface because weights
//     are positive. It is enlarged by a bound on the rounding of the subdivision.
//  3. The pieces of a patch cover it, in the order of the scene's patches. No patch has more than kMostPieces pieces
//     along u or along v, however its control points lie.
//  4. Nothing is promised about the iteration: a piece may hold several roots, or none that the iteration finds.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/solve/solver.h"
#include "render/solve/solver_scene.h"

namespace facetless {

// The paper's constant C for a face with a diagonal of 1. Newton's iteration needs two or three steps on such pieces, as
// in the paper.
inline constexpr double kFlattening = 8;
inline constexpr int kMostPieces = 64;

// The pieces of all patches. With SolverUnit::kFace, a piece names its face, and its rectangle is in parameters of the
// face. `max_bytes`: 0 means no limit. Errors: kLimitExceeded (the pieces need more than `max_bytes`), kCancelled.
Result<std::vector<SolverPiece>> FlattenedPieces(const SolverScene& scene, SolverUnit unit,
                                                 std::uint64_t max_bytes, const Execution& execution);

}  // namespace facetless
