#include "render/baseline/box_tree.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/base/parallel.h"
#include "render/baseline/scene_data.h"

namespace facetless {

struct BoxTree::Data {
  ~Data() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  EmbreeMemory memory;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<ScreenBox> boxes;  // until the tree is built
  double nearest = 0;            // nearest depth of all boxes; Embree's depths are relative to it
};

namespace {

// The distance of the start of a ray from the nearest box.
constexpr float kLeadIn = 1;

float RoundedDown(double x) {
  const float f = static_cast<float>(x);
  return f <= x ? f : std::nextafter(f, -INFINITY);
}

float RoundedUp(double x) {
  const float f = static_cast<float>(x);
  return f >= x ? f : std::nextafter(f, INFINITY);
}

void SetBoxBounds(const BoxTree::Data& data, unsigned index, RTCBounds& bounds) {
  const ScreenBox& box = data.boxes[index];
  bounds.lower_x = static_cast<float>(box.col_begin);
  bounds.upper_x = static_cast<float>(box.col_end);
  bounds.lower_y = static_cast<float>(box.row_begin);
  bounds.upper_y = static_cast<float>(box.row_end);
  // Only the beginning of a box affects which boxes a ray visits, and in which order.
  bounds.lower_z = bounds.upper_z = RoundedDown(box.near_depth - data.nearest);
}

// The data of a ray. Embree passes the context back to the callback.
struct Query {
  RTCIntersectContext context;  // must be the first member, so that a pointer to it is a pointer to the query
  BoxTree::VisitBox meet;
  void* caller;
  double nearest;
};

void Intersect(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  const double depth = query.meet(query.caller, arguments->primID);
  RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  float& limit = RTCRayN_tfar(ray, arguments->N, 0);
  limit = std::min(limit, RoundedUp(depth - query.nearest + kLeadIn));
}

}  // namespace

BoxTree::BoxTree(std::unique_ptr<Data> data) : data_(std::move(data)) {}
BoxTree::~BoxTree() = default;
BoxTree::BoxTree(BoxTree&&) noexcept = default;
BoxTree& BoxTree::operator=(BoxTree&&) noexcept = default;

Result<BoxTree> BoxTree::Build(std::span<const ScreenBox> boxes) {
  if (boxes.empty()) return Error{ErrorCode::kNothingUsable, "there are no boxes to build a tree of"};
  auto data = std::make_unique<Data>();
  data->boxes.assign(boxes.begin(), boxes.end());
  data->nearest = boxes.front().near_depth;
  for (const ScreenBox& box : boxes) data->nearest = std::min(data->nearest, box.near_depth);
  data->device = rtcNewDevice(nullptr);
  if (data->device == nullptr) return CheckEmbree(nullptr).error();
  rtcSetDeviceMemoryMonitorFunction(data->device, &CountBytes, &data->memory);
  data->scene = rtcNewScene(data->device);
  rtcSetSceneFlags(data->scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(data->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(boxes.size()));
  // Embree calls this function on oneTBB's threads.
  const auto bounds = [&data](unsigned index, RTCBounds* out) { SetBoxBounds(*data, index, *out); };
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
  if (Result<void> sound = CheckEmbree(data->device); !sound.ok()) return sound.error();
  std::vector<ScreenBox>().swap(data->boxes);
  return BoxTree(std::move(data));
}

void BoxTree::Visit(int column, int row, VisitBox meet, void* context) const {
  Query query{{}, meet, context, data_->nearest};
  rtcInitIntersectContext(&query.context);
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(column) + 0.5f;
  ray.ray.org_y = static_cast<float>(row) + 0.5f;
  ray.ray.org_z = -kLeadIn;
  ray.ray.dir_z = 1;
  ray.ray.tfar = INFINITY;
  ray.ray.mask = 0xffffffffu;
  ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(data_->scene, &query.context, &ray);
}

std::uint64_t BoxTree::bytes() const {
  return static_cast<std::uint64_t>(data_->memory.now.load());
}

}  // namespace facetless
