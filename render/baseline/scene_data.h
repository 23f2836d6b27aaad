// What a BaselineScene holds. Private to baseline/, the only folder that knows Embree.
//
//  1. Embree's coordinates are millimetres relative to `center`, rounded to float32 last of all.
//  2. A part that is placed once goes into the top-level tree itself; parts that are placed more often are
//     trees of their own, and each placement an instance. node_of_geometry tells for both which node a
//     geometry id stands for.
#pragma once

#include <embree3/rtcore.h>
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <vector>

#include "render/baseline/tracer.h"

namespace facetless {

// Bytes that Embree holds, told by its memory monitor.
struct EmbreeMemory {
  std::atomic<std::int64_t> now{0}, peak{0};
};

// To be given to a device as its memory monitor, with an EmbreeMemory.
bool CountBytes(void* user, ssize_t bytes, bool post);

// The device's last error (null: of the device that could not be made).
Error EmbreeError(RTCDevice device);

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
  std::uint64_t triangles = 0, mesh_bytes = 0;
  double build_ms = 0, noise_mm = 0;
};

}  // namespace facetless
