// A method for tests: the model's bounding box, scaled about its centre to a given percentage. It is an
// example of a representation that the program does not know: this file with its last line is all that a new
// representation needs. A program that is linked with this file compares and measures boxes together with its
// own methods.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/compare/method.h"

namespace facetless {
namespace {

// The point at which a ray enters a box, and the outward normal there.
struct Entry {
  double depth = INFINITY;
  std::array<float, 3> normal{};
};

Entry Enter(const Box3& box, const Ray& ray, double nearest) {
  double enter = nearest, leave = INFINITY;
  std::array<float, 3> normal{};
  const double origin[] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const double direction[] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const double low[] = {box.low.x, box.low.y, box.low.z}, high[] = {box.high.x, box.high.y, box.high.z};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0 && (origin[axis] < low[axis] || origin[axis] > high[axis])) return {};
    if (direction[axis] == 0) continue;
    const double sign = direction[axis] > 0 ? 1 : -1;
    const double near = ((sign > 0 ? low[axis] : high[axis]) - origin[axis]) / direction[axis];
    const double far = ((sign > 0 ? high[axis] : low[axis]) - origin[axis]) / direction[axis];
    if (near > enter) {
      enter = near;
      normal = {};
      normal[static_cast<std::size_t>(axis)] = static_cast<float>(-sign);
    }
    leave = std::min(leave, far);
  }
  if (enter > leave || normal == std::array<float, 3>{}) return {};
  return {enter, normal};
}

class BoundingBox final : public Representation {
 public:
  BoundingBox(const MethodInput& input, double percent) : name_(input.name), title_(input.title) {
    const Stopwatch stopwatch;
    const Box3& bounds = input.scene.model().bounds;
    const Vec3 center = 0.5 * (bounds.low + bounds.high);
    const Vec3 half = 0.5 * percent / 100 * (bounds.high - bounds.low);
    box_ = {center - half, center + half};
    make_ms_ = stopwatch.Milliseconds();
  }

  std::string name() const override { return name_; }
  std::string title() const override { return title_; }
  double make_ms() const override { return make_ms_; }
  std::vector<RepresentationFact> facts() const override { return {{"boxes", 1}}; }
  bool names_faces() const override { return false; }

  Result<TracedView> Trace(const Camera& camera, const TraceRequest&,
                           const Execution& execution) const override {
    auto frame = MakeFrame(camera, Length(box_.high - box_.low));
    if (!frame.ok()) return frame.error();
    TracedView view;
    view.frame = frame.value();
    const double nearest = camera.projection == Projection::kPerspective ? view.frame.near_mm : -INFINITY;
    SampleBuffer& samples = view.samples;
    samples.Resize(camera.width_px, camera.height_px);
    const Stopwatch stopwatch;
    RunWithThreads(execution.threads, [&] {
      ParallelFor(0, samples.height, [&](int y) {
        if (execution.cancelled()) return;
        for (int x = 0; x < samples.width; ++x) {
          const Entry entry = Enter(box_, PixelRay(view.frame, x + 0.5, y + 0.5), nearest);
          const std::size_t i = static_cast<std::size_t>(y) * samples.width + x;
          if (entry.depth == INFINITY) continue;
          samples.depth[i] = entry.depth;
          samples.normal[i] = entry.normal;
          samples.face[i] = 0;
        }
      });
    });
    if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing a box"};
    view.counters.trace_ms = stopwatch.Milliseconds();
    view.counters.rays = samples.size();
    for (const double depth : samples.depth) view.counters.hits += depth != INFINITY;
    view.structure_bytes = sizeof *this;
    return view;
  }

 private:
  const std::string name_, title_;
  Box3 box_;
  double make_ms_ = 0;
};

Result<std::unique_ptr<const Representation>> MakeBox(const MethodInput& input, double percent) {
  if (!(percent > 0 && percent <= 100))
    return Error{ErrorCode::kBadUsage, "a box has a size of more than 0 and up to 100 per cent"};
  return std::unique_ptr<const Representation>(std::make_unique<BoundingBox>(input, percent));
}

const RegisterMethod kBox({.name = "box",
                           .title = "Box",
                           .help = "The bounding box.",
                           .setting = "size, per cent",
                           .usual = {50, 100},
                           .make = MakeBox});

}  // namespace
}  // namespace facetless
