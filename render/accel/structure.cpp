#include "render/accel/structure.h"

#include <bit>
#include <cstdlib>
#include <limits>

namespace facetless {
namespace {

// The margin of boxes, as a share of the scene's size.
constexpr double kMargin = 0x1p-40;
// The scene's size is at least this share of its largest coordinate: below it, coordinates are so coarse that
// the next number is farther away than the margin.
constexpr double kCoarsest = 0x1p-20;
constexpr double kLeastScale = 1e-280;
// A plane is passed with a relative error below 2^-51 of its distance from the origin. Up to 2^10 sizes away,
// that is half of the margin.
constexpr double kReach = 0x1p10;
constexpr double kLeastComponent = 0x1p-200;
// Entries and exits are moved by 2^-50 of their t, more than the errors of four roundings.
constexpr double kSlack = 0x1p-50;

double Outward(double at, double margin, double towards) {
  const double moved = towards < 0 ? at - margin : at + margin;
  const double next = std::nextafter(at, towards);
  return towards < 0 ? std::min(moved, next) : std::max(moved, next);
}

// The power of two that brings the largest component of a direction into [1, 2).
class Scaling {
 public:
  explicit Scaling(double largest) {
    // A normal number's exponent is in its bits. Other powers have no representable inverse, or nearly so.
    exponent_ = static_cast<int>(std::bit_cast<std::uint64_t>(largest) >> 52) - kBias;
    plain_ = std::abs(exponent_) <= kPlain;
    if (!plain_) exponent_ = std::ilogb(largest);
    factor_ = plain_ ? PowerOfTwo(-exponent_) : 0;
  }
  double Direction(double component) const {
    return plain_ ? component * factor_ : std::scalbn(component, -exponent_);
  }
  double unit() const { return plain_ ? PowerOfTwo(exponent_) : std::scalbn(1.0, exponent_); }

 private:
  static constexpr int kBias = 1023, kPlain = 1000;
  static double PowerOfTwo(int exponent) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kBias) << 52);
  }

  int exponent_;
  bool plain_;
  double factor_;
};

}  // namespace

SlabBox UnionOf(const SlabBox& a, const SlabBox& b) {
  SlabBox both;
  for (int axis = 0; axis < 3; ++axis) {
    both.side[0][axis] = std::min(a.side[0][axis], b.side[0][axis]);
    both.side[1][axis] = std::max(a.side[1][axis], b.side[1][axis]);
  }
  return both;
}

double HalfSurface(const SlabBox& box) {
  const Vec3 size = box.high() - box.low();
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

QueryState::QueryState(StateSize size) : stamps_(size.stamps, 0), words_(size.words, 0), stack_(size.stack) {
  touched_.reserve(size.words);
}

void QueryState::ForgetRays() {
  std::fill(stamps_.begin(), stamps_.end(), 0);
  ray_ = 1;
}

std::size_t QueryState::bytes() const {
  return (stamps_.capacity() + touched_.capacity()) * sizeof(std::uint32_t) +
         words_.capacity() * sizeof(std::uint64_t) + stack_.capacity() * sizeof(Waiting);
}

BoxSet::BoxSet(std::span<const Box3> boxes) : size_(static_cast<std::uint32_t>(boxes.size())) {
  if (boxes.empty()) return;
  Box3 bounds;
  for (const Box3& box : boxes) {
    bounds.Add(box.low);
    bounds.Add(box.high);
  }
  const Vec3 size = bounds.high - bounds.low;
  const double extent = std::max({size.x, size.y, size.z});
  double largest = 0;
  for (const double at :
       {bounds.low.x, bounds.low.y, bounds.low.z, bounds.high.x, bounds.high.y, bounds.high.z})
    largest = std::max(largest, std::fabs(at));
  scale_ = std::max({extent, kCoarsest * largest, kLeastScale});
  margin_ = kMargin * scale_;
  const auto enlarged = [&](const Box3& box) {
    constexpr double kUp = std::numeric_limits<double>::infinity();
    const double m = margin_;
    return SlabBox{{{Outward(box.low.x, m, -kUp), Outward(box.low.y, m, -kUp), Outward(box.low.z, m, -kUp)},
                    {Outward(box.high.x, m, kUp), Outward(box.high.y, m, kUp), Outward(box.high.z, m, kUp)}}};
  };
  boxes_.reserve(boxes.size());
  for (const Box3& box : boxes) boxes_.push_back(enlarged(box));
  bounds_ = enlarged(bounds);
}

bool BoxSet::Enter(const RaySegment& segment, SlabRay& ray) const {
  if (size_ == 0) return false;
  const double origin[3] = {segment.origin.x, segment.origin.y, segment.origin.z};
  const double direction[3] = {segment.direction.x, segment.direction.y, segment.direction.z};
  const double largest =
      std::max({std::fabs(direction[0]), std::fabs(direction[1]), std::fabs(direction[2])});
  bool finite = largest > 0 && std::isfinite(largest);
  for (int axis = 0; axis < 3; ++axis) finite &= std::isfinite(origin[axis]) && !std::isnan(direction[axis]);
  if (!finite || !(segment.t_first <= segment.t_last)) return false;

  // Scale the direction by a power of two, and t by its inverse.
  const Scaling scaling(largest);
  for (int axis = 0; axis < 3; ++axis) {
    const double scaled = scaling.Direction(direction[axis]);
    const double component =
        std::fabs(scaled) < kLeastComponent ? std::copysign(kLeastComponent, scaled) : scaled;
    ray.origin[axis] = origin[axis];
    ray.direction[axis] = component;
    ray.inverse[axis] = 1 / component;
    ray.near_inverse[axis] = ray.inverse[axis] * (1 - kSlack);
    ray.far_inverse[axis] = ray.inverse[axis] * (1 + kSlack);
    ray.near_side[axis] = component < 0 ? 1 : 0;
  }
  ray.unit = scaling.unit();
  ray.t_first = segment.t_first * ray.unit;
  ray.t_last = segment.t_last * ray.unit;

  // Clip the interval to the box of the scene.
  double t_in, t_out;
  if (!Meets(ray, bounds_, t_in, t_out)) return false;
  ray.t_first = t_in;
  ray.t_last = t_out;
  return true;
}

bool BoxSet::TooFar(const SlabRay& ray) const {
  double away = 0;
  for (int axis = 0; axis < 3; ++axis)
    away =
        std::max({away, bounds_.side[0][axis] - ray.origin[axis], ray.origin[axis] - bounds_.side[1][axis]});
  return !(away <= kReach * scale_);
}

}  // namespace facetless
