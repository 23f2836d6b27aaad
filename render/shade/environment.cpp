#include "render/shade/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "render/base/trigonometry.h"
#include "render/shade/studio.h"

namespace facetless {
namespace {

constexpr Vec3 kCeiling = {0.62, 0.64, 0.67}, kFloor = {0.20, 0.19, 0.18};
// The backdrop begins where the component of a direction away from the viewer is kBackdropBegins, and covers the room
// where it is kBackdropFull.
constexpr double kBackdropBegins = -0.15, kBackdropFull = 0.45;
constexpr double kSoftEdge = 0.06;  // width of the border of a soft box, as a cosine

// A rectangle on the unit sphere around `toward`, which shines evenly.
struct SoftBox {
  Vec3 toward, across, above;  // orthonormal
  double half_width, half_height;
  Vec3 light;
};

SoftBox MakeBox(Vec3 toward, double half_width, double half_height, Vec3 light) {
  const Vec3 across = Normalized(Cross({0, 1, 0}, toward));
  return {toward, across, Cross(toward, across), half_width, half_height, light};
}

// 0 below `begin`, 1 above `end`, and smooth between them.
double Ramp(double begin, double end, double x) {
  const double t = std::clamp((x - begin) / (end - begin), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double Cover(const SoftBox& box, Vec3 direction) {
  if (!(Dot(direction, box.toward) > 0)) return 0;
  const double x = std::fabs(Dot(direction, box.across)), y = std::fabs(Dot(direction, box.above));
  return (1 - Ramp(box.half_width - kSoftEdge, box.half_width + kSoftEdge, x)) *
         (1 - Ramp(box.half_height - kSoftEdge, box.half_height + kSoftEdge, y));
}

}  // namespace

Vec3 StudioSurroundings(Vec3 direction) {
  static const SoftBox kKeyBox = MakeBox(KeyDirection(), 0.42, 0.30, {2.3, 2.2, 2.05});
  static const SoftBox kFillBox = MakeBox(Normalized({0.82, 0.10, 0.45}), 0.14, 0.55, {0.95, 1.0, 1.08});
  const double up = 0.5 + 0.5 * direction.y;
  const double backdrop = Ramp(kBackdropBegins, kBackdropFull, -direction.z);
  const Vec3 room = (1 - up) * kFloor + up * kCeiling;
  Vec3 light = (1 - backdrop) * room + backdrop * StudioBackground();
  for (const SoftBox* box : {&kKeyBox, &kFillBox}) {
    const double cover = Cover(*box, direction);
    light = (1 - cover) * light + cover * box->light;
  }
  return light;
}

Surroundings::Surroundings(const CameraFrame& frame, std::shared_ptr<const RadianceMap> map, UpAxis up)
    : frame_(frame),
      map_(std::move(map)),
      up_(RotateToUpAxis(up, {0, 0, 1})),
      ahead_(RotateToUpAxis(up, {0, 1, 0})),
      right_(RotateToUpAxis(up, {1, 0, 0})) {}

Vec3 Surroundings::Light(Vec3 direction) const {
  if (map_ == nullptr)
    return StudioSurroundings(
        {Dot(direction, frame_.right), -Dot(direction, frame_.down), -Dot(direction, frame_.forward)});
  constexpr double kPi = std::numbers::pi;
  const double x = Dot(direction, right_), y = Dot(direction, ahead_), z = Dot(direction, up_);
  // The angle to the right of `ahead`, by the half-angle formula, whose only special case is straight behind.
  const double across = std::sqrt(x * x + y * y);
  const double turn = y > 0 || x != 0 ? 2 * PolyAtan(x / (across + y)) : kPi;
  const double height = 2 * PolyAtan(z / (1 + across));  // above the horizon
  return map_->At(0.5 + turn / (2 * kPi), 0.5 - height / kPi);
}

}  // namespace facetless
