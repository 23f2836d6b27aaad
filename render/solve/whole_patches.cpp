#include "render/solve/whole_patches.h"

#include <string>

namespace facetless {

Error PiecesTooLarge(std::string_view solver, std::uint64_t max_bytes) {
  return {ErrorCode::kLimitExceeded, "the method " + std::string(solver) + " needs more than " +
                                         std::to_string(max_bytes >> 20) + " MB for its pieces"};
}

Result<std::vector<SolverPiece>> WholePatches(std::string_view solver, const SolverScene& scene,
                                              std::uint64_t max_bytes, const Execution& execution,
                                              SolverUnit unit) {
  if (max_bytes != 0 && scene.patches().size() > max_bytes / sizeof(SolverPiece))
    return PiecesTooLarge(solver, max_bytes);
  std::vector<SolverPiece> pieces(scene.patches().size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while preparing the method"};
    const SolverPatch& patch = scene.patches()[i];
    if (unit == SolverUnit::kFace)
      pieces[i] = {patch.face, double(patch.i), patch.i + 1.0, double(patch.j), patch.j + 1.0, {}};
    else
      pieces[i].surface = static_cast<std::uint32_t>(i);
    const Vec4* points = scene.space(patch);
    for (int k = 0; k < patch.points(); ++k)
      pieces[i].box.Add({points[k].x / points[k].w, points[k].y / points[k].w, points[k].z / points[k].w});
  }
  return pieces;
}

}  // namespace facetless
