#include "render/accel/volume_choice.h"

#include <cmath>
#include <numbers>
#include <random>

#include "render/accel/box_list.h"
#include "render/base/stopwatch.h"

namespace facetless {
namespace {

constexpr double kIntersectionInTests = 10;  // I(o) in tests of a box, where it is not known

double VolumeOf(const SlabBox& box) {
  const Vec3 size = box.high() - box.low();
  return size.x * size.y * size.z;
}

double BallVolume(double radius) {
  return 4.0 / 3 * std::numbers::pi * radius * radius * radius;
}

// The surface of a ball of that volume: the least surface that a body of the volume can have.
double BallSurface(double volume) {
  return std::cbrt(36 * std::numbers::pi * volume * volume);
}

// The time of one test of a volume in a plain list, in nanoseconds: the shortest of a few runs.
template <typename List>
double MeasureList(const List& list, std::span<const RaySegment> rays) {
  constexpr int kRepeats = 7;
  QueryState state(list.state_size());
  double best = INFINITY;
  std::uint64_t met = 0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    state.counters = {};
    const Stopwatch stopwatch;
    for (const RaySegment& ray : rays)
      list.Visit(ray, state, [&](std::uint32_t id) {
        met += id;
        return INFINITY;
      });
    best = std::min(best, 1e6 * stopwatch.Milliseconds() / static_cast<double>(state.counters.tests));
  }
  // The sum is used, or the compiler would leave tests out.
  return met > 0 ? best : INFINITY;
}

}  // namespace

VolumeCosts MeasureVolumeCosts() {
  // Small boxes in the unit cube, of which a ray meets about one in a thousand.
  constexpr std::size_t kVolumes = 5000, kRays = 100;
  constexpr double kSize = 0.03;
  std::mt19937_64 engine(1);
  const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Box3> boxes;
  for (std::size_t i = 0; i < kVolumes; ++i) {
    const Vec3 low{number(), number(), number()};
    boxes.push_back({low, low + kSize * Vec3{number(), number(), number()}});
  }
  std::vector<RaySegment> rays;
  for (std::size_t i = 0; i < kRays; ++i)
    rays.push_back({{number(), number(), number()}, {number() - 0.5, number() - 0.5, number() - 0.5}});
  return {MeasureList(BoxList(boxes), rays), MeasureList(SphereList(boxes), rays)};
}

double TotalCost(double rays, double volume_ns, double meeting, double intersect_ns) {
  return rays * volume_ns + meeting * intersect_ns;
}

double Fit(double object_volume, double bounding_volume) {
  return object_volume > 0 && bounding_volume > 0 ? object_volume / bounding_volume : 0;
}

double MeetingShare(Volume volume, const SlabBox& box, double object_volume, double scene_surface) {
  if (!(scene_surface > 0)) return 1;
  const double radius = SphereAround(box, 0).radius;
  const double fit = Fit(object_volume, volume == Volume::kBox ? VolumeOf(box) : BallVolume(radius));
  const double surface =
      volume == Volume::kBox ? 2 * HalfSurface(box) : 4 * std::numbers::pi * radius * radius;
  const double share = fit > 0 ? BallSurface(object_volume) / fit : surface;
  return std::min(1.0, share / scene_surface);
}

Volume ChooseVolume(const SlabBox& box, const ObjectCost& object, const VolumeCosts& costs,
                    double scene_surface) {
  const auto cost = [&](Volume volume, double ns) {
    return TotalCost(1, ns, MeetingShare(volume, box, object.volume, scene_surface), object.intersect_ns);
  };
  return cost(Volume::kSphere, costs.sphere_ns) < cost(Volume::kBox, costs.box_ns) ? Volume::kSphere
                                                                                   : Volume::kBox;
}

VolumeChoice::VolumeChoice(std::span<const Box3> boxes, std::span<const ObjectCost> objects,
                           const VolumeCosts& costs)
    : boxes_(boxes) {
  const double scene_surface = 2 * HalfSurface(boxes_.bounds()), margin = SphereMargin(boxes_);
  for (std::uint32_t id = 0; id < boxes_.size(); ++id) {
    const SlabBox& box = boxes_[id];
    const ObjectCost object = objects.empty() ? ObjectCost{std::numbers::pi / 6 * VolumeOf(box),
                                                           kIntersectionInTests * costs.box_ns}
                                              : objects[id];
    const double with_box = TotalCost(
        1, costs.box_ns, MeetingShare(Volume::kBox, box, object.volume, scene_surface), object.intersect_ns);
    const double with_sphere =
        TotalCost(1, costs.sphere_ns, MeetingShare(Volume::kSphere, box, object.volume, scene_surface),
                  object.intersect_ns);
    all_boxes_ns_ += with_box;
    all_spheres_ns_ += with_sphere;
    if (ChooseVolume(box, object, costs, scene_surface) == Volume::kSphere) {
      chosen_ns_ += with_sphere;
      in_spheres_.push_back(id);
      spheres_.push_back(SphereAround(box, margin));
    } else {
      chosen_ns_ += with_box;
      in_boxes_.push_back(id);
    }
  }
}

}  // namespace facetless
