#include "import/loop_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace facetless {
namespace {

// Curves that meet at an angle with a smaller sine than this run along each other.
constexpr double kLeastSine = 1e-3;
// Curves that meet closer than this to an end of either, relative to the smaller loop, only touch there.
constexpr double kTouch = 1e-3;
// A curve that deviates from its chord by less than this, relative to the smaller loop, is treated as its
// chord.
constexpr double kFlat = 1e-7;
// The largest number of pairs of pieces that are compared for one pair of curves, and for one face. Curves
// that run along each other have many such pairs.
constexpr int kMostSteps = 20000;
constexpr int kMostFaceSteps = 2000000;

struct Box {
  double u0 = INFINITY, u1 = -INFINITY, v0 = INFINITY, v1 = -INFINITY;

  void Add(Vec2 p) {
    u0 = std::min(u0, p.x);
    u1 = std::max(u1, p.x);
    v0 = std::min(v0, p.y);
    v1 = std::max(v1, p.y);
  }
  bool Meets(const Box& b) const { return u0 <= b.u1 && b.u0 <= u1 && v0 <= b.v1 && b.v0 <= v1; }
  double Size() const { return std::hypot(u1 - u0, v1 - v0); }
};

Vec2 Point(const Vec4& p) {
  return {p.x / p.w, p.y / p.w};
}

Box BoxOf(const std::vector<Vec4>& points) {
  Box box;
  for (const Vec4& p : points) box.Add(Point(p));
  return box;
}

struct Curve {
  const std::vector<Vec4>* points;
  std::size_t loop, index, count;  // index of the segment in the loop, and number of the loop's segments
  Box box;
};

// Halves a Bézier curve by de Casteljau's algorithm.
std::pair<std::vector<Vec4>, std::vector<Vec4>> Halves(std::vector<Vec4> points) {
  std::vector<Vec4> low, high(points.size());
  const std::size_t n = points.size();
  for (std::size_t level = 0; level < n; ++level) {
    low.push_back(points.front());
    high[n - 1 - level] = points[n - 1 - level];
    for (std::size_t i = 0; i + 1 < n - level; ++i) {
      points[i] = {0.5 * (points[i].x + points[i + 1].x), 0.5 * (points[i].y + points[i + 1].y),
                   0.5 * (points[i].z + points[i + 1].z), 0.5 * (points[i].w + points[i + 1].w)};
    }
  }
  return {std::move(low), std::move(high)};
}

double Deviation(const std::vector<Vec4>& points) {
  const Vec2 a = Point(points.front()), chord = Point(points.back()) - a;
  const double length = Length(chord);
  double deviation = 0;
  for (const Vec4& p : points) {
    const Vec2 offset = Point(p) - a;
    deviation = std::fmax(deviation, length > 0 ? std::fabs(Cross(chord, offset)) / length : Length(offset));
  }
  return deviation;
}

class Finder {
 public:
  Finder(const Curve& a, const Curve& b, double size) : a_(a), b_(b), size_(size) {}

  bool Find(Vec2& at) { return Search(*a_.points, *b_.points, at); }
  int steps() const { return steps_; }

 private:
  bool Search(const std::vector<Vec4>& a, const std::vector<Vec4>& b, Vec2& at) {
    if (++steps_ > kMostSteps || !BoxOf(a).Meets(BoxOf(b))) return false;
    const double bend_a = Deviation(a), bend_b = Deviation(b);
    if (bend_a <= kFlat * size_ && bend_b <= kFlat * size_) return Crosses(a, b, at);
    const bool halve_a = bend_a >= bend_b;
    const auto [low, high] = Halves(halve_a ? a : b);
    return halve_a ? Search(low, b, at) || Search(high, b, at) : Search(a, low, at) || Search(a, high, at);
  }

  bool Crosses(const std::vector<Vec4>& a, const std::vector<Vec4>& b, Vec2& at) const {
    const Vec2 p = Point(a.front()), d = Point(a.back()) - p, q = Point(b.front()), e = Point(b.back()) - q;
    const double determinant = Cross(d, e);
    if (!(std::fabs(determinant) > kLeastSine * Length(d) * Length(e))) return false;
    const double s = Cross(q - p, e) / determinant, t = Cross(q - p, d) / determinant;
    if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return false;
    at = p + s * d;
    for (const Curve* curve : {&a_, &b_}) {
      if (Length(at - Point(curve->points->front())) <= kTouch * size_ ||
          Length(at - Point(curve->points->back())) <= kTouch * size_)
        return false;
    }
    return true;
  }

  const Curve& a_;
  const Curve& b_;
  const double size_;
  int steps_ = 0;
};

// Returns whether one curve follows the other in the same loop, so that they share an end.
bool AreNeighbours(const Curve& a, const Curve& b) {
  if (a.loop != b.loop) return false;
  const std::size_t low = std::min(a.index, b.index), high = std::max(a.index, b.index);
  return high - low <= 1 || (low == 0 && high + 1 == a.count);
}

// A loop as a polygon, with one point within each of its segments.
struct Outline {
  std::vector<Vec2> corners, middles, ends;  // ends: the end of each middle's segment
  Box box;
};

Outline MakeLoopOutline(const FaceLoop& loop) {
  constexpr int kSteps = 8;
  Outline outline;
  for (const LoopCoedge& coedge : loop.coedges) {
    for (const LoopSegment& segment : coedge.segments) {
      const int steps = segment.points.size() == 2 ? 1 : kSteps;
      for (int i = 0; i < steps; ++i)
        outline.corners.push_back(Point(EvaluateBezier(segment.points, static_cast<double>(i) / steps)));
      if (!coedge.edge.IsNull() && !coedge.degenerate) {
        outline.middles.push_back(Point(EvaluateBezier(segment.points, 0.5)));
        outline.ends.push_back(Point(segment.points.back()));
      }
      const Box box = BoxOf(segment.points);
      outline.box.Add({box.u0, box.v0});
      outline.box.Add({box.u1, box.v1});
    }
  }
  return outline;
}

// Returns 1 if p is inside the polygon, −1 if it is outside, 0 if it is nearer to the polygon than
// `tolerance`.
int SideOf(Vec2 p, const std::vector<Vec2>& polygon, double tolerance) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()], chord = b - a;
    const double square = Dot(chord, chord);
    const double t = square > 0 ? std::clamp(Dot(p - a, chord) / square, 0.0, 1.0) : 0;
    if (Length(p - a - t * chord) <= tolerance) return 0;
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside ? 1 : -1;
}

// Returns whether one loop lies on both sides of the other. OpenCASCADE splits edges where loops cross, so
// that they only meet there and no curve crosses another.
bool Straddles(const Outline& loop, const Outline& other, Vec2& at) {
  // The corners are eight points per arc of at most an eighth of a turn. Such a polygon deviates from the arc
  // by less than this share of its size.
  constexpr double kOffArc = 2e-2;
  if (!loop.box.Meets(other.box)) return false;
  const double tolerance = kOffArc * std::min(loop.box.Size(), other.box.Size());
  // Loops with thousands of edges are sampled.
  constexpr std::size_t kMostTests = 20000000;
  const std::size_t stride = 1 + loop.middles.size() * other.corners.size() / kMostTests;
  int before = 0;
  for (std::size_t i = 0; i < loop.middles.size(); i += stride) {
    const int side = SideOf(loop.middles[i], other.corners, tolerance);
    if (side * before < 0) {
      at = loop.ends[i - stride];
      return true;
    }
    if (side != 0) before = side;
  }
  return false;
}

}  // namespace

std::vector<LoopCrossing> FindLoopCrossings(const std::vector<FaceLoop>& loops) {
  // Collect the curves, sorted by the beginning of their range in u.
  std::vector<Curve> curves;
  std::vector<double> sizes;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    std::size_t count = 0, index = 0;
    for (const LoopCoedge& coedge : loops[l].coedges) count += coedge.segments.size();
    Box whole;
    for (const LoopCoedge& coedge : loops[l].coedges) {
      for (const LoopSegment& segment : coedge.segments) {
        const Box box = BoxOf(segment.points);
        whole.Add({box.u0, box.v0});
        whole.Add({box.u1, box.v1});
        if (!coedge.edge.IsNull() && !coedge.degenerate)
          curves.push_back({&segment.points, l, index, count, box});
        ++index;
      }
    }
    sizes.push_back(whole.Size());
  }
  std::sort(curves.begin(), curves.end(), [](const Curve& a, const Curve& b) { return a.box.u0 < b.box.u0; });
  // Compare the curves whose ranges in u overlap.
  std::vector<LoopCrossing> crossings;
  std::set<std::pair<std::size_t, std::size_t>> found;
  int steps = 0;
  std::vector<Outline> outlines;
  for (const FaceLoop& loop : loops) outlines.push_back(MakeLoopOutline(loop));
  for (std::size_t i = 0; i < loops.size(); ++i) {
    for (std::size_t j = i + 1; j < loops.size(); ++j) {
      Vec2 at;
      if (!Straddles(outlines[i], outlines[j], at) && !Straddles(outlines[j], outlines[i], at)) continue;
      found.insert({i, j});
      crossings.push_back({i, j, at});
    }
  }
  for (std::size_t i = 0; i < curves.size(); ++i) {
    for (std::size_t j = i + 1; j < curves.size() && curves[j].box.u0 <= curves[i].box.u1; ++j) {
      if (++steps > kMostFaceSteps) return crossings;
      const Curve &a = curves[i], &b = curves[j];
      if (!a.box.Meets(b.box) || AreNeighbours(a, b)) continue;
      const auto [low, high] = std::minmax(a.loop, b.loop);
      if (found.contains({low, high})) continue;
      Finder finder(a, b, std::min(sizes[a.loop], sizes[b.loop]));
      Vec2 at;
      if (finder.Find(at)) {
        found.insert({low, high});
        crossings.push_back({low, high, at});
      }
      steps += finder.steps();
    }
  }
  return crossings;
}

}  // namespace facetless
