#include "render/baseline/mesh_rays.h"

#include <algorithm>
#include <cmath>

#include "render/baseline/packet_rays.h"
#include "render/baseline/scene_data.h"
#include "render/baseline/triangle_point.h"

namespace facetless {
namespace {

constexpr std::size_t kLanes = 16;

// Puts one ray into a lane of a packet.
template <typename Rays>
void SetLane(Rays& rays, std::size_t lane, Vec3 origin, Vec3 direction, double length) {
  rays.org_x[lane] = static_cast<float>(origin.x);
  rays.org_y[lane] = static_cast<float>(origin.y);
  rays.org_z[lane] = static_cast<float>(origin.z);
  rays.dir_x[lane] = Coordinate(static_cast<float>(direction.x));
  rays.dir_y[lane] = Coordinate(static_cast<float>(direction.y));
  rays.dir_z[lane] = Coordinate(static_cast<float>(direction.z));
  rays.tnear[lane] = 0;
  rays.tfar[lane] = static_cast<float>(length);
  rays.time[lane] = 0;
  rays.mask[lane] = 0xffffffffu;
  rays.id[lane] = static_cast<unsigned>(lane);
  rays.flags[lane] = 0;
}

}  // namespace

MeshRays::MeshRays(const BaselineScene& scene)
    : scene_(scene),
      lift_mm_(std::max(kLiftShare * scene.bounds().diagonal(), kLiftNoises * scene.noise_mm())) {}

Vec3 MeshRays::LiftedStart(const RayStart& start, Vec3 direction) const {
  const double side = Dot(start.normal, direction) < 0 ? -lift_mm_ : lift_mm_;
  return start.position + side * start.normal - scene_.data().center;
}

void MeshRays::FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                           std::span<RayPassage> passages) const {
  const BaselineScene::Data& data = scene_.data();
  for (std::size_t first = 0; first < rays.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, rays.size() - first);
    alignas(64) int valid[kLanes] = {};
    alignas(64) RTCRay16 packet;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const SecondaryRay& ray = rays[first + std::min(lane, count - 1)];
      const Vec3 origin = LiftedStart(starts[ray.start], ray.direction);
      valid[lane] = lane < count && Reaches(data, origin, ray.direction) ? -1 : 0;
      SetLane(packet, lane, origin, ray.direction, ray.length);
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, data.scene, &context, &packet);
    // Embree sets the far end of a ray that meets something to −∞.
    for (std::size_t lane = 0; lane < count; ++lane)
      passages[first + lane] = {valid[lane] != 0 && packet.tfar[lane] < 0, false, 0};
  }
}

void MeshRays::FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                           std::span<SecondaryHit> hits) const {
  const BaselineScene::Data& data = scene_.data();
  for (std::size_t first = 0; first < rays.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, rays.size() - first);
    alignas(64) int valid[kLanes] = {};
    alignas(64) RTCRayHit16 packet;
    Vec3 origins[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const SecondaryRay& ray = rays[first + std::min(lane, count - 1)];
      origins[lane] = LiftedStart(starts[ray.start], ray.direction);
      valid[lane] = lane < count && Reaches(data, origins[lane], ray.direction) ? -1 : 0;
      SetLane(packet.ray, lane, origins[lane], ray.direction, ray.length);
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect16(valid, data.scene, &context, &packet);
    for (std::size_t lane = 0; lane < count; ++lane) {
      SecondaryHit& hit = hits[first + lane];
      hit = {};
      if (valid[lane] == 0 || packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      const unsigned instance = packet.hit.instID[0][lane];
      const std::uint32_t node =
          data.node_of_geometry[instance == RTC_INVALID_GEOMETRY_ID ? packet.hit.geomID[lane] : instance];
      const TriangleCorners corners = LoadCorners(data, node, packet.hit.primID[lane]);
      const Vec3 direction = rays[first + lane].direction;
      const TrianglePoint point = MeetTriangle(corners, origins[lane] + data.center, direction);
      for (int k = 0; k < 3; ++k) hit.position = hit.position + point.weight[k] * corners.position[k];
      hit.normal = point.normal;
      hit.placed_face = PlacedFaceOf(data, node, packet.hit.primID[lane]);
      hit.distance = Dot(hit.position - starts[rays[first + lane].start].position, direction);
    }
  }
}

}  // namespace facetless
