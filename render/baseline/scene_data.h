// The data of a BaselineScene. Private to render/baseline, the only folder that uses Embree.
//
//  1. Embree's coordinates are millimetres relative to `center`. Rounding to float32 is the last step.
//  2. A part that is placed once is in the top-level tree itself. A part that is placed more often has a tree
//     of its own, with one Embree instance per placement. node_of_geometry maps the geometry ids of both
//     kinds to nodes.
//  3. A ray with a coordinate beyond kGreatestCoordinate would end the process, because Debian's Embree
//     asserts that there is none. No mesh may therefore be larger than kLargestMesh, and rays farther away
//     than `reach` are not traced. A part whose placement would transform rays out of that range is stored
//     separately for each of its nodes.
#pragma once

#include <embree3/rtcore.h>
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <vector>

#include "render/base/execution.h"
#include "render/baseline/tracer.h"

namespace facetless {

// The memory that Embree has allocated, counted by its memory monitor, and the limit.
struct EmbreeMemory {
  std::atomic<std::int64_t> now{0}, peak{0};
  std::int64_t most = 0;  // limit in bytes; 0: no limit
  std::atomic<bool> refused{false};
  const Execution* building = nullptr;  // while it is built: a cancelled build is refused what it asks for
};

// The memory monitor of a device; `user` is an EmbreeMemory. Returns false to refuse an allocation, which
// ends the current Embree operation with RTC_ERROR_OUT_OF_MEMORY.
bool CountBytes(void* user, ssize_t bytes, bool post);

// Returns the error of the device, if there is one, and clears it. If `device` is null, returns the reason
// why it could not be created.
Result<void> CheckEmbree(RTCDevice device);

constexpr double kGreatestCoordinate = 1e18, kLargestMesh = 1e17;  // mm
// The largest coordinate of a ray's direction, whose component along the view direction is 1. It is reached
// only by fields of view very close to 180°.
constexpr double kSteepestRay = 1e6;

struct PlacedNode {
  Placement placement;
  Vec3 normal_rows
      [3];          // maps a normal of the part to the direction of the placed normal; outward stays outward
  double side = 1;  // −1: the placement mirrors, which reverses the orientation of the triangles
};

struct BaselineScene::Data {
  ~Data();

  const Mesh* mesh = nullptr;
  bool to_be_cut =
      false;  // the scene will be traced with sections; Embree calls the filter of the ray's context
  EmbreeMemory memory;
  RTCDevice device = nullptr;
  std::vector<RTCScene> part_scenes;  // nullptr if the part is placed at most once
  RTCScene scene = nullptr;
  std::vector<std::uint32_t> node_of_geometry;
  std::vector<PlacedNode> nodes;  // parallel to mesh->nodes
  Box3 bounds;
  Vec3 center;
  double reach = 0;  // mm: a ray whose start is farther from the center along an axis misses the mesh
  std::uint64_t triangles = 0, mesh_bytes = 0;
  double build_ms = 0, noise_mm = 0;
};

}  // namespace facetless
