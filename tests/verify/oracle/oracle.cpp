#include "tests/verify/oracle/oracle.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "render/model/walk.h"
#include "tests/verify/oracle/patch_roots.h"

namespace facetless::oracle {
namespace {

// A box over which the ray's two planes vary by less than this share of the model's size is not divided any
// more. An open question there is a doubt, known to this precision.
constexpr double kFloorShare = 0x1p-52;
// Roots this close to the border of their patch, in its own parameters, may also belong to a neighbour.
constexpr double kNearBorder = 0x1p-40;
// The depths of the same crossing, found on two patches, differ only by the rounding of the control points.
constexpr double kSameDepthShare = 0x1p-40;
// A root this far beyond its patch counts as on the border, because of Real's own rounding of the parameter.
constexpr double kOnBorder = 0x1p-90;
// The distance at which the even-odd rule gives up, relative to the size of the parameters.
constexpr double kTrimFloor = 0x1p-72;
// The error of double in boxes and signs that only decide what can be skipped.
constexpr double kCullingShare = 1e-12;

// A plane, as a linear function of homogeneous points in the coordinates of a part.
struct Covector {
  Real x, y, z, w;
  Real At(const Vec4& p) const { return x * p.x + y * p.y + z * p.z + w * p.w; }
};

// Returns normal·(point − origin) for points of an instance.
Covector PlacedCovector(const Placement& placement, Real3 normal, Real3 origin) {
  const auto& m = placement.m;
  const auto column = [&](int c) { return normal.x * m[0][c] + normal.y * m[1][c] + normal.z * m[2][c]; };
  const Real3 shift = Real3{m[0][3], m[1][3], m[2][3]} - origin;
  return {column(0), column(1), column(2), Dot(normal, shift)};
}

// Returns whether, in double, the patch's control points are certainly on one side of the plane.
bool OneSide(const Covector& plane, const Vec4* points, std::size_t count) {
  const double x = static_cast<double>(plane.x), y = static_cast<double>(plane.y),
               z = static_cast<double>(plane.z), w = static_cast<double>(plane.w);
  bool positive = true, negative = true;
  for (std::size_t i = 0; i < count && (positive || negative); ++i) {
    const double a = x * points[i].x, b = y * points[i].y, c = z * points[i].z, d = w * points[i].w;
    const double value = a + b + c + d;
    const double slack = kCullingShare * (std::fabs(a) + std::fabs(b) + std::fabs(c) + std::fabs(d));
    positive = positive && value > slack;
    negative = negative && value < -slack;
  }
  return positive || negative;
}

// Returns the patch's coefficients of a plane, and a bound of their error.
std::vector<Real> Coefficients(const Covector& plane, const Vec4* points, std::size_t count, Real& error) {
  std::vector<Real> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec4& p = points[i];
    result[i] = plane.At(p);
    const Real size = Abs(plane.x * p.x) + Abs(plane.y * p.y) + Abs(plane.z * p.z) + Abs(plane.w * p.w);
    error = Max(error, 4 * kHalfUlp * size);
  }
  return result;
}

struct Native {
  Real value, rate;  // rate: derivative by the patch's own parameter
};
Native NativeOf(const Span& span, Real t) {
  const Real begin = span.begin, end = span.end;
  if (span.map == SpanMap::kLinear) return {begin + t * (end - begin), end - begin};
  // (2t − 1)·tan(h/2) = tan((native − m)/2).
  const Real tangent = Tan((end - begin) / 4), x = (2 * t - 1) * tangent;
  return {(begin + end) / 2 + 2 * Atan(x), 4 * tangent / (1 + x * x)};
}

// Returns the points of a curve, with each stored point converted by `map` to a Real3.
template <typename Point, typename Map>
HomogeneousCurve Mapped(const Point* points, int degree, const Map& map) {
  HomogeneousCurve curve;
  for (int i = 0; i <= degree; ++i) curve.push_back(map(points[i]));
  return curve;
}

// The straight piece from the end of one curve to the beginning of the next.
HomogeneousCurve Joint(const Real3& end, const Real3& begin) {
  return {end, begin};
}

}  // namespace

Oracle::Oracle(const Model& model) : model_(model) {
  // Compute the boxes of the placed faces from their control points.
  boxes_.reserve(model.PlacedFaceCount());
  for (const Instance& instance : model.instances) {
    for (const Face& face : FacesOf(model, model.parts[instance.part])) {
      Box3 box;
      for (const Vec4& p : PointsOf(model, model.surfaces[face.surface]))
        box.Add(instance.placement.Point({p.x / p.w, p.y / p.w, p.z / p.w}));
      const double size = box.diagonal() + Length(box.low) + Length(box.high);
      const Vec3 slack = kCullingShare * size * Vec3{1, 1, 1};
      boxes_.push_back({box.low - slack, box.high + slack});
    }
  }
  // The boxes of the trim segments are a unit in the last place wider than their control points.
  for (const TrimSegment& segment : model.trim_segments) {
    TrimBox box{INFINITY, -INFINITY, -INFINITY};
    for (const Vec3& p : PointsOf(model, segment)) {
      box.u_low = std::min(box.u_low, std::nextafter(p.x / p.z, -INFINITY));
      box.u_high = std::max(box.u_high, std::nextafter(p.x / p.z, INFINITY));
      box.v_high = std::max(box.v_high, std::nextafter(p.y / p.z, INFINITY));
    }
    trim_boxes_.push_back(box);
  }
}

Standing Oracle::ClassifyTrimPoint(std::uint32_t face, Real u, Real v) const {
  const std::span<const Loop> loops = LoopsOf(model_, model_.faces[face]);
  if (loops.empty()) return Standing::kInside;
  const Real floor = kTrimFloor * (1 + Abs(u) + Abs(v));
  bool odd = false, unsure = false;
  const auto count = [&](const HomogeneousCurve& curve) {
    const Parity parity = CrossesUpwardAxis(curve, floor);
    unsure = unsure || parity == Parity::kUnsure;
    odd = odd != (parity == Parity::kOdd);
  };
  const double near_u = static_cast<double>(u), near_v = static_cast<double>(v);
  for (const Loop& loop : loops) {
    bool started = false;
    Real3 first, last;
    for (const Coedge& coedge : CoedgesOf(model_, loop)) {
      for (const TrimSegment& segment : SegmentsOf(model_, coedge)) {
        const Vec3* points = PointsOf(model_, segment).data();
        const auto relative = [&](const Vec3& p) { return Real3{p.x - p.z * u, p.y - p.z * v, p.z}; };
        const Real3 begin = relative(points[0]), end = relative(points[segment.degree]);
        // Segments meet to within rounding. A straight piece closes the rest of the gap.
        if (started) count(Joint(last, begin));
        if (!started) first = begin;
        started = true;
        last = end;
        const TrimBox& box = trim_boxes_[IndexWithin(model_.trim_segments, segment)];
        const double reach_u = std::nextafter(near_u, INFINITY), reach_v = std::nextafter(near_v, -INFINITY);
        if (reach_u < box.u_low || std::nextafter(near_u, -INFINITY) > box.u_high || reach_v > box.v_high)
          continue;
        count(Mapped(points, segment.degree, relative));
      }
    }
    if (started) count(Joint(last, first));
  }
  if (unsure) return Standing::kUnsure;
  return odd ? Standing::kInside : Standing::kOutside;
}

void Oracle::FaceCrossings(const ViewRay& ray, double near, std::uint32_t placed_face,
                           std::vector<Crossing>& found) const {
  const Instance& instance = model_.instances[model_.InstanceOfPlacedFace(placed_face)];
  const std::uint32_t face = model_.FaceOfPlacedFace(placed_face);
  const Surface& surface = model_.surfaces[model_.faces[face].surface];
  const int n = surface.degree_u, m = surface.degree_v;
  const Real3 along = Normalized(ray.direction);
  const Covector across = PlacedCovector(instance.placement, ray.across, ray.origin),
                 down = PlacedCovector(instance.placement, ray.down, ray.origin),
                 forth = PlacedCovector(instance.placement, along, ray.origin);
  const Real depth_per_mm = 1 / Length(ray.direction);
  const Real floor = kFloorShare * model_.Diagonal();
  for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
    const std::span<const Vec4> own = PatchPoints(model_, surface, patch);
    const std::size_t count = own.size();
    // A common factor of all weights changes nothing. A power of two brings the largest near 1 exactly.
    double largest = 0, smallest = INFINITY;
    for (const Vec4& p : own) {
      largest = std::max(largest, p.w);
      smallest = std::min(smallest, p.w);
    }
    const double scale = std::exp2(-std::floor(std::log2(largest)));
    std::vector<Vec4> scaled(own.begin(), own.end());
    for (Vec4& p : scaled) p = scale * p;
    const Vec4* points = scaled.data();
    if (OneSide(across, points, count) || OneSide(down, points, count)) continue;
    BernsteinPair pair{n, m, {}, {}, 0};
    pair.f = Coefficients(across, points, count, pair.error);
    pair.g = Coefficients(down, points, count, pair.error);
    // Coefficients are lengths times weights.
    const std::vector<PatchRoot> roots = FindRoots(pair, floor * (scale * smallest));
    if (roots.empty()) continue;
    Real unused = 0;
    const std::vector<Real> height = Coefficients(forth, points, count, unused);
    std::vector<Real> weight(count);
    for (std::size_t i = 0; i < count; ++i) weight[i] = points[i].w;
    for (const PatchRoot& root : roots) {
      Crossing crossing;
      crossing.placed_face = placed_face;
      crossing.patch = patch;
      crossing.proven = root.proven;
      crossing.border = Min(Min(root.u, 1 - root.u), Min(root.v, 1 - root.v));
      // Compute the depth.
      const Jet h = Evaluate(height, n, m, root.u, root.v), w = Evaluate(weight, n, m, root.u, root.v);
      if (root.proven) {
        crossing.depth = h.value / w.value * depth_per_mm;
      } else {
        const Real u0 = root.u - root.half_u, u1 = root.u + root.half_u, v0 = root.v - root.half_v,
                   v1 = root.v + root.half_v;
        const std::vector<Real> heights = Restrict(height, n, m, u0, u1, v0, v1),
                                weights = Restrict(weight, n, m, u0, u1, v0, v1);
        Real low = heights[0] / weights[0], high = low;
        for (std::size_t i = 0; i < count; ++i) {
          low = Min(low, heights[i] / weights[i]);
          high = Max(high, heights[i] / weights[i]);
        }
        crossing.depth = (low + high) / 2 * depth_per_mm;
        crossing.half_depth = (high - low) / 2 * depth_per_mm;
      }
      if (!(crossing.depth + crossing.half_depth > near)) continue;
      // Compute the tangents across the ray, and the normal.
      const Span& span_u = model_.spans[surface.u_spans.first + patch / surface.v_spans.count];
      const Span& span_v = model_.spans[surface.v_spans.first + patch % surface.v_spans.count];
      const Real inwards_u = Max(kInwards, Min(1 - Real(kInwards), root.u)),
                 inwards_v = Max(kInwards, Min(1 - Real(kInwards), root.v));
      const Native u = NativeOf(span_u, inwards_u), v = NativeOf(span_v, inwards_v);
      const Jet f = Evaluate(pair.f, n, m, root.u, root.v), g = Evaluate(pair.g, n, m, root.u, root.v);
      const auto by_u = [&](const Jet& jet) { return (jet.du - jet.value / w.value * w.du) / w.value; };
      const auto by_v = [&](const Jet& jet) { return (jet.dv - jet.value / w.value * w.dv) / w.value; };
      const Real3 du{by_u(f), by_u(g), by_u(h)}, dv{by_v(f), by_v(g), by_v(h)};
      const Real3 normal = Cross(du, dv);
      const Real length = Length(normal);
      crossing.cosine = length > 0 ? static_cast<double>(Abs(normal.z) / length) : 0;
      crossing.turns = (normal.z > 0) - (normal.z < 0);
      crossing.u = u.value;
      crossing.v = v.value;
      crossing.tangents[0][0] = static_cast<double>(du.x / u.rate);
      crossing.tangents[0][1] = static_cast<double>(dv.x / v.rate);
      crossing.tangents[1][0] = static_cast<double>(du.y / u.rate);
      crossing.tangents[1][1] = static_cast<double>(dv.y / v.rate);
      // Decide whether the crossing is inside.
      const bool beyond = -crossing.border > root.radius + kOnBorder;
      if (root.proven && !beyond) crossing.standing = ClassifyTrimPoint(face, u.value, v.value);
      found.push_back(crossing);
    }
  }
}

std::vector<Crossing> Oracle::Crossings(const ViewRay& ray, double near) const {
  const auto narrow = [](Real3 v) {
    return Vec3{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
  };
  const Vec3 across = narrow(ray.across), down = narrow(ray.down);
  const double across_origin = static_cast<double>(Dot(ray.across, ray.origin)),
               down_origin = static_cast<double>(Dot(ray.down, ray.origin));
  const double origin_slack = kCullingShare * Length(narrow(ray.origin));
  // Returns whether the line misses the box, seen along one of the two directions across it.
  const auto misses = [&](const Box3& box, Vec3 axis, double origin) {
    const Vec3 center = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
    const double reach = std::fabs(axis.x) * half.x + std::fabs(axis.y) * half.y + std::fabs(axis.z) * half.z;
    return std::fabs(Dot(axis, center) - origin) > reach * (1 + kCullingShare) + origin_slack;
  };
  std::vector<Crossing> all;
  for (std::uint32_t id = 0; id < boxes_.size(); ++id) {
    if (misses(boxes_[id], across, across_origin) || misses(boxes_[id], down, down_origin)) continue;
    std::vector<Crossing> found;
    FaceCrossings(ray, near, id, found);
    // Law 1: where two patches meet there is one crossing. The more certain one represents both.
    const Real same = kSameDepthShare * model_.Diagonal();
    for (const Crossing& crossing : found) {
      const auto twin = std::find_if(all.begin(), all.end(), [&](const Crossing& other) {
        const bool same_way = !other.proven || !crossing.proven || other.turns * crossing.turns >= 0;
        return other.placed_face == id && other.patch != crossing.patch && same_way &&
               other.border < kNearBorder && crossing.border < kNearBorder &&
               Abs(other.depth - crossing.depth) <= same + other.half_depth + crossing.half_depth;
      });
      if (twin == all.end()) {
        all.push_back(crossing);
      } else if (crossing.standing < twin->standing) {
        *twin = crossing;
      }
    }
  }
  std::sort(all.begin(), all.end(), [](const Crossing& a, const Crossing& b) { return a.depth < b.depth; });
  return all;
}

double Oracle::TrimDistance(const Crossing& crossing, double limit_mm) const {
  const std::uint32_t face = model_.FaceOfPlacedFace(crossing.placed_face);
  const FaceCoedges coedges = CoedgesOf(model_, model_.faces[face]);
  const auto& tangents = crossing.tangents;
  double best = limit_mm;
  bool any = false;
  const auto uses = [&](std::uint32_t edge) {
    int count = 0;
    for (const Coedge& coedge : coedges) count += coedge.edge == edge;
    return count;
  };
  for (const Coedge& coedge : coedges) {
    if (coedge.edge != kNoIndex && model_.edges[coedge.edge].degenerate) continue;
    bool seam_known = false, seam = false;
    for (const TrimSegment& segment : SegmentsOf(model_, coedge)) {
      const HomogeneousCurve curve =
          Mapped(PointsOf(model_, segment).data(), segment.degree, [&](const Vec3& p) {
            const Real du = p.x - p.z * crossing.u, dv = p.y - p.z * crossing.v;
            return Real3{tangents[0][0] * du + tangents[0][1] * dv, tangents[1][0] * du + tangents[1][1] * dv,
                         p.z};
          });
      const double distance = NearestTo(curve, best).distance;
      if (!(distance <= best)) continue;
      if (!seam_known) seam = coedge.edge != kNoIndex && uses(coedge.edge) > 1;
      seam_known = true;
      if (seam) continue;
      best = distance;
      any = true;
    }
  }
  return any ? best : INFINITY;
}

EdgeContact Oracle::NearestEdge(const ViewRay& ray, std::uint32_t placed_face, double depth, double slack_mm,
                                double depth_reach) const {
  const Instance& instance = model_.instances[model_.InstanceOfPlacedFace(placed_face)];
  const Covector across = PlacedCovector(instance.placement, ray.across, ray.origin),
                 down = PlacedCovector(instance.placement, ray.down, ray.origin),
                 forth = PlacedCovector(instance.placement, Normalized(ray.direction), ray.origin);
  const Real depth_per_mm = 1 / Length(ray.direction);
  EdgeContact best;
  for (const Coedge& coedge : CoedgesOf(model_, model_.faces[model_.FaceOfPlacedFace(placed_face)])) {
    if (coedge.edge == kNoIndex) continue;
    for (const EdgeSegment& segment : SegmentsOf(model_, model_.edges[coedge.edge])) {
      const Vec4* points = PointsOf(model_, segment).data();
      const HomogeneousCurve curve = Mapped(points, segment.degree, [&](const Vec4& p) {
        return Real3{across.At(p), down.At(p), p.w};
      });
      const Nearest nearest = NearestTo(curve, coedge.gap_mm + slack_mm);
      if (!(nearest.distance <= coedge.gap_mm + slack_mm)) continue;
      const Real3 high = PointAt(Mapped(points, segment.degree,
                                        [&](const Vec4& p) {
                                          return Real3{forth.At(p), 0, p.w};
                                        }),
                                 nearest.t);
      const double edge_depth = static_cast<double>(high.x / high.z * depth_per_mm);
      if (!(std::fabs(edge_depth - depth) <= depth_reach)) continue;
      if (best.coedge == kNoIndex || nearest.distance - coedge.gap_mm < best.distance_mm - best.gap_mm)
        best = {IndexWithin(model_.coedges, coedge), nearest.distance, coedge.gap_mm, edge_depth};
    }
  }
  return best;
}

}  // namespace facetless::oracle
