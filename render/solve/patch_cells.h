// PatchCells: where the parts of a patch lie on the screen. Each patch is divided evenly into kCellsAlong × kCellsAlong cells,
// and each cell has a box in pixels that holds it.
//
//     Result<PatchCells> cells = PatchCells::Make(scene, max_bytes, execution);
//     const CellBlock block = cells.value().Around(patch, ray.x, ray.y);
//     if (!block.empty()) Search(block.u_low(), block.u_high(), block.v_low(), block.v_high());
//
//  1. Around(patch, x, y) is the smallest block of cells that holds all cells whose boxes hold the pixel coordinates
//     (x, y). All points of the patch on the ray through (x, y) lie in it. The boxes are numbers of single precision. They
//     are enlarged by a margin that is larger than their rounding, and much larger than that of the control points of a
//     cell.
//  2. The box of a cell is infinite if a control point of the cell is not in front of the eye.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/solve/solver_scene.h"

namespace facetless {

inline constexpr int kCellsAlong = 8;

// Cells [u_first, u_last] × [v_first, v_last].
struct CellBlock {
  int u_first = kCellsAlong, u_last = -1, v_first = kCellsAlong, v_last = -1;
  bool empty() const { return u_last < u_first; }
  double u_low() const { return double(u_first) / kCellsAlong; }
  double u_high() const { return double(u_last + 1) / kCellsAlong; }
  double v_low() const { return double(v_first) / kCellsAlong; }
  double v_high() const { return double(v_last + 1) / kCellsAlong; }
};

class PatchCells {
 public:
  // `max_bytes`: 0 means no limit. Errors: kLimitExceeded, without a message, kCancelled.
  static Result<PatchCells> Make(const SolverScene& scene, std::uint64_t max_bytes,
                                 const Execution& execution);

  CellBlock Around(std::uint32_t patch, double x, double y) const;
  std::uint64_t bytes() const { return boxes_.size() * sizeof(Box); }

 private:
  struct Box {
    float x_low, x_high, y_low, y_high;
  };
  void Fill(const SolverScene& scene, std::uint32_t patch);

  std::vector<Box> boxes_;  // kCellsAlong² for each patch, v fastest
};

}  // namespace facetless
