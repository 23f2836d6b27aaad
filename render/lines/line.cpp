#include "render/lines/line.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace facetless {
namespace {

constexpr double kBeside = 8, kLongest = 1e12;  // pixels

// The height of a point above a plane. Points in the plane are kept, within the flatness of lines, so that
// the edges of a face in the plane stay.
double Height(const CameraFrame& frame, const SectionPlane& plane, const LinePoint& p) {
  const Ray ray = PixelRay(frame, p.x, p.y);
  const double pixel =
      std::fmax(frame.pixel_x, frame.pixel_y) * (frame.projection == Projection::kPerspective ? p.depth : 1);
  return Dot(plane.normal, ray.origin + p.depth * ray.direction - plane.point) - kFlatness * pixel;
}

// The point where the height changes its sign. It is found by bisection, because the height is linear along
// the line in space, but not on the screen.
LinePoint FindPlaneCrossing(const CameraFrame& frame, const SectionPlane& plane, const LinePoint& a,
                            const LinePoint& b) {
  const bool above = Height(frame, plane, a) > 0;
  double low = 0, high = 1;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    ((Height(frame, plane, Between(frame, a, b, middle)) > 0) == above ? low : high) = middle;
  }
  return Between(frame, a, b, 0.5 * (low + high));
}

// A part of a line segment, as shares of the way from one point to the next. It is empty unless begin < end.
struct Stretch {
  double begin, end;
};

Stretch WithinPicture(const LinePoint& a, const LinePoint& b, double width, double height) {
  if (!(std::hypot(b.x - a.x, b.y - a.y) < kLongest)) return {0, 0};
  Stretch stretch{0, 1};
  const auto clip = [&](double from, double to, double size) {
    if (from == to) {
      if (from < -kBeside || from > size + kBeside) stretch.end = 0;
      return;
    }
    const double low = (-kBeside - from) / (to - from), high = (size + kBeside - from) / (to - from);
    stretch.begin = std::max(stretch.begin, std::min(low, high));
    stretch.end = std::min(stretch.end, std::max(low, high));
  };
  clip(a.x, b.x, width);
  clip(a.y, b.y, height);
  return stretch;
}

}  // namespace

LinePoint Between(const CameraFrame& frame, const LinePoint& a, const LinePoint& b, double share) {
  const double depth = frame.projection == Projection::kPerspective
                           ? a.depth * b.depth / (b.depth + share * (a.depth - b.depth))
                           : a.depth + share * (b.depth - a.depth);
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), depth};
}

void ClipLine(const CameraFrame& frame, const std::vector<SectionPlane>& planes, int except, ViewLine line,
              std::vector<ViewLine>* out) {
  std::vector<ViewLine> kept;
  kept.push_back(std::move(line));
  for (int k = 0; k < static_cast<int>(planes.size()); ++k) {
    if (k == except) continue;
    std::vector<ViewLine> next;
    for (const ViewLine& whole : kept) {
      ViewLine piece{whole.kind, whole.visible, {}, whole.faces};
      const auto end = [&] {
        if (piece.points.size() > 1) next.push_back(piece);
        piece.points.clear();
      };
      for (std::size_t i = 0; i < whole.points.size(); ++i) {
        const double here = Height(frame, planes[k], whole.points[i]);
        if (i > 0) {
          const double before = Height(frame, planes[k], whole.points[i - 1]);
          if ((before > 0) != (here > 0)) {
            piece.points.push_back(FindPlaneCrossing(frame, planes[k], whole.points[i - 1], whole.points[i]));
            if (here > 0) end();
          }
        }
        if (here <= 0) piece.points.push_back(whole.points[i]);
      }
      end();
    }
    kept = std::move(next);
  }
  for (ViewLine& piece : kept) out->push_back(std::move(piece));
}

void CutToPicture(const CameraFrame& frame, double width, double height, const ViewLine& line,
                  std::vector<ViewLine>* out) {
  ViewLine piece{line.kind, line.visible, {}, line.faces};
  const auto end = [&] {
    if (piece.points.size() > 1) out->push_back(piece);
    piece.points.clear();
  };
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    const LinePoint &a = line.points[i - 1], &b = line.points[i];
    const Stretch seen = WithinPicture(a, b, width, height);
    if (!(seen.begin < seen.end)) {
      end();
      continue;
    }
    if (piece.points.empty()) piece.points.push_back(seen.begin > 0 ? Between(frame, a, b, seen.begin) : a);
    piece.points.push_back(seen.end < 1 ? Between(frame, a, b, seen.end) : b);
    if (seen.end < 1) end();
  }
  end();
}

}  // namespace facetless
