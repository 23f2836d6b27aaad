// A representation: a model as something that a camera can look at. Exact surfaces and triangles are two;
// whatever comes after their samples (light, inspections, differences, reports) treats all of them alike.
//
//  1. Trace may be called from many threads at once, and its samples do not depend on the number of threads.
//  2. What Trace cannot fill of a request (parameters of triangles, certificates of a mesh) it leaves empty.
//
//   const ExactSurfaces exact(scene, options);
//   Result<TracedView> traced = exact.Trace(camera, {.uv = true}, {.threads = 4});
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/baseline/tracer.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"
#include "render/view/samples.h"
#include "render/view/section.h"

namespace facetless {

// What is wanted of a trace besides depths, normals and faces.
struct TraceRequest {
  bool uv = false, depth_error = false;  // of the samples
  bool audit = false;                    // count every crossing of every ray
  bool certificates = true;              // false: of a pass for colour alone, whose certificates nobody reads
  const std::vector<bool>* leave_out =
      nullptr;  // by placed face: those that rays pass as if they were not there
};

struct TracedView {
  CameraFrame frame;
  SampleBuffer samples;
  std::uint64_t structure_bytes = 0;  // what tracing held at its fullest, without the samples
  // The counters of the representations that a report describes in detail.
  std::optional<DirectStats> direct;
  std::optional<BaselineStats> baseline;
};

class Representation {
 public:
  virtual ~Representation() = default;

  // Its role in reports and names of files: "direct", "baseline".
  virtual std::string name() const = 0;
  // The scene of exact surfaces that it looks at; null if there is none. Lines, and inspections that need a
  // surface, ask for it.
  virtual const Scene* exact() const { return nullptr; }
  // Whether its samples name the model's placed faces.
  virtual bool names_faces() const { return true; }

  // Errors: those of the tracer behind it.
  virtual Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                                   const Execution& execution) const = 0;
};

// The exact surfaces of a scene, which must outlive the representation.
class ExactSurfaces final : public Representation {
 public:
  // Of `options`: precision, check, tolerance, sections, and what the leaves may take; the rest is the
  // request's.
  ExactSurfaces(const Scene& scene, DirectOptions options) : scene_(scene), options_(std::move(options)) {}

  std::string name() const override { return "direct"; }
  const Scene* exact() const override { return &scene_; }
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;

 private:
  const Scene& scene_;
  const DirectOptions options_;
};

// The triangles of a mesh in Embree's tree. The scene, the sections and the solids must outlive the
// representation.
class Triangles final : public Representation {
 public:
  // `solids`: of the model, required with sections. `max_bytes`: what a tree without the faces of
  // TraceRequest::leave_out may hold.
  Triangles(const BaselineScene& scene, std::span<const SectionPlane> sections, const SectionSolids* solids,
            std::uint64_t max_bytes)
      : scene_(scene), sections_(sections), solids_(solids), max_bytes_(max_bytes) {}

  std::string name() const override { return "baseline"; }
  bool names_faces() const override { return scene_.mesh().from_model; }
  // A request to leave out faces requires a mesh that names them.
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;

 private:
  const BaselineScene& scene_;
  const std::span<const SectionPlane> sections_;
  const SectionSolids* const solids_;
  const std::uint64_t max_bytes_;
};

}  // namespace facetless
