// What a BaselineScene holds. Private to baseline/, the only folder that knows Embree.
//
//  1. Embree's coordinates are millimetres relative to `center`, rounded to float32 last of all.
//  2. A part that is placed once goes into the top-level tree itself; parts that are placed more often are
//     trees of their own, and each placement an instance. node_of_geometry tells for both which node a
//     geometry id stands for.
//  3. A ray with a coordinate beyond kGreatestCoordinate would end the process: Debian's Embree asserts that
//     there is none. So no mesh is larger than kLargestMesh, rays farther off than `reach` are not asked, and
//     a part whose placement would throw them out of range is placed once for each of its nodes.
#pragma once

#include <embree3/rtcore.h>
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <vector>

#include "render/base/execution.h"
#include "render/baseline/tracer.h"

namespace facetless {

// Bytes that Embree holds, told by its memory monitor; and the most that it may.
struct EmbreeMemory {
  std::atomic<std::int64_t> now{0}, peak{0};
  std::int64_t most = 0;  // 0: any number
  std::atomic<bool> refused{false};
  const Execution* building = nullptr;  // while it is built: a cancelled build is refused what it asks for
};

// To be given to a device as its memory monitor, with an EmbreeMemory. False refuses an allocation, which
// ends what Embree is at with RTC_ERROR_OUT_OF_MEMORY.
bool CountBytes(void* user, ssize_t bytes, bool post);

// Nothing, or the device's error, which it has forgotten when it is asked again. Null: why there is no
// device.
Result<void> CheckEmbree(RTCDevice device);

constexpr double kGreatestCoordinate = 1e18, kLargestMesh = 1e17;  // mm
// A coordinate of a ray's direction, whose component along the view is 1: reached at a hair's breadth of
// 180°.
constexpr double kSteepestRay = 1e6;

struct PlacedNode {
  Placement placement;
  Vec3 normal_rows[3];  // takes a part's normal to the placed one's direction, outward kept
  double side = 1;      // −1: the placement mirrors, so triangles run the other way round
};

struct BaselineScene::Data {
  ~Data();

  const Mesh* mesh = nullptr;
  bool to_be_cut = false;  // Embree calls the filter of the ray's context
  EmbreeMemory memory;
  RTCDevice device = nullptr;
  std::vector<RTCScene> part_scenes;  // nullptr where the part is placed at most once
  RTCScene scene = nullptr;
  std::vector<std::uint32_t> node_of_geometry;
  std::vector<PlacedNode> nodes;  // as mesh->nodes
  Box3 bounds;
  Vec3 center;
  double reach = 0;  // mm: a ray that begins farther from the center along an axis misses the mesh
  std::uint64_t triangles = 0, mesh_bytes = 0;
  double build_ms = 0, noise_mm = 0;
};

}  // namespace facetless
