// The baseline: a triangle mesh, traced by Embree from the same rays as the direct renderer.
//
//  1. Rays are those of camera.h through pixel centres. Orthographic ones see hits at any depth, perspective
//     ones beyond near_mm.
//  2. Embree (float32) decides which triangle is hit; depth is then computed again in double, from the
//     triangle's placed corners. A ray that passes the triangle in double by float32's error takes the depth
//     of the triangle's border.
//  3. Normals are interpolated from the vertices, as a viewer does; one that points to the other side of the
//     ray than its triangle does (silhouettes of coarse meshes) is turned back to the horizon.
//  4. Everything is relative to the mesh's centre before it becomes float32: a model 10 km away loses
//     nothing.
//  5. With section planes (view/section.h) a ray collects all triangles that it meets. Those that share an
//     edge or a corner may both be met by one ray: neighbours in depth, to within kSameCrossing of the
//     diagonal, that are entered or left alike are one crossing. A mesh of another program has solids of
//     unknown extent: each node is taken for one.
//  6. Answers don't depend on the number of threads. They may depend on the processor: Embree promises no
//     more.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/view/camera.h"
#include "render/view/samples.h"
#include "render/view/section.h"

namespace facetless {

struct BaselineOptions {
  Execution execution;                          // polled per tile
  std::span<const SectionPlane> sections = {};  // what is cut away
  const SectionSolids* solids = nullptr;        // of the model; required with sections
};

struct BaselineStats {
  double trace_ms = 0;
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t buffer_bytes = 0;  // the samples
};

struct BaselineResult {
  CameraFrame frame;
  SampleBuffer samples;  // without uv and certificate
  BaselineStats stats;
};

// An Embree BVH over a mesh; immutable, may serve many calls at once. The Mesh must outlive it.
class BaselineScene {
 public:
  // `to_be_cut`: it will be traced with section planes, which takes a slower tree walk. `max_bytes`: what
  // Embree may hold at any time while it builds (0: any number); a build that would take more ends at once.
  // Errors: kNothingUsable (no triangle), kLimitExceeded (more than max_bytes, Embree ran out of memory, more
  // than 2^32 − 1 nodes, a mesh larger than 1e17 mm), kBadUsage (the machine lacks what Embree needs), kCancelled.
  static Result<BaselineScene> Build(const Mesh& mesh, const Execution& execution, bool to_be_cut = false,
                                     std::uint64_t max_bytes = 0);
  ~BaselineScene();
  BaselineScene(BaselineScene&&) noexcept;
  BaselineScene& operator=(BaselineScene&&) noexcept;

  const Mesh& mesh() const;
  const Box3& bounds() const;       // of the placed mesh, mm
  std::uint64_t triangles() const;  // with every placement counted
  double build_ms() const;
  std::uint64_t bvh_bytes() const;       // what Embree holds, copied vertices included
  std::uint64_t bvh_peak_bytes() const;  // the most it held while building
  std::uint64_t mesh_bytes() const;      // the Mesh's own vectors
  double noise_mm() const;               // PositionNoise

  struct Data;
  const Data& data() const { return *data_; }

 private:
  explicit BaselineScene(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

// Errors: kBadUsage (camera, sections), kLimitExceeded (samples don't fit into memory), kCancelled.
Result<BaselineResult> TraceBaseline(const BaselineScene& scene, const Camera& camera,
                                     const BaselineOptions& options);

}  // namespace facetless
