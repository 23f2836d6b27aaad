#include "import/approximate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace facetless {
namespace {

constexpr int kDegree = kApproximationDegree;
constexpr int kCount = kDegree + 1;
// A stretch of a grid is halved at most this often. After 10 halvings, a stretch that is not accurate enough
// is not smooth.
constexpr int kMaxDepth = 10;
// A grid has at most this many stretches per direction. It is a fallback for single faces, not for whole
// models.
constexpr std::size_t kMaxStretches = 128;

struct Interpolation {
  std::array<double, kCount> nodes;  // in [0, 1], including both ends
  // Maps values at the nodes to Bernstein coefficients.
  std::array<std::array<double, kCount>, kCount> inverse;
};

double Bernstein(int i, double t) {
  double value = 1;
  for (int k = 1; k <= i; ++k) value *= t * (kDegree - i + k) / k;
  for (int k = 0; k < kDegree - i; ++k) value *= 1 - t;
  return value;
}

Interpolation MakeInterpolation() {
  Interpolation result;
  // These are Chebyshev points of the second kind, so that neighbouring pieces share their end node.
  for (int i = 0; i < kCount; ++i) result.nodes[i] = 0.5 - 0.5 * std::cos(std::numbers::pi * i / kDegree);
  result.nodes[0] = 0;
  result.nodes[kDegree] = 1;
  // Invert the collocation matrix by Gauss-Jordan elimination with row pivots.
  std::array<std::array<double, 2 * kCount>, kCount> rows{};
  for (int r = 0; r < kCount; ++r) {
    for (int c = 0; c < kCount; ++c) rows[r][c] = Bernstein(c, result.nodes[r]);
    rows[r][kCount + r] = 1;
  }
  for (int c = 0; c < kCount; ++c) {
    int pivot = c;
    for (int r = c + 1; r < kCount; ++r) {
      if (std::fabs(rows[r][c]) > std::fabs(rows[pivot][c])) pivot = r;
    }
    std::swap(rows[c], rows[pivot]);
    const double scale = 1 / rows[c][c];
    for (double& value : rows[c]) value *= scale;
    for (int r = 0; r < kCount; ++r) {
      if (r == c) continue;
      const double factor = rows[r][c];
      for (int k = 0; k < 2 * kCount; ++k) rows[r][k] -= factor * rows[c][k];
    }
  }
  for (int r = 0; r < kCount; ++r) {
    for (int c = 0; c < kCount; ++c) result.inverse[r][c] = rows[r][kCount + c];
  }
  return result;
}

const Interpolation& TheInterpolation() {
  static const Interpolation interpolation = MakeInterpolation();
  return interpolation;
}

// The interpolation error is largest between the nodes, so it is measured there.
double CheckNode(int i) {
  return 0.5 * (TheInterpolation().nodes[i] + TheInterpolation().nodes[i + 1]);
}

Vec4 Lifted(Vec3 p) {
  return {p.x, p.y, p.z, 1};
}

void AppendCurve(const std::function<Vec3(double)>& curve, double begin, double end, double tolerance,
                 int halvings, std::vector<CurvePiece>& pieces, double& deviation) {
  const Interpolation& interpolation = TheInterpolation();
  // Interpolate.
  CurvePiece piece{begin, end, SpanMap::kLinear, std::vector<Vec4>(kCount)};
  std::array<Vec3, kCount> values;
  for (int i = 0; i < kCount; ++i)
    values[i] = curve(i == kDegree ? end : begin + (end - begin) * interpolation.nodes[i]);
  for (int i = 0; i < kCount; ++i) {
    Vec3 sum;
    for (int k = 0; k < kCount; ++k) sum = sum + interpolation.inverse[i][k] * values[k];
    piece.points[i] = Lifted(sum);
  }
  piece.points.front() = Lifted(values.front());
  piece.points.back() = Lifted(values.back());
  // Measure between the nodes, and halve pieces that are not accurate enough.
  double worst = 0;
  for (int i = 0; i < kDegree; ++i) {
    const double t = CheckNode(i);
    worst = std::fmax(worst,
                      Length(Cartesian(EvaluateBezier(piece.points, t)) - curve(begin + (end - begin) * t)));
  }
  const double middle = 0.5 * (begin + end);
  if (!(worst <= tolerance) && halvings > 0 && begin < middle && middle < end) {
    AppendCurve(curve, begin, middle, tolerance, halvings - 1, pieces, deviation);
    AppendCurve(curve, middle, end, tolerance, halvings - 1, pieces, deviation);
    return;
  }
  if (!pieces.empty()) piece.points.front() = pieces.back().points.back();
  deviation = std::fmax(deviation, worst);
  pieces.push_back(std::move(piece));
}

// Interpolates the patch over one cell. Index k counts points along u, l along v.
std::array<Vec4, kCount * kCount> InterpolatePatch(const std::function<Vec3(double, double)>& surface,
                                                   double u0, double u1, double v0, double v1) {
  const Interpolation& interpolation = TheInterpolation();
  std::array<Vec3, kCount * kCount> values, half;
  for (int i = 0; i < kCount; ++i) {
    const double u = i == kDegree ? u1 : u0 + (u1 - u0) * interpolation.nodes[i];
    for (int j = 0; j < kCount; ++j) {
      values[i * kCount + j] = surface(u, j == kDegree ? v1 : v0 + (v1 - v0) * interpolation.nodes[j]);
    }
  }
  // Apply the one-dimensional inverse along u, then along v. The end nodes are kept bit by bit, so that
  // neighbouring patches share their border.
  for (int i = 0; i < kCount; ++i) {
    for (int j = 0; j < kCount; ++j) {
      Vec3 sum;
      for (int k = 0; k < kCount; ++k) sum = sum + interpolation.inverse[i][k] * values[k * kCount + j];
      half[i * kCount + j] = i == 0 || i == kDegree ? values[i * kCount + j] : sum;
    }
  }
  std::array<Vec4, kCount * kCount> points;
  for (int i = 0; i < kCount; ++i) {
    for (int j = 0; j < kCount; ++j) {
      Vec3 sum;
      for (int k = 0; k < kCount; ++k) sum = sum + interpolation.inverse[j][k] * half[i * kCount + k];
      points[i * kCount + j] = Lifted(j == 0 || j == kDegree ? half[i * kCount + j] : sum);
    }
  }
  return points;
}

// Returns the largest distance of the patch to the surface along its middle lines in u (check_u) or in v.
double PatchDeviation(const std::function<Vec3(double, double)>& surface,
                      const std::array<Vec4, kCount * kCount>& points, double u0, double u1, double v0,
                      double v1, bool check_u) {
  double worst = 0;
  for (int a = 0; a < kDegree; ++a) {
    for (int b = 0; b < kCount; ++b) {
      const double moving = CheckNode(a), fixed = TheInterpolation().nodes[b];
      const double s = check_u ? moving : fixed, t = check_u ? fixed : moving;
      std::array<Vec4, kCount> column;
      for (int k = 0; k < kCount; ++k) column[k] = EvaluateBezier({&points[k * kCount], kCount}, t);
      const Vec3 there = surface(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
      worst = std::fmax(worst, Length(Cartesian(EvaluateBezier(column, s)) - there));
    }
  }
  return worst;
}

std::vector<double> Refined(const std::vector<double>& breaks, const std::vector<bool>& cut) {
  std::vector<double> out{breaks.front()};
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    if (cut[i]) out.push_back(0.5 * (breaks[i] + breaks[i + 1]));
    out.push_back(breaks[i + 1]);
  }
  return out;
}

}  // namespace

std::vector<CurvePiece> ApproximateCurve(const std::function<Vec3(double)>& curve,
                                         const std::vector<double>& breaks, double tolerance, int max_depth,
                                         double* deviation) {
  std::vector<CurvePiece> pieces;
  *deviation = 0;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    AppendCurve(curve, breaks[i], breaks[i + 1], tolerance, max_depth, pieces, *deviation);
  return pieces;
}

ApproximateGrid ApproximateSurface(const std::function<Vec3(double, double)>& surface,
                                   std::vector<double> u_breaks, std::vector<double> v_breaks,
                                   double tolerance) {
  for (int depth = 0;; ++depth) {
    // Interpolate every cell, and note which rows and columns are not accurate enough.
    ApproximateGrid grid{u_breaks, v_breaks, {}, 0};
    std::vector<bool> cut_u(u_breaks.size() - 1), cut_v(v_breaks.size() - 1);
    bool cut = false;
    for (std::size_t i = 0; i + 1 < u_breaks.size(); ++i) {
      for (std::size_t j = 0; j + 1 < v_breaks.size(); ++j) {
        const auto points =
            InterpolatePatch(surface, u_breaks[i], u_breaks[i + 1], v_breaks[j], v_breaks[j + 1]);
        const double along_u =
            PatchDeviation(surface, points, u_breaks[i], u_breaks[i + 1], v_breaks[j], v_breaks[j + 1], true);
        const double along_v = PatchDeviation(surface, points, u_breaks[i], u_breaks[i + 1], v_breaks[j],
                                              v_breaks[j + 1], false);
        if (!(along_u <= tolerance)) cut_u[i] = cut = true;
        if (!(along_v <= tolerance)) cut_v[j] = cut = true;
        grid.deviation = std::fmax(grid.deviation, std::fmax(along_u, along_v));
        grid.points.insert(grid.points.end(), points.begin(), points.end());
      }
    }
    // Stop when the grid is accurate enough, or when refining would give too many stretches.
    std::vector<double> next_u = Refined(u_breaks, cut_u), next_v = Refined(v_breaks, cut_v);
    if (!cut || depth == kMaxDepth || next_u.size() > kMaxStretches + 1 || next_v.size() > kMaxStretches + 1)
      return grid;
    u_breaks = std::move(next_u);
    v_breaks = std::move(next_v);
  }
}

}  // namespace facetless
