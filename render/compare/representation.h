// A representation: a model as something that a camera can look at. Exact surfaces and triangles are two;
// whatever comes after their samples (light, inspections, differences, reports) treats all of them alike.
//
//  1. Trace may be called from many threads at once, and its samples do not depend on the number of threads.
//  2. What Trace cannot fill of a request (parameters of triangles, certificates of a mesh) it leaves empty.
//  3. Depths are those of the camera's rays (view/samples.h), so that two representations of one model can be
//     compared sample by sample.
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
  bool certificates = true;              // false: of a pass for colour alone, whose certificates are not read
  // By placed face: those that rays pass as if they were not there. Null: none.
  const std::vector<bool>* leave_out = nullptr;
};

// What every representation counts while it traces.
struct TraceCounters {
  double prepare_ms = 0;  // of what this view alone needs
  double trace_ms = 0;
  std::uint64_t rays = 0, hits = 0;
};

struct TracedView {
  CameraFrame frame;
  SampleBuffer samples;
  TraceCounters counters;
  std::uint64_t structure_bytes = 0;  // what tracing held at its fullest, without the samples
  std::optional<DirectStats> direct;  // of exact surfaces, which a report describes in detail
};

// A number about a representation that reports show beside its costs, such as {"triangles", 1200}.
struct RepresentationFact {
  std::string name;  // of [a-z_], with its unit at the end: "cell_mm"
  double value = 0;
};

class Representation {
 public:
  virtual ~Representation() = default;

  // Its role in reports and in names of files, of [a-z0-9-]: "direct", "baseline".
  virtual std::string name() const = 0;
  // The name for people.
  virtual std::string title() const = 0;
  // What making it took, once for all its views, in ms.
  virtual double make_ms() const { return 0; }
  // Differences of depth up to this many mm come from its number format, and not from its shape.
  virtual double noise_mm() const { return 0; }
  virtual std::vector<RepresentationFact> facts() const { return {}; }
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
  ExactSurfaces(const Scene& scene, DirectOptions options, std::string name = "direct",
                std::string title = "Direct")
      : scene_(scene), options_(std::move(options)), name_(std::move(name)), title_(std::move(title)) {}

  std::string name() const override { return name_; }
  std::string title() const override { return title_; }
  const Scene* exact() const override { return &scene_; }
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;

 private:
  const Scene& scene_;
  const DirectOptions options_;
  const std::string name_, title_;
};

// The triangles of a mesh in Embree's tree. The scene, the model and the sections must outlive the
// representation.
class Triangles final : public Representation {
 public:
  // `model`: the model that the mesh was made of, or is compared with; its solids have caps where `sections`
  // cut them. `max_bytes`: what a tree without the faces of TraceRequest::leave_out may hold.
  Triangles(const BaselineScene& scene, const Model& model, std::span<const SectionPlane> sections,
            std::uint64_t max_bytes);

  std::string name() const override { return "baseline"; }
  std::string title() const override { return "Baseline"; }
  double make_ms() const override { return scene_.mesh().mesh_ms + scene_.build_ms(); }
  double noise_mm() const override { return scene_.noise_mm(); }
  std::vector<RepresentationFact> facts() const override;
  bool names_faces() const override { return scene_.mesh().from_model; }
  // A request to leave out faces requires a mesh that names them.
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;

 private:
  const BaselineScene& scene_;
  const std::span<const SectionPlane> sections_;
  std::optional<SectionSolids> solids_;  // only where something is cut
  const std::uint64_t max_bytes_;
};

}  // namespace facetless
