#include "render/baseline/raw_rays.h"

#include <algorithm>

#include "render/baseline/mesh_rays.h"
#include "render/baseline/packet_rays.h"
#include "render/baseline/scene_data.h"

namespace facetless {
namespace {

constexpr std::size_t kWidest = 16;

}  // namespace

RawRays::RawRays(const BaselineScene& scene, std::span<const RayStart> starts,
                 std::span<const SecondaryRay> rays)
    : scene_(scene) {
  const MeshRays lifted(scene);
  for (const SecondaryRay& ray : rays) {
    const Vec3 origin = lifted.LiftedStart(starts[ray.start], ray.direction);
    if (!Reaches(scene.data(), origin, ray.direction)) continue;
    const double o[3] = {origin.x, origin.y, origin.z};
    const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
    for (int c = 0; c < 3; ++c) {
      origin_[c].push_back(static_cast<float>(o[c]));
      direction_[c].push_back(Coordinate(static_cast<float>(d[c])));
    }
    length_.push_back(static_cast<float>(ray.length));
    ++count_;
  }
  for (int c = 0; c < 3; ++c) {
    origin_[c].resize(count_ + kWidest);
    direction_[c].resize(count_ + kWidest, 1);
  }
  length_.resize(count_ + kWidest, -1);  // a ray whose end lies before its begin meets nothing
}

template <typename Packet, int kLanes, typename Ask>
std::uint64_t RawRays::CountPackets(const Ask& ask) const {
  std::uint64_t blocked = 0;
  alignas(64) int valid[kLanes];
  std::fill_n(valid, kLanes, -1);
  alignas(64) Packet packet{};
  std::fill_n(packet.mask, kLanes, 0xffffffffu);
  for (std::size_t first = 0; first < count_; first += kLanes) {
    std::copy_n(&origin_[0][first], kLanes, packet.org_x);
    std::copy_n(&origin_[1][first], kLanes, packet.org_y);
    std::copy_n(&origin_[2][first], kLanes, packet.org_z);
    std::copy_n(&direction_[0][first], kLanes, packet.dir_x);
    std::copy_n(&direction_[1][first], kLanes, packet.dir_y);
    std::copy_n(&direction_[2][first], kLanes, packet.dir_z);
    std::copy_n(&length_[first], kLanes, packet.tfar);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    ask(valid, &context, &packet);
    const std::size_t used = std::min<std::size_t>(kLanes, count_ - first);
    for (std::size_t lane = 0; lane < used; ++lane) blocked += packet.tfar[lane] == -INFINITY;
  }
  return blocked;
}

std::uint64_t RawRays::CountBlocked(int width) const {
  const RTCScene scene = scene_.data().scene;
  if (width == 16)
    return CountPackets<RTCRay16, 16>(
        [&](const int* valid, auto* context, auto* packet) { rtcOccluded16(valid, scene, context, packet); });
  if (width == 8)
    return CountPackets<RTCRay8, 8>(
        [&](const int* valid, auto* context, auto* packet) { rtcOccluded8(valid, scene, context, packet); });
  std::uint64_t blocked = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    RTCRay ray{};
    ray.org_x = origin_[0][i], ray.org_y = origin_[1][i], ray.org_z = origin_[2][i];
    ray.dir_x = direction_[0][i], ray.dir_y = direction_[1][i], ray.dir_z = direction_[2][i];
    ray.tfar = length_[i];
    ray.mask = 0xffffffffu;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
    blocked += ray.tfar == -INFINITY;
  }
  return blocked;
}

}  // namespace facetless
