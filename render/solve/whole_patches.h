// The pieces of solvers that search whole patches.
//
//     Result<std::vector<SolverPiece>> pieces = WholePatches("bezier-clipping", scene, max_bytes, execution);
//
//  1. There is one piece for each patch of the scene, in the order of the patches. Its box holds the control points in
//     space, and so the surface, since weights are positive.
//  2. With SolverUnit::kFace, a piece names its face, and its rectangle is in parameters of the face.
#pragma once

#include <string_view>
#include <vector>

#include "render/solve/solver.h"

namespace facetless {

// `solver`: its name, for messages. `max_bytes`: 0 means no limit. Errors: kLimitExceeded (the pieces need more than
// `max_bytes`), kCancelled.
Result<std::vector<SolverPiece>> WholePatches(std::string_view solver, const SolverScene& scene,
                                              std::uint64_t max_bytes, const Execution& execution,
                                              SolverUnit unit = SolverUnit::kPatch);

// The error of a method whose preparation needs more than the limit.
Error PiecesTooLarge(std::string_view solver, std::uint64_t max_bytes);

}  // namespace facetless
