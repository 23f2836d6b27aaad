#include "tests/unit/accel/box_scenes.h"

#include <algorithm>
#include <cmath>

namespace facetless::testing {
namespace {

std::uint64_t Below(std::uint64_t bound, Engine& engine) {
  return engine() % bound;
}

Vec3 Point(Engine& engine) {
  return {Number(engine), Number(engine), Number(engine)};
}

Vec3 Direction(Engine& engine) {
  return {2 * Number(engine) - 1, 2 * Number(engine) - 1, 2 * Number(engine) - 1};
}

double& Component(Vec3& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}
double Component(const Vec3& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

Box3 Around(Vec3 middle, Vec3 half) {
  return {middle - half, middle + half};
}

Box3 DrawBox(SceneKind kind, std::size_t i, const std::vector<Vec3>& clusters, Engine& engine) {
  switch (kind) {
    case SceneKind::kClustered:
      return Around(clusters[Below(clusters.size(), engine)] + 0.01 * Direction(engine),
                    0.002 * Point(engine));
    case SceneKind::kNeedles: {
      Vec3 half = 0.003 * Point(engine);
      Component(half, static_cast<int>(Below(3, engine))) = 0.4 * Number(engine);
      return Around(Point(engine), half);
    }
    case SceneKind::kFlat: {
      Vec3 half = 0.1 * Point(engine);
      Component(half, static_cast<int>(Below(3, engine))) = 0;
      if (Below(4, engine) == 0) Component(half, static_cast<int>(Below(3, engine))) = 0;
      // Some share a plane.
      Vec3 middle = Point(engine);
      if (Below(2, engine) == 0) middle.z = 0.5;
      return Around(middle, half);
    }
    case SceneKind::kIdentical:
      return Around({0.5, 0.25, 0.125}, {0.25, 0.125, 0.0625});
    case SceneKind::kTiles: {
      const Vec3 low{static_cast<double>(i % 8), static_cast<double>(i / 8 % 8), static_cast<double>(i / 64)};
      return {low, low + Vec3{1, 1, 1}};
    }
    case SceneKind::kNested:
      return Around({0, 0, 0}, (1.0 + static_cast<double>(i)) * Vec3{1, 0.5, 0.75});
    case SceneKind::kFarAway:
      return Around(Vec3{1e7, -1.5e7, 1.25e7} + Point(engine), 0.05 * Point(engine));
    case SceneKind::kTiny:
      return Around(1e-6 * Point(engine), 3e-8 * Point(engine));
    default:
      return Around(Point(engine), 0.05 * Point(engine));
  }
}

Box3 BoundsOf(const std::vector<Box3>& boxes) {
  Box3 bounds;
  for (const Box3& box : boxes) bounds.Add(box.low), bounds.Add(box.high);
  return boxes.empty() ? Box3{{0, 0, 0}, {1, 1, 1}} : bounds;
}

Vec3 PointIn(const Box3& box, Engine& engine) {
  const Vec3 share = Point(engine), size = box.high - box.low;
  return box.low + Vec3{share.x * size.x, share.y * size.y, share.z * size.z};
}

// A corner of the voxels of an even grid, or of a box.
Vec3 Corner(const Box3& bounds, const std::vector<Box3>& boxes, Engine& engine) {
  Vec3 corner;
  const bool of_box = !boxes.empty() && Below(2, engine) == 0;
  const Box3& box = of_box ? boxes[Below(boxes.size(), engine)] : bounds;
  const double parts = static_cast<double>(1 + Below(16, engine));
  for (int axis = 0; axis < 3; ++axis) {
    const double low = Component(box.low, axis), high = Component(box.high, axis);
    const double k = static_cast<double>(Below(static_cast<std::uint64_t>(parts) + 1, engine));
    Component(corner, axis) = of_box ? (Below(2, engine) == 0 ? low : high) : low + (high - low) / parts * k;
  }
  return corner;
}

Vec3 AxisDirection(Engine& engine) {
  Vec3 direction;
  Component(direction, static_cast<int>(Below(3, engine))) = Below(2, engine) == 0 ? 1 : -1;
  return direction;
}

RaySegment DrawRay(const std::vector<Box3>& boxes, const Box3& bounds, Engine& engine) {
  const double size = bounds.diagonal();
  const Vec3 outside = bounds.center() + size * Normalized(Direction(engine));
  const Vec3 target =
      boxes.empty() ? PointIn(bounds, engine) : PointIn(boxes[Below(boxes.size(), engine)], engine);
  RaySegment ray{outside, target - outside};
  switch (Below(10, engine)) {
    case 0:  // anywhere
      return {PointIn(bounds, engine), Direction(engine)};
    case 1:  // along an axis, through or in a face of a box
      ray.direction = AxisDirection(engine);
      ray.origin = Corner(bounds, boxes, engine) - 2 * size * ray.direction;
      return ray;
    case 2:  // in the plane of a face
      ray.origin = Corner(bounds, boxes, engine);
      ray.direction = Direction(engine);
      Component(ray.direction, static_cast<int>(Below(3, engine))) = 0;
      if (Below(2, engine) == 0) ray.origin = ray.origin - ray.direction;
      return ray;
    case 3: {  // through two corners
      ray.origin = Corner(bounds, boxes, engine);
      ray.direction = Corner(bounds, boxes, engine) - ray.origin;
      return ray;
    }
    case 4:  // from inside of a box
      return {target, Direction(engine)};
    case 5:  // with a component that is zero, denormal, or very small
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kSmall[] = {0.0, -0.0, 5e-324, -5e-324, 1e-310, 1e-200, -1e-40, 1e-17};
        if (Below(2, engine) == 0) Component(ray.direction, axis) = kSmall[Below(8, engine)];
      }
      return ray;
    case 6: {  // tiny and huge directions
      constexpr double kLengths[] = {1e-300, 1e-150, 1e-20, 1e20, 1e150, 1e290};
      ray.direction = kLengths[Below(6, engine)] * ray.direction;
      return ray;
    }
    case 7: {  // an interval within the scene
      const double a = 2 * Number(engine), b = 2 * Number(engine);
      ray.t_first = std::min(a, b);
      ray.t_last = std::max(a, b);
      return ray;
    }
    case 8: {  // from far away
      const double away = std::pow(10.0, static_cast<double>(Below(9, engine)));
      ray.origin = target + away * size * Normalized(Direction(engine));
      ray.direction = target - ray.origin;
      return ray;
    }
    default:
      return ray;
  }
}

// The parameters at which the line enters and leaves a box.
struct Interval {
  double in, out;
};
Interval IntervalOf(const Box3& box, const RaySegment& ray) {
  Interval interval{-INFINITY, INFINITY};
  for (int axis = 0; axis < 3; ++axis) {
    const double d = Component(ray.direction, axis), o = Component(ray.origin, axis);
    const double low = Component(box.low, axis), high = Component(box.high, axis);
    if (d == 0) {
      if (o < low || o > high) return {INFINITY, -INFINITY};
      continue;
    }
    interval.in = std::max(interval.in, ((d > 0 ? low : high) - o) / d);
    interval.out = std::min(interval.out, ((d > 0 ? high : low) - o) / d);
  }
  return interval;
}

}  // namespace

double Number(Engine& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

std::vector<Box3> DrawScene(SceneKind kind, std::size_t most, Engine& engine) {
  const std::size_t count = kind == SceneKind::kNone  ? 0
                            : kind == SceneKind::kOne ? 1
                                                      : 1 + Below(most, engine);
  std::vector<Vec3> clusters(4);
  for (Vec3& cluster : clusters) cluster = Point(engine);
  std::vector<Box3> boxes;
  for (std::size_t i = 0; i < count; ++i) boxes.push_back(DrawBox(kind, i, clusters, engine));
  return boxes;
}

std::vector<RaySegment> DrawRays(const std::vector<Box3>& boxes, std::size_t count, Engine& engine) {
  const Box3 bounds = BoundsOf(boxes);
  std::vector<RaySegment> rays;
  for (std::size_t i = 0; i < count; ++i) rays.push_back(DrawRay(boxes, bounds, engine));
  return rays;
}

bool MeetsExactly(const RaySegment& ray, const Box3& box, double margin) {
  long double in = ray.t_first, out = ray.t_last;
  for (int axis = 0; axis < 3; ++axis) {
    const long double d = Component(ray.direction, axis), o = Component(ray.origin, axis);
    const long double low = static_cast<long double>(Component(box.low, axis)) - margin,
                      high = static_cast<long double>(Component(box.high, axis)) + margin;
    if (d == 0) {
      if (o < low || o > high) return false;
      continue;
    }
    in = std::max(in, ((d > 0 ? low : high) - o) / d);
    out = std::min(out, ((d > 0 ? high : low) - o) / d);
  }
  const Vec3& d = ray.direction;
  return in <= out && (d.x != 0 || d.y != 0 || d.z != 0);
}

double Intersect(ObjectKind kind, const Box3& box, const RaySegment& ray) {
  const auto first_of = [&](double in, double out) {
    if (in >= ray.t_first && in <= ray.t_last) return in;
    return out >= ray.t_first && out <= ray.t_last ? out : INFINITY;
  };
  const Interval interval = IntervalOf(box, ray);
  if (kind == ObjectKind::kBox)
    return interval.in <= interval.out ? first_of(interval.in, interval.out) : INFINITY;
  // The largest component of the direction becomes 1, so that no square overflows.
  const double length =
      std::max({std::fabs(ray.direction.x), std::fabs(ray.direction.y), std::fabs(ray.direction.z)});
  if (!(length > 0)) return INFINITY;
  const Vec3 d{ray.direction.x / length, ray.direction.y / length, ray.direction.z / length};
  const Vec3 size = box.high - box.low, to_middle = box.center() - ray.origin;
  const double radius = 0.5 * std::min({size.x, size.y, size.z});
  const double middle = Dot(to_middle, d) / Dot(d, d);
  const Vec3 across = to_middle - middle * d;
  const double rest = radius * radius - Dot(across, across);
  if (!(rest >= 0)) return INFINITY;
  const double half = std::sqrt(rest / Dot(d, d));
  return first_of((middle - half) / length, (middle + half) / length);
}

void AskObject(ObjectKind kind, const std::vector<Box3>& boxes, const RaySegment& ray, std::uint32_t id,
               ObjectHit& nearest) {
  const double t = Intersect(kind, boxes[id], ray);
  if (t < INFINITY && (t < nearest.t || (t == nearest.t && id < nearest.id))) nearest = {t, id};
}

ObjectHit NearestByScan(ObjectKind kind, const std::vector<Box3>& boxes, const RaySegment& ray) {
  ObjectHit nearest;
  for (std::uint32_t id = 0; id < boxes.size(); ++id) AskObject(kind, boxes, ray, id, nearest);
  return nearest;
}

}  // namespace facetless::testing
