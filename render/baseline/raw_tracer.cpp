#include "render/baseline/raw_tracer.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/baseline/packet_rays.h"

namespace facetless {
namespace {

constexpr int kLanes = kPacket * kPacket;

// One coordinate of the origins or directions of all rays, which is linear in the pixel's coordinates.
struct LinearCoordinate {
  float first = 0, per_column = 0, per_row = 0;
  float At(float column, float row) const { return first + column * per_column + row * per_row; }
};

// The rays of a view in float32, relative to the centre of the mesh.
struct StepRays {
  LinearCoordinate origin[3], direction[3];
};

class RawTracer {
 public:
  RawTracer(const BaselineScene::Data& data, const StepRays& rays, int width, RawResult& out)
      : data_(data), rays_(rays), width_(static_cast<std::size_t>(width)), out_(out) {}

  // Traces the pixels [x0, x1) × [y0, y1).
  void Trace(int x0, int x1, int y0, int y1) const {
    for (int y = y0; y < y1; y += kPacket)
      for (int x = x0; x < x1; x += kPacket)
        TracePacket(x, std::min(x + kPacket, x1), y, std::min(y + kPacket, y1));
  }

 private:
  void TracePacket(int x0, int x1, int y0, int y1) const {
    alignas(64) int valid[kLanes];
    alignas(64) RTCRayHit16 packet;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int x = x0 + lane % kPacket, y = y0 + lane / kPacket;
      const float column = static_cast<float>(x), row = static_cast<float>(y);
      valid[lane] = x < x1 && y < y1 ? -1 : 0;
      packet.ray.org_x[lane] = rays_.origin[0].At(column, row);
      packet.ray.org_y[lane] = rays_.origin[1].At(column, row);
      packet.ray.org_z[lane] = rays_.origin[2].At(column, row);
      packet.ray.dir_x[lane] = Coordinate(rays_.direction[0].At(column, row));
      packet.ray.dir_y[lane] = Coordinate(rays_.direction[1].At(column, row));
      packet.ray.dir_z[lane] = Coordinate(rays_.direction[2].At(column, row));
      packet.ray.tnear[lane] = 0;
      packet.ray.tfar[lane] = INFINITY;
      packet.ray.time[lane] = 0;
      packet.ray.mask[lane] = 0xffffffffu;
      packet.ray.id[lane] = static_cast<unsigned>(lane);
      packet.ray.flags[lane] = 0;
      packet.hit.primID[lane] = kNoIndex;
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, data_.scene, &context, &packet);
    for (int y = y0; y < y1; ++y) {
      const std::size_t first = static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x0);
      const int lane = (y - y0) * kPacket;
      std::copy_n(packet.ray.tfar + lane, x1 - x0, out_.distance.data() + first);
      std::copy_n(packet.hit.primID + lane, x1 - x0, out_.triangle.data() + first);
    }
  }

  const BaselineScene::Data& data_;
  const StepRays& rays_;
  const std::size_t width_;
  RawResult& out_;
};

// Returns the rays of a view, or nothing if one of them starts too far outside of the mesh for Embree.
std::optional<StepRays> MakeStepRays(const BaselineScene::Data& data, const CameraFrame& frame, double start,
                                     const Camera& camera) {
  const auto at = [&](int column, int row) {
    Ray ray = PixelRay(frame, column + 0.5, row + 0.5);
    ray.origin = ray.origin + start * ray.direction - data.center;
    return ray;
  };
  // Origins and directions are linear in the pixel, so those of the corners bound all others.
  for (const int column : {0, camera.width_px - 1})
    for (const int row : {0, camera.height_px - 1})
      if (const Ray corner = at(column, row); !Reaches(data, corner.origin, corner.direction))
        return std::nullopt;
  const Ray first = at(0, 0), right = at(1, 0), below = at(0, 1);
  const auto linear = [](double a, double b, double c) {
    return LinearCoordinate{static_cast<float>(a), static_cast<float>(b - a), static_cast<float>(c - a)};
  };
  const auto three = [&](Vec3 a, Vec3 b, Vec3 c, LinearCoordinate(&out)[3]) {
    out[0] = linear(a.x, b.x, c.x);
    out[1] = linear(a.y, b.y, c.y);
    out[2] = linear(a.z, b.z, c.z);
  };
  StepRays rays;
  three(first.origin, right.origin, below.origin, rays.origin);
  three(first.direction, right.direction, below.direction, rays.direction);
  return rays;
}

}  // namespace

Result<RawResult> TraceRaw(const BaselineScene& scene, const Camera& camera, const Execution& execution) {
  const Result<CameraFrame> frame = MakeFrame(camera, scene.bounds().diagonal());
  if (!frame.ok()) return frame.error();
  const BaselineScene::Data& data = scene.data();
  RawResult result;
  result.start_mm = StartDepth(data, frame.value());
  const std::optional<StepRays> rays = MakeStepRays(data, frame.value(), result.start_mm, camera);
  if (!rays)
    return Error{ErrorCode::kBadUsage, "view '" + camera.name + "': its rays start too far from the mesh"};
  const Stopwatch stopwatch;
  try {
    const auto size = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
    result.distance.resize(size);
    result.triangle.resize(size);
    const RawTracer tracer(data, *rays, camera.width_px, result);
    RunWithThreads(execution.threads, [&] {
      ParallelForTiles(camera.height_px, camera.width_px, kTile,
                       [&](int row, int row_end, int column, int column_end) {
                         if (!execution.cancelled()) tracer.Trace(column, column_end, row, row_end);
                       });
    });
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, "view '" + camera.name + "': its samples do not fit into memory"};
  }
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  result.trace_ms = stopwatch.Milliseconds();
  return result;
}

}  // namespace facetless
