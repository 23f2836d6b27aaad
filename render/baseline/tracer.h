// The baseline tracer: Embree traces a triangle mesh with the same rays as the direct renderer.
//
//     Result<BaselineScene> scene = BaselineScene::Build(mesh, /*threads=*/0);
//     if (!scene) return scene.error();
//     Result<BaselineResult> result = TraceBaseline(scene.value(), camera, {});
//
//  1. The rays pass through pixel centres (camera.h). Orthographic rays see hits at any depth, perspective
//     rays only beyond near_mm.
//  2. Embree (float32) decides which triangle is hit. The depth is then computed again in double, from the
//     placed corners of the triangle. If the ray misses the triangle in double, by an error of float32, the
//     hit has the depth of the triangle's border.
//  3. Normals are interpolated from the vertices, as in a viewer. At silhouettes of coarse meshes, an
//     interpolated normal may point to the other side of the ray than the normal of the triangle; it is then
//     rotated back until it is perpendicular to the ray.
//  4. Coordinates are taken relative to the centre of the mesh before they are rounded to float32, so a model
//     10 km from the origin loses no precision.
//  5. With section planes (view/section.h), a ray collects all triangles that it meets. A ray may meet two
//     triangles that share an edge or a corner. Two successive triangles whose depths differ by at most
//     kSameCrossing of the diagonal, and which are both entered or both left, therefore count as one
//     crossing. The solids of a mesh of another program are unknown; each node counts as one.
//  6. The result does not depend on the number of threads. It may depend on the processor, because Embree
//     does not guarantee otherwise.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/view/camera.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"
#include "render/view/section.h"

namespace facetless {

struct BaselineOptions {
  Execution execution;                          // the cancellation flag is polled once per tile
  std::span<const SectionPlane> sections = {};  // section planes
  const SectionSolids* solids = nullptr;        // solids of the model; required with sections
  // Which pixels are traced again with several samples. Null: none. Not with sections.
  const RefineRequest* refine = nullptr;
};

struct BaselineStats {
  double trace_ms = 0, refine_ms = 0;  // refine_ms: of the refinement
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t buffer_bytes = 0;  // memory of the samples
};

struct BaselineResult {
  CameraFrame frame;
  SampleBuffer samples;                  // without uv and certificate
  std::optional<Refinement> refinement;  // if one was requested
  BaselineStats stats;
};

// An Embree BVH over a mesh. It is immutable, and several threads may use it at once. The mesh must outlive
// it.
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
  const Box3& bounds() const;       // bounds of the placed mesh, mm
  std::uint64_t triangles() const;  // number of triangles, with every placement counted
  double build_ms() const;
  std::uint64_t bvh_bytes() const;       // memory that Embree holds, copied vertices included
  std::uint64_t bvh_peak_bytes() const;  // peak memory that Embree held during the build
  std::uint64_t mesh_bytes() const;      // memory of the vectors of the Mesh
  double noise_mm() const;               // PositionNoise

  struct Data;
  const Data& data() const { return *data_; }

 private:
  explicit BaselineScene(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

// Traces a view. Errors: kBadUsage (camera, sections), kLimitExceeded (the samples do not fit into memory),
// kCancelled.
Result<BaselineResult> TraceBaseline(const BaselineScene& scene, const Camera& camera,
                                     const BaselineOptions& options);

}  // namespace facetless
