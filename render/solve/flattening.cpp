#include "render/solve/flattening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "render/base/parallel.h"

namespace facetless {
namespace {

using Row = std::array<Vec4, kMaxDegree + 1>;

Vec3 Euclidean(const Vec4& p) {
  return {p.x / p.w, p.y / p.w, p.z / p.w};
}

// Calls visit(row, count) with the Euclidean control points of each row along u (or v).
template <typename Visit>
void VisitRows(const SolverPatch& patch, const Vec4* points, bool along_u, const Visit& visit) {
  const int points_u = patch.degree_u + 1, points_v = patch.degree_v + 1;
  const int rows = along_u ? points_v : points_u, columns = along_u ? points_u : points_v;
  std::array<Vec3, kMaxDegree + 1> row;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c)
      row[static_cast<std::size_t>(c)] = Euclidean(points[along_u ? c * points_v + r : r * points_v + c]);
    visit(row, static_cast<std::size_t>(columns));
  }
}

// Returns the number of pieces along u (or v): the maximum over all rows, at least one.
int PiecesAlong(const SolverPatch& patch, const Vec4* points, bool along_u, double flattening) {
  double most = 1;
  VisitRows(patch, points, along_u, [&](const auto& row, std::size_t count) {
    const double degree = static_cast<double>(count - 1);
    double speed = 0, bend = 0;
    for (std::size_t i = 0; i + 1 < count; ++i) speed += Length(row[i + 1] - row[i]);
    for (std::size_t i = 0; i + 2 < count; ++i)
      bend = std::max(bend, degree * (degree - 1) * Length(row[i + 2] - row[i + 1] - (row[i + 1] - row[i])));
    // degree · (mean of the differences) is the mean of |c'| over the control polygon. A row that is a single point
    // requires no pieces.
    if (speed > 0) most = std::fmax(most, flattening * bend / std::sqrt(speed));
  });
  return static_cast<int>(std::ceil(std::min<double>(most, kMostPieces)));
}

// Replaces a curve's control points by those over [low, high], by de Casteljau's algorithm at both ends.
void Restrict(Row& curve, int degree, double low, double high) {
  const auto n = static_cast<std::size_t>(degree) + 1;
  const auto mix = [](const Vec4& a, const Vec4& b, double t) { return (1 - t) * a + t * b; };
  // Keep the part [0, high], …
  for (std::size_t d = 1; d < n; ++d)
    for (std::size_t i = n - 1; i >= d; --i) curve[i] = mix(curve[i - 1], curve[i], high);
  // … and of this part, keep [low / high, 1].
  const double t = low / high;
  for (std::size_t d = 1; d < n; ++d)
    for (std::size_t i = 0; i + d < n; ++i) curve[i] = mix(curve[i], curve[i + 1], t);
}

// Appends the pieces of one patch to `out`, which holds columns · rows of them, in parameters of the patch.
void FillPieces(const SolverPatch& patch, const Vec4* points, int columns, int rows, SolverPiece* out) {
  const int points_u = patch.degree_u + 1, points_v = patch.degree_v + 1;
  double size = 0;
  for (int k = 0; k < patch.points(); ++k) {
    const Vec3 p = Euclidean(points[k]);
    size = std::max({size, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  }
  // Each of the four passes of a subdivision rounds once for each degree, relative to the largest coordinate, because
  // it forms convex combinations; and weights are positive, so that the division keeps that relation.
  const double slack = 0x1p-52 * (8 * (patch.degree_u + patch.degree_v) + 8) * size;
  std::array<Row, kMaxDegree + 1> strip;
  for (int i = 0; i < columns; ++i) {
    const double u_low = double(i) / columns, u_high = double(i + 1) / columns;
    for (int l = 0; l < points_v; ++l) {
      Row line;
      for (int k = 0; k < points_u; ++k) line[static_cast<std::size_t>(k)] = points[k * points_v + l];
      Restrict(line, patch.degree_u, u_low, u_high);
      for (int k = 0; k < points_u; ++k)
        strip[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)] = line[static_cast<std::size_t>(k)];
    }
    for (int j = 0; j < rows; ++j, ++out) {
      *out = {0, u_low, u_high, double(j) / rows, double(j + 1) / rows, {}};
      for (int k = 0; k < points_u; ++k) {
        Row line = strip[static_cast<std::size_t>(k)];
        Restrict(line, patch.degree_v, out->v_low, out->v_high);
        for (int l = 0; l < points_v; ++l) out->box.Add(Euclidean(line[static_cast<std::size_t>(l)]));
      }
      out->box.low = out->box.low - Vec3{slack, slack, slack};
      out->box.high = out->box.high + Vec3{slack, slack, slack};
    }
  }
}

struct PatchGrid {
  int columns = 1, rows = 1;
  std::uint64_t first = 0;  // index of its first piece
};

// Makes the pieces of all patches, divided as `grids` says.
Result<std::vector<SolverPiece>> MakePieces(const SolverScene& scene, SolverUnit unit,
                                            std::vector<PatchGrid>& grids, std::uint64_t max_bytes,
                                            const Execution& execution) {
  std::uint64_t count = 0;
  for (PatchGrid& grid : grids) {
    grid.first = count;
    count += static_cast<std::uint64_t>(grid.columns) * static_cast<std::uint64_t>(grid.rows);
  }
  if (max_bytes > 0 && count > max_bytes / sizeof(SolverPiece))
    return Error{ErrorCode::kLimitExceeded, "The surfaces of the view need " + std::to_string(count) +
                                                " pieces, which take more than the " +
                                                std::to_string(max_bytes >> 20) +
                                                " MB that are left; raise the memory limit"};
  std::vector<SolverPiece> pieces(count);
  ParallelFor(std::size_t{0}, grids.size(), [&](std::size_t index) {
    if (execution.cancelled()) return;
    const SolverPatch& patch = scene.patches()[index];
    const PatchGrid& grid = grids[index];
    SolverPiece* const first = pieces.data() + grid.first;
    FillPieces(patch, scene.space(patch), grid.columns, grid.rows, first);
    for (SolverPiece* piece = first; piece != first + grid.columns * grid.rows; ++piece) {
      piece->surface = unit == SolverUnit::kFace ? patch.face : static_cast<std::uint32_t>(index);
      if (unit != SolverUnit::kFace) continue;
      piece->u_low += patch.i, piece->u_high += patch.i;
      piece->v_low += patch.j, piece->v_high += patch.j;
    }
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  return pieces;
}

}  // namespace

Result<std::vector<SolverPiece>> FlattenedPieces(const SolverScene& scene, SolverUnit unit,
                                                 std::uint64_t max_bytes, const Execution& execution) {
  std::vector<Box3> boxes(scene.faces().size());
  for (const SolverPatch& patch : scene.patches())
    for (int k = 0; k < patch.points(); ++k) boxes[patch.face].Add(Euclidean(scene.space(patch)[k]));
  std::vector<PatchGrid> grids(scene.patches().size());
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const SolverPatch& patch = scene.patches()[i];
    const double diagonal = boxes[patch.face].diagonal();
    if (!(diagonal > 0)) continue;
    const double flattening = kFlattening / std::sqrt(diagonal);
    grids[i].columns = PiecesAlong(patch, scene.space(patch), true, flattening);
    grids[i].rows = PiecesAlong(patch, scene.space(patch), false, flattening);
  }
  return MakePieces(scene, unit, grids, max_bytes, execution);
}

}  // namespace facetless
