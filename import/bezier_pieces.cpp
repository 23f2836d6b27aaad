#include "import/bezier_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace facetless {
namespace {

// Parameters whose relative difference is smaller than this are equal: they differ by the rounding of a few
// operations.
constexpr double kParameterRounding = 32 * std::numeric_limits<double>::epsilon();

// A polynomial piece keeps weights of exactly 1, whatever rounding affine combinations have.
bool AllWeightsOne(std::span<const Vec4> points) {
  return std::all_of(points.begin(), points.end(), [](const Vec4& p) { return p.w == 1; });
}

}  // namespace

std::vector<Vec4> BsplineSpanPoints(std::span<const double> knots, int degree, std::span<const Vec4> poles,
                                    int span, double a, double b) {
  std::vector<Vec4> points(degree + 1);
  std::vector<Vec4> work(degree + 1);
  const bool polynomial = AllWeightsOne(poles.subspan(span - degree, degree + 1));
  for (int j = 0; j <= degree; ++j) {
    // Evaluate the blossom with `degree − j` arguments equal to a and j equal to b, by de Boor's algorithm on
    // the span's own poles.
    for (int i = 0; i <= degree; ++i) work[i] = poles[span - degree + i];
    for (int round = 1; round <= degree; ++round) {
      const double x = round <= degree - j ? a : b;
      for (int i = degree; i >= round; --i) {
        const int knot = span - degree + i;
        const double alpha = (x - knots[knot]) / (knots[knot + degree - round + 1] - knots[knot]);
        work[i] = (1 - alpha) * work[i - 1] + alpha * work[i];
      }
    }
    points[j] = work[degree];
    if (polynomial) points[j].w = 1;
  }
  return points;
}

std::vector<KnotStretch> KnotStretches(std::span<const double> knots, int degree, double first, double last) {
  const int first_span = degree, last_span = static_cast<int>(knots.size()) - degree - 2;
  const double size = std::max(std::fabs(first), std::fabs(last));
  const double rounding = kParameterRounding * std::max(size, last - first);
  // Collect the spans that have a width and overlap the range by more than rounding. The outermost spans
  // extend to infinity.
  std::vector<int> spans;
  for (int k = first_span; k <= last_span; ++k) {
    if (knots[k] < knots[k + 1]) spans.push_back(k);
  }
  std::vector<KnotStretch> stretches;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const double low = i == 0 ? -INFINITY : knots[spans[i]];
    const double high = i + 1 == spans.size() ? INFINITY : knots[spans[i] + 1];
    const double begin = std::max(low, first), end = std::min(high, last);
    if (end - begin > rounding) stretches.push_back({spans[i], begin, end});
  }
  // Close the tiny gaps that skipping very narrow spans may have left.
  for (std::size_t i = 0; i + 1 < stretches.size(); ++i) stretches[i].end = stretches[i + 1].begin;
  if (!stretches.empty()) {
    stretches.front().begin = first;
    stretches.back().end = last;
  }
  return stretches;
}

std::vector<CurvePiece> BsplinePieces(std::span<const double> knots, int degree, std::span<const Vec4> poles,
                                      double first, double last) {
  std::vector<CurvePiece> pieces;
  for (const KnotStretch& stretch : KnotStretches(knots, degree, first, last)) {
    CurvePiece piece{stretch.begin, stretch.end, SpanMap::kLinear,
                     BsplineSpanPoints(knots, degree, poles, stretch.span, stretch.begin, stretch.end)};
    if (!pieces.empty()) piece.points.front() = pieces.back().points.back();
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

std::vector<CurvePiece> ArcPieces(Vec3 center, Vec3 x, Vec3 y, double first, double last, double max_width) {
  // Use as few equal arcs as possible. The tolerance keeps a quarter turn that rounding has made too wide a
  // single arc.
  const int count =
      std::max(1, static_cast<int>(std::ceil((last - first) / max_width * (1 - kParameterRounding))));
  const auto point = [&](double angle, double weight) {
    const double c = std::cos(angle), s = std::sin(angle);
    return Vec4{weight * center.x + c * x.x + s * y.x, weight * center.y + c * x.y + s * y.y,
                weight * center.z + c * x.z + s * y.z, weight};
  };
  std::vector<CurvePiece> pieces;
  double begin = first;
  for (int i = 0; i < count; ++i) {
    const double end = i + 1 == count ? last : first + (last - first) * (i + 1) / count;
    // The middle point of an arc of half-width h about m is (cos m, sin m)/cos h with weight cos h.
    const double middle = 0.5 * (begin + end), half = 0.5 * (end - begin);
    pieces.push_back(
        {begin, end, SpanMap::kHalfAngle, {point(begin, 1), point(middle, std::cos(half)), point(end, 1)}});
    begin = end;
  }
  return pieces;
}

void ElevateDegree(std::vector<CurvePiece>& pieces, int degree) {
  for (CurvePiece& piece : pieces) {
    const bool polynomial = AllWeightsOne(piece.points);
    while (piece.degree() < degree) {
      const int from = piece.degree();
      std::vector<Vec4> raised(from + 2);
      raised.front() = piece.points.front();
      raised.back() = piece.points.back();
      for (int i = 1; i <= from; ++i) {
        const double share = static_cast<double>(i) / (from + 1);
        raised[i] = share * piece.points[i - 1] + (1 - share) * piece.points[i];
        if (polynomial) raised[i].w = 1;
      }
      piece.points = std::move(raised);
    }
  }
}

Vec4 EvaluateBezier(std::span<const Vec4> points, double t) {
  std::vector<Vec4> work(points.begin(), points.end());
  for (std::size_t last = work.size() - 1; last > 0; --last) {
    for (std::size_t i = 0; i < last; ++i) work[i] = (1 - t) * work[i] + t * work[i + 1];
  }
  return work[0];
}

double PieceParameter(double begin, double end, SpanMap map, double native) {
  if (map == SpanMap::kLinear) return (native - begin) / (end - begin);
  const double middle = 0.5 * (begin + end), half = 0.5 * (end - begin);
  return 0.5 + 0.5 * std::tan(0.5 * (native - middle)) / std::tan(0.5 * half);
}

double NativeParameter(double begin, double end, SpanMap map, double t) {
  if (map == SpanMap::kLinear) return begin + t * (end - begin);
  const double middle = 0.5 * (begin + end), half = 0.5 * (end - begin);
  return middle + 2 * std::atan((2 * t - 1) * std::tan(0.5 * half));
}

}  // namespace facetless
