#include "render/solve/patch_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/parallel.h"
#include "render/solve/clip.h"

namespace facetless {
namespace {

constexpr std::size_t kCells = std::size_t{kCellsAlong} * kCellsAlong;
// Larger than the rounding of a number to single precision, and of the control points of a cell.
constexpr double kMargin = 0x1p-22;

// The numbers X, Y and W of a patch.
using Net = std::array<std::vector<double>, 3>;

void Cut(Net& net, const SolverPatch& patch, ClipAxis axis, int cell) {
  for (std::vector<double>& numbers : net)
    RestrictNumbers(numbers.data(), patch.degree_u, patch.degree_v, axis, double(cell) / kCellsAlong,
                    double(cell + 1) / kCellsAlong);
}

// The least and the greatest of the quotients, with a margin.
void Bound(const std::vector<double>& numerators, const std::vector<double>& denominators, float* low,
           float* high) {
  double least = INFINITY, greatest = -INFINITY;
  for (std::size_t k = 0; k < numerators.size(); ++k) {
    const double quotient = numerators[k] / denominators[k];
    if (!(denominators[k] > 0) || !std::isfinite(quotient)) {
      *low = -INFINITY;
      *high = INFINITY;
      return;
    }
    least = std::min(least, quotient);
    greatest = std::max(greatest, quotient);
  }
  const double margin = kMargin * std::max(std::fabs(least), std::fabs(greatest));
  *low = static_cast<float>(least - margin);
  *high = static_cast<float>(greatest + margin);
}

}  // namespace

Result<PatchCells> PatchCells::Make(const SolverScene& scene, std::uint64_t max_bytes,
                                    const Execution& execution) {
  const std::size_t patches = scene.patches().size();
  if (max_bytes != 0 && patches > max_bytes / (kCells * sizeof(Box)))
    return Error{ErrorCode::kLimitExceeded, ""};
  PatchCells cells;
  cells.boxes_.resize(patches * kCells);
  ParallelFor(std::size_t{0}, patches, [&](std::size_t patch) {
    if (!execution.cancelled()) cells.Fill(scene, static_cast<std::uint32_t>(patch));
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while preparing the method"};
  return cells;
}

void PatchCells::Fill(const SolverScene& scene, std::uint32_t index) {
  const SolverPatch& patch = scene.patches()[index];
  Net whole;
  for (int k = 0; k < patch.points(); ++k) {
    const ViewProjection::Point& p = scene.screen(patch)[k];
    whole[0].push_back(p.x);
    whole[1].push_back(p.y);
    whole[2].push_back(p.w);
  }
  Box* box = boxes_.data() + index * kCells;
  for (int i = 0; i < kCellsAlong; ++i) {
    Net strip = whole;
    Cut(strip, patch, ClipAxis::kU, i);
    for (int j = 0; j < kCellsAlong; ++j, ++box) {
      Net cell = strip;
      Cut(cell, patch, ClipAxis::kV, j);
      Bound(cell[0], cell[2], &box->x_low, &box->x_high);
      Bound(cell[1], cell[2], &box->y_low, &box->y_high);
    }
  }
}

CellBlock PatchCells::Around(std::uint32_t patch, double x, double y) const {
  CellBlock block;
  const Box* box = boxes_.data() + patch * kCells;
  for (int i = 0; i < kCellsAlong; ++i)
    for (int j = 0; j < kCellsAlong; ++j, ++box) {
      if (!(x >= box->x_low && x <= box->x_high && y >= box->y_low && y <= box->y_high)) continue;
      block.u_first = std::min(block.u_first, i);
      block.u_last = i;
      block.v_first = std::min(block.v_first, j);
      block.v_last = std::max(block.v_last, j);
    }
  return block;
}

}  // namespace facetless
