// FaceTrim::FindLine: the line that divides a rectangle of parameters.
//
// A monotone piece of a p-curve lies in its box and in the strip around its chord (trim_pieces.h). Its part in the
// rectangle therefore lies in the intersection of the box, the strip and the rectangle, which is a convex polygon. All
// corners of these polygons, grown by the bands, lie within w of the line. No curve meets the rest of the rectangle on
// either side of the line, so one point decides for the whole side. If no curve meets the rectangle at all, a and b are 0,
// w is 0, and c is 1 if the rectangle belongs to the face, else −1.
#include <algorithm>
#include <cmath>

#include "render/nurbs/trim_index.h"

namespace facetless {
namespace {

// The largest numbers of pieces of p-curves whose boxes meet the rectangle, and whose polygons (below) are not empty.
constexpr int kMostBoxes = 32, kMostPieces = 8;
// A bound of the rounding of the corners of a polygon, relative to the rectangle; the corners are at most a few sizes
// of the rectangle away from it.
constexpr double kRounding = 0x1p-40;

// A convex polygon of a rectangle that half planes have cut at most three times.
struct Polygon {
  Vec2 corner[12];
  int count = 0;

  // Keeps the part with normal·p + offset >= 0.
  void Cut(Vec2 normal, double offset) {
    Polygon kept;
    for (int i = 0; i < count; ++i) {
      const Vec2 a = corner[i], b = corner[(i + 1) % count];
      const double at_a = Dot(normal, a) + offset, at_b = Dot(normal, b) + offset;
      if (at_a >= 0) kept.corner[kept.count++] = a;
      if ((at_a >= 0) != (at_b >= 0)) kept.corner[kept.count++] = a + (at_a / (at_a - at_b)) * (b - a);
    }
    *this = kept;
  }
};

}  // namespace

TrimLine FaceTrim::FindLine(double u0, double u1, double v0, double v1, double band_scale) const {
  const double half_u = 0.5 * (u1 - u0), half_v = 0.5 * (v1 - v0);
  if (!(half_u > 0 && half_v > 0 && half_u < INFINITY && half_v < INFINITY)) return {};
  std::uint32_t found[kMostBoxes];
  int count = 0;
  const Rect rect{u0, u1, v0, v1};
  if (!PiecesIn(rect, band_scale, kMostBoxes, found, &count)) return {};

  // The corners of the polygons that hold the curves, in s and t, and the half widths of the widest band there.
  const Vec2 middle{0.5 * (u0 + u1), 0.5 * (v0 + v1)};
  Vec2 corners[12 * kMostPieces];
  int corner_count = 0;
  Vec2 band{0, 0};
  int pieces = 0;
  for (int n = 0; n < count; ++n) {
    const TrimPiece& piece = pieces_.pieces[found[n]];
    const Vec2 error = pieces_.curves[found[n]].error;
    const Vec2 grow{band_scale * piece.band_u, band_scale * piece.band_v};
    const double left = std::max(std::min(piece.low.x, piece.high.x) - error.x, u0 - grow.x);
    const double right = std::min(std::max(piece.low.x, piece.high.x) + error.x, u1 + grow.x);
    const double low = std::max(piece.low.y - error.y, v0 - grow.y);
    const double high = std::min(piece.high.y + error.y, v1 + grow.y);
    if (!(left <= right && low <= high)) continue;
    Polygon polygon{{{left, low}, {right, low}, {right, high}, {left, high}}, 4};
    // cross(chord, p − low) within the strip, with the curve's own error.
    const Vec2 chord = piece.high - piece.low, across{-chord.y, chord.x};
    const double slack = std::fabs(chord.x) * error.y + std::fabs(chord.y) * error.x;
    const double base = -Dot(across, piece.low);
    polygon.Cut(across, base - piece.strip_low + slack);
    polygon.Cut({-across.x, -across.y}, piece.strip_high + slack - base);
    if (polygon.count == 0) continue;
    if (++pieces > kMostPieces) return {};
    for (int i = 0; i < polygon.count; ++i) {
      const Vec2 p = polygon.corner[i] - middle;
      corners[corner_count++] = {p.x / half_u, p.y / half_v};
    }
    band = {std::max(band.x, grow.x / half_u), std::max(band.y, grow.y / half_v)};
  }
  // Without a curve, any point decides for all of the rectangle.
  if (corner_count == 0) return {0, 0, OddExcept({u0, v0}, kNoIndex) ? 1.0 : -1.0, 0};

  // The line has the direction from one to the other of the two corners that are farthest apart.
  Vec2 along{0, 0};
  for (int i = 0; i < corner_count; ++i)
    for (int k = i + 1; k < corner_count; ++k)
      if (const Vec2 between = corners[k] - corners[i]; Dot(between, between) > Dot(along, along))
        along = between;
  const double length = Length(along);
  if (!(length > kRounding)) return {};
  TrimLine line{-along.y / length, along.x / length, 0, 0};
  double least = INFINITY, most = -INFINITY;
  for (int i = 0; i < corner_count; ++i) {
    const double value = line.a * corners[i].x + line.b * corners[i].y;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  line.c = -0.5 * (least + most);
  line.w = 0.5 * (most - least) + std::fabs(line.a) * band.x + std::fabs(line.b) * band.y + kRounding;

  // Test a corner of the rectangle on either side to find the side that is inside the face.
  const auto side = [&](double sign) {
    const Vec2 at{sign * line.a >= 0 ? 1.0 : -1.0, sign * line.b >= 0 ? 1.0 : -1.0};
    if (!(sign * (line.a * at.x + line.b * at.y + line.c) > line.w)) return -1;
    return static_cast<int>(OddExcept({at.x > 0 ? u1 : u0, at.y > 0 ? v1 : v0}, kNoIndex));
  };
  const int above = side(1), below = side(-1);
  if (above == below) return {};
  if (above == 0 || below == 1) line = {-line.a, -line.b, -line.c, line.w};
  return line;
}

}  // namespace facetless
