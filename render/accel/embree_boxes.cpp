#include "render/accel/embree_boxes.h"

#include <embree3/rtcore.h>
#include <sys/types.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "render/base/parallel.h"

namespace facetless {

struct EmbreeBoxes::Data {
  explicit Data(std::span<const Box3> all) : boxes(all) {}
  ~Data() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  BoxSet boxes;
  double middle[3] = {0, 0, 0};
  double size = 1;  // the longest side of the scene's box
  std::atomic<std::int64_t> allocated{0};
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

namespace {

// In sizes of the scene: the margin of boxes, what is added to the end of a ray, and how far rays may start.
constexpr double kBoxMargin = 0x1p-20, kEndMargin = 0x1p-18, kReach = 0x1p10;

float RoundedDown(double x) {
  const auto f = static_cast<float>(x);
  return f <= x ? f : std::nextafter(f, -INFINITY);
}

float RoundedUp(double x) {
  const auto f = static_cast<float>(x);
  return f >= x ? f : std::nextafter(f, INFINITY);
}

void SetBounds(const EmbreeBoxes::Data& data, unsigned index, RTCBounds& bounds) {
  float low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    const SlabBox& box = data.boxes[index];
    low[axis] = RoundedDown((box.side[0][axis] - data.middle[axis]) / data.size - kBoxMargin);
    high[axis] = RoundedUp((box.side[1][axis] - data.middle[axis]) / data.size + kBoxMargin);
  }
  bounds.lower_x = low[0];
  bounds.lower_y = low[1];
  bounds.lower_z = low[2];
  bounds.upper_x = high[0];
  bounds.upper_y = high[1];
  bounds.upper_z = high[2];
}

bool CountAllocation(void* data, ssize_t bytes, bool /*post*/) {
  static_cast<EmbreeBoxes::Data*>(data)->allocated.fetch_add(bytes);
  return true;
}

Result<void> CheckDevice(RTCDevice device) {
  const RTCError code = rtcGetDeviceError(device);
  if (code == RTC_ERROR_NONE && device != nullptr) return {};
  if (code == RTC_ERROR_OUT_OF_MEMORY)
    return Error{ErrorCode::kLimitExceeded, "Embree's tree does not fit into memory"};
  if (code == RTC_ERROR_UNSUPPORTED_CPU)
    return Error{ErrorCode::kBadUsage, "Embree needs a processor with SSE2, which it does not find"};
  return Error{ErrorCode::kInternal, "Embree reports error " + std::to_string(static_cast<int>(code))};
}

// The data of a ray. Embree passes the context back to the callback.
struct TracedRay {
  RTCIntersectContext context;  // must be the first member, so that a pointer to it is a pointer to the ray
  double (*ask)(void* context, std::uint32_t id);
  void* caller;
  double t_first, size;
};

float EndOf(const TracedRay& ray, double t_last) {
  return RoundedUp((t_last - ray.t_first) / ray.size + kEndMargin);
}

void Intersect(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  const auto& traced = *reinterpret_cast<const TracedRay*>(arguments->context);
  const double t_last = traced.ask(traced.caller, arguments->primID);
  RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  float& end = RTCRayN_tfar(ray, arguments->N, 0);
  end = t_last < traced.t_first ? -1.0f : std::min(end, EndOf(traced, t_last));
}

}  // namespace

EmbreeBoxes::EmbreeBoxes(std::unique_ptr<Data> data) : data_(std::move(data)) {}
EmbreeBoxes::~EmbreeBoxes() = default;
EmbreeBoxes::EmbreeBoxes(EmbreeBoxes&&) noexcept = default;
EmbreeBoxes& EmbreeBoxes::operator=(EmbreeBoxes&&) noexcept = default;

Result<EmbreeBoxes> EmbreeBoxes::Build(std::span<const Box3> boxes) {
  auto data = std::make_unique<Data>(boxes);
  if (boxes.empty()) return EmbreeBoxes(std::move(data));
  data->size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = data->boxes.bounds().side[0][axis], high = data->boxes.bounds().side[1][axis];
    data->middle[axis] = 0.5 * low + 0.5 * high;
    data->size = std::max(data->size, high - low);
  }
  data->device = rtcNewDevice(nullptr);
  if (data->device == nullptr) return CheckDevice(nullptr).error();
  rtcSetDeviceMemoryMonitorFunction(data->device, &CountAllocation, data.get());
  data->scene = rtcNewScene(data->device);
  rtcSetSceneFlags(data->scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(data->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(boxes.size()));
  // Embree calls this function on oneTBB's threads.
  const auto bounds = [&data](unsigned index, RTCBounds* out) { SetBounds(*data, index, *out); };
  using BoundsWork = SharedWork<decltype(bounds)>;
  std::optional<BoundsWork> work(bounds);
  rtcSetGeometryUserData(geometry, &*work);
  rtcSetGeometryBoundsFunction(
      geometry,
      [](const RTCBoundsFunctionArguments* arguments) {
        static_cast<const BoundsWork*>(arguments->geometryUserPtr)
            ->Run(arguments->primID, arguments->bounds_o);
      },
      nullptr);
  rtcSetGeometryIntersectFunction(
      geometry, [](const RTCIntersectFunctionNArguments* arguments) { Intersect(arguments); });
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(data->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(data->scene);
  work.reset();
  if (Result<void> sound = CheckDevice(data->device); !sound.ok()) return sound.error();
  return EmbreeBoxes(std::move(data));
}

const BoxSet& EmbreeBoxes::boxes() const {
  return data_->boxes;
}

std::size_t EmbreeBoxes::bytes() const {
  return data_->boxes.bytes() + static_cast<std::size_t>(data_->allocated.load());
}

bool EmbreeBoxes::TooFar(const SlabRay& ray) const {
  double away = 0;
  for (int axis = 0; axis < 3; ++axis)
    away = std::max(away, std::fabs(ray.origin[axis] - data_->middle[axis]));
  return !(away <= kReach * data_->size);
}

void EmbreeBoxes::Trace(const SlabRay& ray, Ask ask, void* context) const {
  TracedRay traced{{}, ask, context, ray.t_first, data_->size};
  rtcInitIntersectContext(&traced.context);
  float start[3];
  for (int axis = 0; axis < 3; ++axis)
    start[axis] = static_cast<float>(
        (ray.origin[axis] - data_->middle[axis] + ray.t_first * ray.direction[axis]) / data_->size);
  RTCRayHit embree{};
  embree.ray.org_x = start[0], embree.ray.org_y = start[1], embree.ray.org_z = start[2];
  embree.ray.dir_x = static_cast<float>(ray.direction[0]);
  embree.ray.dir_y = static_cast<float>(ray.direction[1]);
  embree.ray.dir_z = static_cast<float>(ray.direction[2]);
  embree.ray.tfar = EndOf(traced, ray.t_last);
  embree.ray.mask = 0xffffffffu;
  embree.hit.geomID = embree.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(data_->scene, &traced.context, &embree);
}

}  // namespace facetless
