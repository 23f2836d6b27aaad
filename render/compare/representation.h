// A representation: a form of a model that a camera can view, such as exact surfaces or triangles. All later
// steps (light, inspections, differences, reports) use its samples, and treat all representations alike.
//
//  1. Trace may be called from many threads at once, and its samples do not depend on the number of threads.
//  2. Trace leaves requested data empty that it cannot provide (surface parameters of triangles, certificates
//     of a mesh).
//  3. Depths are those of the camera's rays (view/samples.h), so that two representations of one model can be
//     compared sample by sample.
//
//   const ExactSurfaces exact(scene, options);
//   Result<TracedView> traced = exact.Trace(camera, {.uv = true}, {.threads = 4});
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/baseline/tracer.h"
#include "render/solve/solver_trace.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"
#include "render/view/secondary_rays.h"
#include "render/view/section.h"

namespace facetless {

// The data that a trace should provide in addition to depths, normals and faces.
struct TraceRequest {
  bool uv = false, depth_error = false;  // fill these members of the samples
  bool audit = false;                    // count all crossings of every ray
  bool certificates = true;              // false for a pass for colour only, whose certificates are not used
  // Indexed by placed face: rays ignore the faces that are set. Null: no face is ignored.
  const std::vector<bool>* leave_out = nullptr;
  // Which pixels are traced again with several samples. Null: none. Not with sections.
  const RefineRequest* refine = nullptr;
};

// The counters of every representation.
struct TraceCounters {
  double prepare_ms = 0;  // time of preparing this view
  double trace_ms = 0;
  std::uint64_t rays = 0, hits = 0;
  double refine_ms = 0;  // time of the refinement
};

struct TracedView {
  CameraFrame frame;
  SampleBuffer samples;
  // Empty if it was not requested, or if the representation traces whole views only.
  std::optional<Refinement> refinement;
  TraceCounters counters;
  std::uint64_t structure_bytes = 0;  // peak memory of tracing, without the samples
  std::optional<DirectStats> direct;  // detailed statistics of exact surfaces
  std::optional<SolverStats> solver;  // if a solver by name traced them
};

// A number of a representation that reports show next to its costs, such as {"triangles", 1200}.
struct RepresentationFact {
  std::string name;  // of [a-z_], with its unit at the end: "cell_mm"
  double value = 0;
};

class Representation {
 public:
  virtual ~Representation() = default;

  // The role in reports and file names, which consists of [a-z0-9-]: "direct", "baseline".
  virtual std::string name() const = 0;
  // The readable name.
  virtual std::string title() const = 0;
  // The time of making the representation, once for all its views, ms.
  virtual double make_ms() const { return 0; }
  // Differences of depth up to this many mm are due to the number format, not to the shape.
  virtual double noise_mm() const { return 0; }
  virtual std::vector<RepresentationFact> facts() const { return {}; }
  // The scene of exact surfaces that it traces; null if there is none. Lines, and inspections that need a
  // surface, use it.
  virtual const Scene* exact() const { return nullptr; }
  // Returns whether the samples have the placed-face ids of the model.
  virtual bool names_faces() const { return true; }

  // Traces a view. Errors: the errors of the tracer.
  virtual Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                                   const Execution& execution) const = 0;

  // Makes the rays of light, which start on the surfaces. The representation must outlive them. Errors: kLimitExceeded,
  // kCancelled, kBadUsage (the representation has no such rays, or no structure has the name).
  virtual Result<std::unique_ptr<SecondaryRays>> MakeRays(const SecondaryRaysRequest& request,
                                                          const Execution& execution) const;
};

// The exact surfaces of a scene, which must outlive the representation.
class ExactSurfaces final : public Representation {
 public:
  // `options` supply the precision, the check, the tolerance, the sections, and the memory limit of leaves.
  // All other options come from the request.
  ExactSurfaces(const Scene& scene, DirectOptions options, std::string name = "direct",
                std::string title = "Direct")
      : scene_(scene), options_(std::move(options)), name_(std::move(name)), title_(std::move(title)) {}

  std::string name() const override { return name_; }
  std::string title() const override { return title_; }
  const Scene* exact() const override { return &scene_; }
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;
  Result<std::unique_ptr<SecondaryRays>> MakeRays(const SecondaryRaysRequest& request,
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
  // `model` is the model from which the mesh was made, or with which it is compared; its solids get caps
  // where `sections` cut them. `max_bytes` is the memory limit of a tree without the faces of
  // TraceRequest::leave_out.
  Triangles(const BaselineScene& scene, const Model& model, std::span<const SectionPlane> sections,
            std::uint64_t max_bytes);

  std::string name() const override { return "baseline"; }
  std::string title() const override { return "Baseline"; }
  double make_ms() const override { return scene_.mesh().mesh_ms + scene_.build_ms(); }
  double noise_mm() const override { return scene_.noise_mm(); }
  std::vector<RepresentationFact> facts() const override;
  bool names_faces() const override { return scene_.mesh().from_model; }
  // Requires a mesh with face ids if the request leaves out faces.
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;
  Result<std::unique_ptr<SecondaryRays>> MakeRays(const SecondaryRaysRequest& request,
                                                  const Execution& execution) const override;

 private:
  const BaselineScene& scene_;
  const std::span<const SectionPlane> sections_;
  std::optional<SectionSolids> solids_;  // only with sections
  const std::uint64_t max_bytes_;
};

}  // namespace facetless
