#include "render/solve/clip.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace facetless {
namespace {

// The largest power of two that is not above x. Requires a normal, positive x.
double PowerBelow(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000u);
}

// The part of a convex function at or below zero. `values` are those of the function at i/degree for the indices `hull`
// (`count` of them), between which it is linear.
ClipInterval NotAbove(const std::array<double, kMaxDegree + 1>& values,
                      const std::array<int, kMaxDegree + 1>& hull, int count, int degree) {
  int first = 0, last = count - 1;
  while (first < count && !(values[hull[first]] <= 0)) ++first;
  if (first == count) return {};
  while (!(values[hull[last]] <= 0)) --last;
  const auto crossing = [&](int inside, int outside) {
    const double in = values[hull[inside]], out = values[hull[outside]];
    return (hull[inside] + (hull[outside] - hull[inside]) * (in / (in - out))) / degree;
  };
  return {first == 0 ? 0 : std::max(0.0, crossing(first, first - 1)),
          last == count - 1 ? 1 : std::min(1.0, crossing(last, last + 1))};
}

// The same for the lower convex hull of the points (i/degree, values[i]), by Andrew's monotone chain.
ClipInterval HullNotAbove(const std::array<double, kMaxDegree + 1>& values, int degree) {
  std::array<int, kMaxDegree + 1> hull;
  int count = 0;
  for (int i = 0; i <= degree; ++i) {
    while (count >= 2) {
      const int a = hull[count - 2], b = hull[count - 1];
      if ((values[b] - values[a]) * (i - a) < (values[i] - values[a]) * (b - a)) break;
      --count;
    }
    hull[count++] = i;
  }
  return NotAbove(values, hull, count, degree);
}

// Replaces the rows of a net by those of its part [0, t] along u. A row has `width` numbers.
void KeepLower(double* rows, int degree, int width, double t) {
  const double s = 1 - t;
  for (int r = 1; r <= degree; ++r)
    for (int i = degree; i >= r; --i) {
      double* row = rows + i * width;
      const double* before = row - width;
      for (int j = 0; j < width; ++j) row[j] = s * before[j] + t * row[j];
    }
}

// The same for [t, 1].
void KeepUpper(double* rows, int degree, int width, double t) {
  const double s = 1 - t;
  for (int r = 1; r <= degree; ++r)
    for (int i = 0; i <= degree - r; ++i) {
      double* row = rows + i * width;
      const double* after = row + width;
      for (int j = 0; j < width; ++j) row[j] = s * row[j] + t * after[j];
    }
}

// The sum of the absolute values that a projected point is computed from: the components of the point and of the eye, seen
// from the middle of the scene, in pixels. In a perspective view, W is computed from them, too, and is multiplied by the
// pixel's coordinate.
double ProjectionTerms(const SolverScene& scene, const Vec4& point, double coordinate) {
  const CameraFrame& frame = scene.frame();
  const Vec3 eye = frame.eye - scene.origin();
  const double sum = std::fabs(point.x) + std::fabs(point.y) + std::fabs(point.z) +
                     point.w * (std::fabs(eye.x) + std::fabs(eye.y) + std::fabs(eye.z));
  const double pixels = 1 / std::min(frame.pixel_x, frame.pixel_y);
  return sum * (frame.projection == Projection::kPerspective ? pixels + coordinate : pixels);
}

}  // namespace

int MostPoints(const SolverScene& scene) {
  int most = 0;
  for (const SolverPatch& patch : scene.patches()) most = std::max(most, patch.points());
  return most;
}

NetStack::NetStack(int most_points, bool with_terms)
    : numbers_(static_cast<std::size_t>(kMostNets) * (with_terms ? 3 : 2) *
               static_cast<std::size_t>(most_points)) {
  double* free = numbers_.data();
  const auto take = [&] {
    double* const taken = free;
    free += most_points;
    return taken;
  };
  for (RayNet& net : nets_) {
    net.f = take();
    net.g = take();
    if (with_terms) net.terms = take();
  }
}

bool NetStack::Load(const SolverScene& scene, const SolverPatch& patch, const SolverRay& ray) {
  count_ = 0;
  RayNet& net = nets_[0];
  net.degree_u = patch.degree_u;
  net.degree_v = patch.degree_v;
  net.u_low = net.v_low = 0;
  net.u_high = net.v_high = 1;
  net.next = ClipAxis::kU;
  const ViewProjection::Point* points = scene.screen(patch);
  double largest = 0;
  bool finite = true;
  for (int k = 0; k < patch.points(); ++k) {
    const ViewProjection::Point& p = points[k];
    const double xw = ray.x * p.w, yw = ray.y * p.w;
    net.f[k] = p.x - xw;
    net.g[k] = p.y - yw;
    largest = std::max({largest, std::fabs(net.f[k]), std::fabs(net.g[k])});
    finite = finite && std::isfinite(net.f[k]) && std::isfinite(net.g[k]);
    if (net.terms != nullptr)
      net.terms[k] =
          std::max(std::fabs(p.x) + std::fabs(xw), std::fabs(p.y) + std::fabs(yw)) +
          ProjectionTerms(scene, scene.space(patch)[k], std::max(std::fabs(ray.x), std::fabs(ray.y)));
  }
  if (!finite) return false;
  count_ = 1;
  // Below the least normal numbers, there is nothing to scale.
  scale_ = largest >= 0x1p-1000 ? 1 / PowerBelow(largest) : 1;
  for (double* numbers : {net.f, net.g, net.terms})
    if (numbers != nullptr)
      for (int k = 0; k < patch.points(); ++k) numbers[k] *= scale_;
  // The projected point, the product and the difference are rounded, and so is a point of the surface that is evaluated
  // elsewhere: once for each degree.
  net.roundings = 8 + patch.degree_u + patch.degree_v;
  return true;
}

void NetStack::Halve(ClipAxis axis) {
  RayNet& upper = nets_[static_cast<std::size_t>(count_ - 1)];
  RayNet& lower = nets_[static_cast<std::size_t>(count_)];
  ++count_;
  double* const numbers[] = {lower.f, lower.g, lower.terms};
  std::copy_n(upper.f, upper.points(), lower.f);
  std::copy_n(upper.g, upper.points(), lower.g);
  if (upper.terms != nullptr) std::copy_n(upper.terms, upper.points(), lower.terms);
  lower = upper;
  lower.f = numbers[0];
  lower.g = numbers[1];
  lower.terms = numbers[2];
  Restrict(upper, axis, 0.5, 1);
  Restrict(lower, axis, 0, 0.5);
}

double Largest(const RayNet& net) {
  double largest = 0;
  for (int k = 0; k < net.points(); ++k)
    largest = std::max({largest, std::fabs(net.f[k]), std::fabs(net.g[k])});
  return largest;
}

double RoundingError(const RayNet& net) {
  double largest = 0;
  for (int k = 0; k < net.points(); ++k) largest = std::max(largest, net.terms[k]);
  return net.roundings * 0x1p-53 * largest;
}

Vec2 SideSum(const RayNet& net, ClipAxis axis) {
  const int last_v = net.degree_v, first_of_last = net.degree_u * (net.degree_v + 1);
  const auto at = [&](int k) { return Vec2{net.f[k], net.g[k]}; };
  const Vec2 opposite = at(first_of_last + last_v) - at(0);
  // P(1,1) − P(0,0) occurs in both sums; the other diagonal is added or subtracted.
  const Vec2 across = at(first_of_last) - at(last_v);
  return axis == ClipAxis::kU ? opposite + across : opposite - across;
}

DistanceBand Distances(const RayNet& net, ClipAxis axis, Vec2 normal) {
  DistanceBand band;
  band.degree = net.degree(axis);
  for (int i = 0; i <= band.degree; ++i) {
    band.low[i] = INFINITY;
    band.high[i] = -INFINITY;
  }
  int k = 0;
  for (int i = 0; i <= net.degree_u; ++i)
    for (int j = 0; j <= net.degree_v; ++j, ++k) {
      const double distance = normal.x * net.f[k] + normal.y * net.g[k];
      const int at = axis == ClipAxis::kU ? i : j;
      band.low[at] = std::min(band.low[at], distance);
      band.high[at] = std::max(band.high[at], distance);
    }
  return band;
}

ClipInterval ZeroInterval(const DistanceBand& band, double slack) {
  std::array<double, kMaxDegree + 1> low, negated_high;
  for (int i = 0; i <= band.degree; ++i) {
    low[i] = band.low[i] - slack;
    negated_high[i] = -(band.high[i] + slack);
  }
  const ClipInterval below = HullNotAbove(low, band.degree);
  const ClipInterval above = HullNotAbove(negated_high, band.degree);
  if (below.empty() || above.empty()) return {};
  // The upper hull is not below the lower one, so that both parts meet. Where they meet in a point, rounding may turn the
  // ends round.
  const double from = std::max(below.low, above.low), to = std::min(below.high, above.high);
  return {std::min(from, to), std::max(from, to)};
}

void RestrictNumbers(double* numbers, int degree_u, int degree_v, ClipAxis axis, double low, double high) {
  // Cut off what lies above, then what lies below.
  const double rest = high > 0 ? std::min(low / high, 1.0) : 0;
  const int width = degree_v + 1;
  if (axis == ClipAxis::kU) {
    if (high < 1) KeepLower(numbers, degree_u, width, high);
    if (rest > 0) KeepUpper(numbers, degree_u, width, rest);
    return;
  }
  for (int i = 0; i <= degree_u; ++i) {
    if (high < 1) KeepLower(numbers + i * width, degree_v, 1, high);
    if (rest > 0) KeepUpper(numbers + i * width, degree_v, 1, rest);
  }
}

void Restrict(RayNet& net, ClipAxis axis, double low, double high) {
  RestrictNumbers(net.f, net.degree_u, net.degree_v, axis, low, high);
  RestrictNumbers(net.g, net.degree_u, net.degree_v, axis, low, high);
  if (net.terms != nullptr) RestrictNumbers(net.terms, net.degree_u, net.degree_v, axis, low, high);
  // Each of the two cuts takes as many rounds as the degree, and a round rounds two factors, two products and a sum of
  // convex combinations.
  net.roundings += 2 * 3 * net.degree(axis);
  double& from = axis == ClipAxis::kU ? net.u_low : net.v_low;
  double& to = axis == ClipAxis::kU ? net.u_high : net.v_high;
  const double start = from, size = to - from;
  from = low > 0 ? start + low * size : start;
  to = high < 1 ? start + high * size : to;
}

}  // namespace facetless
