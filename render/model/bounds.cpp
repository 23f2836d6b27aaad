#include "render/model/bounds.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "render/model/walk.h"

namespace facetless {
namespace {

// The largest number of halvings of a Bézier piece before its hull is taken. The hull of an eighth of a turn
// then exceeds the arc by 3e-4 of the radius.
constexpr int kHalvings = 4;

// Points whose convex hull contains a face.
using Hull = std::vector<Vec3>;

Vec3 Cartesian(Vec4 p) {
  return {p.x / p.w, p.y / p.w, p.z / p.w};
}

// Divides a Bézier row at t.
void Split(std::span<const Vec4> points, double t, std::vector<Vec4>& left, std::vector<Vec4>& right) {
  std::vector<Vec4> work(points.begin(), points.end());
  left.clear();
  right.assign(points.size(), {});
  for (std::size_t last = work.size(); last-- > 0;) {
    left.push_back(work[0]);
    right[last] = work[last];
    for (std::size_t i = 0; i < last; ++i) work[i] = (1 - t) * work[i] + t * work[i + 1];
  }
}

void AppendCurveHull(std::span<const Vec4> points, int halvings, Hull& hull) {
  if (halvings == 0 || points.size() == 2) {
    for (const Vec4& p : points) hull.push_back(Cartesian(p));
    return;
  }
  std::vector<Vec4> left, right;
  Split(points, 0.5, left, right);
  AppendCurveHull(left, halvings - 1, hull);
  AppendCurveHull(right, halvings - 1, hull);
}

// A patch as rows of points. Part extracts [t0, t1] in the direction of the rows.
struct PointGrid {
  int count_u, count_v;
  std::vector<Vec4> points;
};

std::vector<Vec4> CutRow(std::span<const Vec4> row, double t0, double t1) {
  std::vector<Vec4> left, right;
  std::vector<Vec4> points(row.begin(), row.end());
  if (t1 < 1) {
    Split(points, t1, left, right);
    points = left;
    t0 = t1 > 0 ? t0 / t1 : 0;
  }
  if (t0 > 0) {
    Split(points, t0, left, right);
    points = right;
  }
  return points;
}

PointGrid CutV(const PointGrid& patch, double t0, double t1) {
  PointGrid out{patch.count_u, patch.count_v, {}};
  for (int k = 0; k < patch.count_u; ++k) {
    const auto row = CutRow(
        {&patch.points[static_cast<std::size_t>(k) * patch.count_v], static_cast<std::size_t>(patch.count_v)},
        t0, t1);
    out.points.insert(out.points.end(), row.begin(), row.end());
  }
  return out;
}

PointGrid Transposed(const PointGrid& patch) {
  PointGrid out{patch.count_v, patch.count_u, std::vector<Vec4>(patch.points.size())};
  for (int k = 0; k < patch.count_u; ++k) {
    for (int l = 0; l < patch.count_v; ++l)
      out.points[l * patch.count_u + k] = patch.points[k * patch.count_v + l];
  }
  return out;
}

// The number of halvings along a direction that gives at least kCells cells in total. On a full turn, the
// hull then exceeds an arc by less than half a per cent of its radius. Straight directions need no halving.
int HalvingsFor(int degree, std::size_t spans) {
  if (degree == 1) return 0;
  constexpr std::size_t kCells = 32;
  int halvings = 0;
  while (halvings < kHalvings && spans << halvings < kCells) ++halvings;
  return halvings;
}

void AppendPatchHull(const PointGrid& patch, int halvings_u, int halvings_v, Hull& hull) {
  const int nu = 1 << halvings_u, nv = 1 << halvings_v;
  for (int i = 0; i < nu; ++i) {
    const PointGrid strip =
        Transposed(CutV(Transposed(patch), static_cast<double>(i) / nu, static_cast<double>(i + 1) / nu));
    for (int j = 0; j < nv; ++j) {
      for (const Vec4& p : CutV(strip, static_cast<double>(j) / nv, static_cast<double>(j + 1) / nv).points)
        hull.push_back(Cartesian(p));
    }
  }
}

struct UvBox {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
};

UvBox LoopBox(const Model& model, const Face& face) {
  UvBox box;
  for (const Coedge& coedge : CoedgesOf(model, face)) {
    for (const TrimSegment& segment : SegmentsOf(model, coedge)) {
      for (const Vec3& p : PointsOf(model, segment)) {
        box.low = {std::fmin(box.low.x, p.x / p.z), std::fmin(box.low.y, p.y / p.z)};
        box.high = {std::fmax(box.high.x, p.x / p.z), std::fmax(box.high.y, p.y / p.z)};
      }
    }
  }
  return box;
}

// The part [t0, t1] of a span that the loops reach; empty if t0 >= t1.
std::pair<double, double> Reached(const Span& span, double low, double high, SpanToBezier to_bezier) {
  const double begin = std::max(span.begin, low), end = std::min(span.end, high);
  if (!(begin < end)) return {1, 0};
  const double t0 = begin <= span.begin ? 0 : to_bezier(span, begin);
  const double t1 = end >= span.end ? 1 : to_bezier(span, end);
  return {t0, t1};
}

void AppendSurfaceHull(const Model& model, const Face& face, SpanToBezier to_bezier, Hull& hull) {
  const Surface& surface = model.surfaces[face.surface];
  UvBox box = LoopBox(model, face);
  if (face.loops.count == 0) box = {{-INFINITY, -INFINITY}, {INFINITY, INFINITY}};
  const int halvings_u = HalvingsFor(surface.degree_u, surface.u_spans.count);
  const int halvings_v = HalvingsFor(surface.degree_v, surface.v_spans.count);
  for (std::uint32_t i = 0; i < surface.u_spans.count; ++i) {
    const auto [u0, u1] = Reached(model.spans[surface.u_spans.first + i], box.low.x, box.high.x, to_bezier);
    for (std::uint32_t j = 0; j < surface.v_spans.count; ++j) {
      const auto [v0, v1] = Reached(model.spans[surface.v_spans.first + j], box.low.y, box.high.y, to_bezier);
      if (!(u0 < u1) || !(v0 < v1)) continue;
      const std::span<const Vec4> points = PatchPoints(model, surface, i * surface.v_spans.count + j);
      PointGrid patch{surface.degree_u + 1, surface.degree_v + 1, {points.begin(), points.end()}};
      patch = Transposed(CutV(Transposed(CutV(patch, v0, v1)), u0, u1));
      AppendPatchHull(patch, halvings_u, halvings_v, hull);
    }
  }
}

// Returns whether the extent of the surface in every direction is attained on the border of a face. This is
// true of surfaces that consist of straight lines, which leave the face through its loops.
bool IsDevelopable(SurfaceKind kind) {
  return kind == SurfaceKind::kPlane || kind == SurfaceKind::kCylinder || kind == SurfaceKind::kCone ||
         kind == SurfaceKind::kExtrusion;
}

// Appends the hull of all edges. Returns false if a coedge has no edge (a border that the importer added).
bool AppendEdgeHull(const Model& model, const Face& face, Hull& hull) {
  if (face.loops.count == 0) return false;
  for (const Coedge& coedge : CoedgesOf(model, face)) {
    if (coedge.edge == kNoIndex) return false;
    const Edge& edge = model.edges[coedge.edge];
    for (const EdgeSegment& segment : SegmentsOf(model, edge))
      AppendCurveHull(PointsOf(model, segment), kHalvings, hull);
    for (std::uint32_t vertex : edge.vertices) {
      if (vertex != kNoIndex) hull.push_back(model.vertices[vertex].point);
    }
  }
  return true;
}

Hull FaceHull(const Model& model, std::uint32_t index, SpanToBezier to_bezier) {
  const Face& face = model.faces[index];
  Hull hull;
  if (IsDevelopable(model.surfaces[face.surface].kind) && AppendEdgeHull(model, face, hull)) return hull;
  hull.clear();
  AppendSurfaceHull(model, face, to_bezier, hull);
  return hull;
}

Box3 Widened(Box3 box, double by) {
  if (box.empty()) return box;
  box.low = box.low - Vec3{by, by, by};
  box.high = box.high + Vec3{by, by, by};
  return box;
}

}  // namespace

Box3 FaceBounds(const Model& model, std::uint32_t face, SpanToBezier to_bezier) {
  Box3 box;
  for (const Vec3& p : FaceHull(model, face, to_bezier)) box.Add(p);
  return Widened(box, LargestGap(model, model.faces[face]));
}

std::vector<Box3> InstanceBounds(const Model& model, SpanToBezier to_bezier) {
  // Reduce each part to the points of its hull, which all its instances share.
  std::vector<std::pair<Hull, double>> hulls(model.parts.size());
  std::vector<bool> used(model.parts.size());
  for (const Instance& instance : model.instances) used[instance.part] = true;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    if (!used[p]) continue;
    for (const std::uint32_t f : Indices(model.parts[p].faces)) {
      const Hull hull = FaceHull(model, f, to_bezier);
      hulls[p].first.insert(hulls[p].first.end(), hull.begin(), hull.end());
      hulls[p].second = std::fmax(hulls[p].second, LargestGap(model, model.faces[f]));
    }
  }
  std::vector<std::uint32_t> placed(model.parts.size(), 0);
  for (const Instance& instance : model.instances) ++placed[instance.part];
  // Replace a part that is placed often by the transformed corners of its box. This is fast, and the bounds
  // are only looser by the effect of the rotation.
  constexpr std::uint32_t kOften = 64;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    if (placed[p] <= kOften || hulls[p].first.empty()) continue;
    Box3 box;
    for (const Vec3& point : hulls[p].first) box.Add(point);
    Hull corners;
    for (int i = 0; i < 8; ++i)
      corners.push_back(
          {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z});
    hulls[p].first = std::move(corners);
  }
  std::vector<Box3> bounds;
  bounds.reserve(model.instances.size());
  for (const Instance& instance : model.instances) {
    const auto& [hull, gap] = hulls[instance.part];
    Box3 box;
    for (const Vec3& point : hull) box.Add(instance.placement.Point(point));
    bounds.push_back(Widened(box, gap));
  }
  return bounds;
}

Box3 Union(const std::vector<Box3>& boxes) {
  Box3 bounds;
  for (const Box3& box : boxes) {
    if (box.empty()) continue;
    bounds.Add(box.low);
    bounds.Add(box.high);
  }
  return bounds;
}

}  // namespace facetless
