#include "bench/box_scene.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace facetless {
namespace {

const Vec3 kEye{kSceneSize / 2.0, kSceneSize / 2.0, -kEyeDistance};

// The range of pixels that an object covers on the screen.
struct PixelRange {
  double low = INFINITY, high = -INFINITY;
  void Add(double x) { low = std::min(low, x), high = std::max(high, x); }
};

}  // namespace

std::vector<SceneBox> RandomBoxes(int objects, int size, bool perspective, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<SceneBox> boxes;
  for (int k = 0; k < objects; ++k) {
    const double x = static_cast<double>(engine() % kSceneSize) - size / 2,
                 y = static_cast<double>(engine() % kSceneSize) - size / 2,
                 z = static_cast<double>(engine() % kSceneSize);
    const Vec3 low{x, y, 0}, high{x + size, y + size, 0};
    // Move the box away from the eye, along the rays through the corners of its front face.
    const double scale = perspective ? 1 + z / kEyeDistance : 1;
    SceneBox box{kEye + scale * (low - kEye), kEye + scale * (high - kEye)};
    box.low.z = z;
    box.high.z = z + scale * size;
    boxes.push_back(box);
  }
  return boxes;
}

SceneRay ScenePixelRay(int x, int y, bool perspective) {
  const Vec3 through{static_cast<double>(x), static_cast<double>(y), 0};
  return {through.x, through.y, perspective ? Normalized(through - kEye) : Vec3{0, 0, 1}};
}

BoxScan::BoxScan(const std::vector<SceneBox>& boxes, bool perspective)
    : perspective_(perspective), boxes_(boxes) {
  for (const SceneBox& box : boxes) rectangles_.push_back({box.low.x, box.high.x, box.low.y, box.high.y});
}

bool BoxScan::MeetsBox(const SceneBox& box, const SceneRay& ray) {
  double enter = 0, leave = INFINITY;
  const auto cut = [&](double low, double high, double origin, double direction) {
    const double inverse = 1 / direction, a = (low - origin) * inverse, b = (high - origin) * inverse;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  };
  // No direction is parallel to the image plane. In x and y, a division by zero gives the infinities that the
  // following code expects.
  cut(box.low.z, box.high.z, kEye.z, ray.direction.z);
  cut(box.low.x, box.high.x, kEye.x, ray.direction.x);
  cut(box.low.y, box.high.y, kEye.y, ray.direction.y);
  return enter <= leave;
}

SphereScan::SphereScan(const std::vector<SceneBox>& boxes, bool perspective) : perspective_(perspective) {
  // The slack keeps a ray that touches the sphere despite rounding.
  constexpr double kSlack = 1e-9;
  for (const SceneBox& box : boxes) {
    const Vec3 middle = 0.5 * (box.low + box.high);
    if (perspective) {
      const Vec3 from_eye = middle - kEye;
      const double radius = 0.5 * Length(box.high - box.low) + kSlack;
      spheres_.push_back({from_eye, Dot(from_eye, from_eye) - radius * radius});
    } else {
      const double radius = 0.5 * std::hypot(box.high.x - box.low.x, box.high.y - box.low.y) + kSlack;
      circles_.push_back({middle.x, middle.y, radius * radius});
    }
  }
}

RowColumnBitmaps::RowColumnBitmaps(const std::vector<SceneBox>& boxes, bool perspective)
    : words_((boxes.size() + 63) / 64), bits_(2 * kSceneSize * words_, 0) {
  // The slack keeps a box that touches a plane despite rounding.
  constexpr double kSlack = 1e-9;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    PixelRange x, y;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p{corner & 1 ? boxes[k].high.x : boxes[k].low.x,
                   corner & 2 ? boxes[k].high.y : boxes[k].low.y,
                   corner & 4 ? boxes[k].high.z : boxes[k].low.z};
      const double scale = perspective ? kEyeDistance / (p.z - kEye.z) : 1;
      x.Add(kEye.x + scale * (p.x - kEye.x));
      y.Add(kEye.y + scale * (p.y - kEye.y));
    }
    const std::uint64_t bit = std::uint64_t{1} << (k % 64);
    const auto set = [&](const PixelRange& range, int first) {
      const int begin = std::max(0, static_cast<int>(std::ceil(range.low - kSlack))),
                end = std::min(kSceneSize - 1, static_cast<int>(std::floor(range.high + kSlack)));
      for (int i = begin; i <= end; ++i) bits_[static_cast<std::size_t>(first + i) * words_ + k / 64] |= bit;
    };
    set(y, 0);
    set(x, kSceneSize);
  }
}

}  // namespace facetless
