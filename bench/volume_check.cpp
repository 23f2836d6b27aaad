#include "bench/volume_check.h"

#include <cmath>

#include "bench/statistics.h"
#include "bench/structure_bench.h"
#include "render/accel/box_list.h"

namespace facetless {
namespace {

constexpr int kRepeats = 3;
// Enough for the clock, and a moment for the reader.
constexpr double kMostTests = 2e6;

// The object of law 1. The start of the ray is moved by nothing that matters, so that no test can be left
// out.
double EnterRepeatedly(const BoxEntry& object, int times, std::uint32_t id, RaySegment ray) {
  double t = INFINITY;
  for (int i = 0; i < times; ++i) {
    ray.t_last = std::nextafter(ray.t_last, 0);
    t = std::fmin(t, object(id, ray));
  }
  return t;
}

// The time of a ray in nanoseconds.
template <typename List>
double MeasureList(const List& list, const BoxEntry& object, int times, std::span<const RaySegment> rays) {
  QueryState state(list.state_size());
  double sum = 0;
  const auto runs = TakeTurns(kRepeats, {[&] {
                                for (const RaySegment& ray : rays)
                                  list.Visit(ray, state, [&](std::uint32_t id) {
                                    sum += std::fmin(1, EnterRepeatedly(object, times, id, ray));
                                    return INFINITY;
                                  });
                              }});
  // The sum is used, or the compiler would leave the tests out.
  return std::isnan(sum) ? sum : 1e6 * Median(runs.front()) / static_cast<double>(rays.size());
}

// The time of an object's intersection.
double MeasureObject(const BoxEntry& object, int times, std::span<const RaySegment> rays) {
  double sum = 0;
  const std::size_t objects = std::min<std::size_t>(object.boxes.size(), 1000);
  const auto runs =
      TakeTurns(kRepeats, {[&] {
                  for (const RaySegment& ray : rays.first(std::min<std::size_t>(rays.size(), 100)))
                    for (std::uint32_t id = 0; id < objects; ++id)
                      sum += std::fmin(1, EnterRepeatedly(object, times, id, ray));
                }});
  const double tests = static_cast<double>(objects * std::min<std::size_t>(rays.size(), 100));
  return std::isnan(sum) ? sum : 1e6 * Median(runs.front()) / tests;
}

}  // namespace

std::vector<VolumeCheck> CheckVolumeModel(const std::vector<Box3>& boxes, std::span<const RaySegment> rays) {
  const auto few = static_cast<std::size_t>(kMostTests / static_cast<double>(boxes.size())) + 1;
  rays = rays.first(std::min(rays.size(), few));
  const BoxEntry object{boxes};
  const VolumeCosts costs = MeasureVolumeCosts();
  std::vector<VolumeCheck> checks;
  for (const int times : {kLightObject, kHeavyObject}) {
    VolumeCheck check;
    check.intersect_ns = MeasureObject(object, times, rays);
    std::vector<ObjectCost> objects;
    for (const Box3& box : boxes) {
      const Vec3 size = box.high - box.low;
      objects.push_back({size.x * size.y * size.z, check.intersect_ns});
    }
    const VolumeChoice chosen(boxes, objects, costs);
    check.boxes = chosen.boxes();
    check.spheres = chosen.spheres();
    check.all_boxes = {chosen.all_boxes_ns(), MeasureList(BoxList(boxes), object, times, rays)};
    check.all_spheres = {chosen.all_spheres_ns(), MeasureList(SphereList(boxes), object, times, rays)};
    check.chosen = {chosen.chosen_ns(), MeasureList(chosen, object, times, rays)};
    checks.push_back(check);
  }
  return checks;
}

Table VolumeTable(const std::string& scene, const std::vector<VolumeCheck>& checks) {
  Table table;
  table.title = "Cost model of bounding volumes: " + scene;
  table.columns = {"I(o)",           "spheres chosen", "boxes: model",  "measured",
                   "spheres: model", "measured",       "chosen: model", "measured"};
  const auto text = [](double ns) { return ThreeDigits(1e-3 * ns) + " us"; };
  for (const VolumeCheck& check : checks) {
    std::vector<std::string> row = {
        ThreeDigits(check.intersect_ns) + " ns",
        std::to_string(check.spheres) + " of " + std::to_string(check.boxes + check.spheres)};
    for (const VolumeCheck::Cost& cost : {check.all_boxes, check.all_spheres, check.chosen}) {
      row.push_back(text(cost.predicted_ns));
      row.push_back(text(cost.measured_ns));
    }
    table.rows.push_back(std::move(row));
  }
  table.notes = {
      "Per ray, over all objects: n·B(v) + m(v)·I(o), and the clock. The second row's object stands for "
      "an intersection with a surface."};
  return table;
}

nlohmann::json VolumeJson(const std::vector<VolumeCheck>& checks) {
  nlohmann::json rows = nlohmann::json::array();
  const auto cost = [](const VolumeCheck::Cost& c) {
    return nlohmann::json{{"predicted_ns", c.predicted_ns}, {"measured_ns", c.measured_ns}};
  };
  for (const VolumeCheck& check : checks)
    rows.push_back({{"intersect_ns", check.intersect_ns},
                    {"boxes_chosen", check.boxes},
                    {"spheres_chosen", check.spheres},
                    {"all_boxes", cost(check.all_boxes)},
                    {"all_spheres", cost(check.all_spheres)},
                    {"chosen", cost(check.chosen)}});
  return rows;
}

}  // namespace facetless
