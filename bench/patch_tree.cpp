#include "bench/patch_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace facetless {
namespace {

using Point = std::array<double, 4>;

Vec3 Euclidean(const Point& p) {
  return {p[0] / p[3], p[1] / p[3], p[2] / p[3]};
}

// Returns the number of pieces that a row of control points requires.
double PiecesOf(const std::vector<Vec3>& row, double flattening) {
  const double degree = static_cast<double>(row.size() - 1);
  double speed = 0, bend = 0;
  for (std::size_t i = 0; i + 1 < row.size(); ++i) speed += Length(row[i + 1] - row[i]);
  for (std::size_t i = 0; i + 2 < row.size(); ++i)
    bend = std::max(bend, degree * (degree - 1) * Length(row[i + 2] - row[i + 1] - (row[i + 1] - row[i])));
  // degree · (mean of the differences) is the mean of |c'| over the control polygon. A row that is a single
  // point requires no pieces.
  return speed > 0 ? flattening * bend / std::sqrt(speed) : 0;
}

// Returns the number of pieces along u (or v): the maximum over all rows, at least one.
int PiecesAlong(const ScenePatch& patch, bool along_u, double flattening) {
  const std::size_t points_v = static_cast<std::size_t>(patch.degree_v) + 1,
                    points_u = static_cast<std::size_t>(patch.degree_u) + 1;
  const std::size_t rows = along_u ? points_v : points_u, columns = along_u ? points_u : points_v;
  double most = 1;
  for (std::size_t r = 0; r < rows; ++r) {
    std::vector<Vec3> row(columns);
    for (std::size_t c = 0; c < columns; ++c)
      row[c] = Euclidean(patch.points[along_u ? c * points_v + r : r * points_v + c]);
    most = std::max(most, PiecesOf(row, flattening));
  }
  constexpr double kMostPieces = 256;
  return static_cast<int>(std::ceil(std::min(most, kMostPieces)));
}

// Replaces a curve's control points by those over [low, high], by de Casteljau's algorithm at both ends.
void Restrict(std::vector<Point>& curve, double low, double high) {
  const std::size_t n = curve.size();
  const auto mix = [](const Point& a, const Point& b, double t) {
    Point p;
    for (int c = 0; c < 4; ++c) p[c] = (1 - t) * a[c] + t * b[c];
    return p;
  };
  // Keep the part [0, high], …
  for (std::size_t d = 1; d < n; ++d)
    for (std::size_t i = n - 1; i >= d; --i) curve[i] = mix(curve[i - 1], curve[i], high);
  // … and of this part, keep [low / high, 1].
  const double t = low / high;
  for (std::size_t d = 1; d < n; ++d)
    for (std::size_t i = 0; i + d < n; ++i) curve[i] = mix(curve[i], curve[i + 1], t);
}

Box3 BoxOf(const ScenePatch& patch, const PatchPiece& piece) {
  const int rows = patch.degree_u + 1, columns = patch.degree_v + 1;
  std::vector<Point> net = patch.points;
  for (int k = 0; k < rows; ++k) {
    std::vector<Point> line(net.begin() + k * columns, net.begin() + (k + 1) * columns);
    Restrict(line, piece.v_low, piece.v_high);
    std::copy(line.begin(), line.end(), net.begin() + k * columns);
  }
  Box3 box;
  for (int l = 0; l < columns; ++l) {
    std::vector<Point> line(static_cast<std::size_t>(rows));
    for (int k = 0; k < rows; ++k) line[k] = net[k * columns + l];
    Restrict(line, piece.u_low, piece.u_high);
    for (const Point& p : line) box.Add(Euclidean(p));
  }
  // The slack, a few units in the last place of the coordinates, keeps what touches the box despite rounding.
  constexpr double kRounding = 0x1p-44;
  const double slack = kRounding * (Length(box.low) + Length(box.high));
  box.low = box.low - Vec3{slack, slack, slack};
  box.high = box.high + Vec3{slack, slack, slack};
  return box;
}

Box3 Joined(Box3 a, const Box3& b) {
  a.Add(b.low);
  a.Add(b.high);
  return a;
}

class Builder {
 public:
  Builder(const std::vector<ScenePatch>& patches, double flattening)
      : patches_(patches), flattening_(flattening) {}

  PatchTree Build() {
    for (std::uint32_t patch = 0; patch < patches_.size(); ++patch) Flatten(patch);
    std::vector<std::uint32_t> order(patches_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    if (!order.empty()) {
      tree_.nodes.emplace_back();
      JoinPatches(0, order.data(), order.data() + order.size());
    }
    return std::move(tree_);
  }

 private:
  struct Grid {
    std::uint32_t first;  // index of the first piece
    int columns, rows;    // numbers of pieces along u and v
    Box3 box;
  };

  void Flatten(std::uint32_t index) {
    const ScenePatch& patch = patches_[index];
    Grid grid{static_cast<std::uint32_t>(tree_.pieces.size()),
              PiecesAlong(patch, true, flattening_),
              PiecesAlong(patch, false, flattening_),
              {}};
    for (int i = 0; i < grid.columns; ++i)
      for (int j = 0; j < grid.rows; ++j) {
        PatchPiece piece{index,
                         static_cast<double>(i) / grid.columns,
                         static_cast<double>(i + 1) / grid.columns,
                         static_cast<double>(j) / grid.rows,
                         static_cast<double>(j + 1) / grid.rows,
                         {}};
        piece.box = BoxOf(patch, piece);
        grid.box = Joined(grid.box, piece.box);
        tree_.pieces.push_back(piece);
      }
    grids_.push_back(grid);
  }

  // Allocates the two children of node `at`, side by side.
  std::uint32_t Split(std::uint32_t at) {
    const auto first = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes[at].first = first;
    tree_.nodes.resize(tree_.nodes.size() + 2);
    return first;
  }

  void Close(std::uint32_t at) {
    const std::uint32_t first = tree_.nodes[at].first;
    tree_.nodes[at].box = Joined(tree_.nodes[first].box, tree_.nodes[first + 1].box);
  }

  void JoinPatches(std::uint32_t at, std::uint32_t* begin, std::uint32_t* end) {
    if (end - begin == 1) {
      const Grid& grid = grids_[*begin];
      JoinPieces(at, grid, 0, grid.columns, 0, grid.rows, true);
      return;
    }
    Box3 centers;
    for (const std::uint32_t* patch = begin; patch != end; ++patch) centers.Add(grids_[*patch].box.center());
    const Vec3 size = centers.high - centers.low;
    const auto along = [&](std::uint32_t patch) {
      const Vec3 center = grids_[patch].box.center();
      return size.x >= size.y && size.x >= size.z ? center.x : size.y >= size.z ? center.y : center.z;
    };
    std::uint32_t* middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end,
                     [&](std::uint32_t a, std::uint32_t b) { return along(a) < along(b); });
    const std::uint32_t first = Split(at);
    JoinPatches(first, begin, middle);
    JoinPatches(first + 1, middle, end);
    Close(at);
  }

  void JoinPieces(std::uint32_t at, const Grid& grid, int i0, int i1, int j0, int j1, bool along_u) {
    if (i1 - i0 == 1 && j1 - j0 == 1) {
      const std::uint32_t piece = grid.first + static_cast<std::uint32_t>(i0 * grid.rows + j0);
      tree_.nodes[at] = {tree_.pieces[piece].box, piece, true};
      return;
    }
    if (i1 - i0 == 1) along_u = false;
    if (j1 - j0 == 1) along_u = true;
    const std::uint32_t first = Split(at);
    if (along_u) {
      const int middle = (i0 + i1) / 2;
      JoinPieces(first, grid, i0, middle, j0, j1, false);
      JoinPieces(first + 1, grid, middle, i1, j0, j1, false);
    } else {
      const int middle = (j0 + j1) / 2;
      JoinPieces(first, grid, i0, i1, j0, middle, true);
      JoinPieces(first + 1, grid, i0, i1, middle, j1, true);
    }
    Close(at);
  }

  const std::vector<ScenePatch>& patches_;
  const double flattening_;
  PatchTree tree_;
  std::vector<Grid> grids_;
};

}  // namespace

PatchTree BuildPatchTree(const std::vector<ScenePatch>& patches, double flattening) {
  return Builder(patches, flattening).Build();
}

void ReplaceBoxes(PatchTree& tree, const std::vector<ScenePatch>& projected) {
  for (PatchPiece& piece : tree.pieces) piece.box = BoxOf(projected[piece.patch], piece);
  // Children come after their parents, so the boxes are computed from the end.
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    PatchTreeNode& node = tree.nodes[i];
    node.box = node.leaf ? tree.pieces[node.first].box
                         : Joined(tree.nodes[node.first].box, tree.nodes[node.first + 1].box);
  }
}

}  // namespace facetless
