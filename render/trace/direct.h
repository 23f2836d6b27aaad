// The direct renderer, which traces the exact surfaces of a model.
//
//     const Scene scene(model);
//     Result<DirectResult> result = TraceDirect(scene, camera, {.uv = true});
//     if (!result) return result.error();
//     const SampleBuffer& samples = result.value().samples;
//
//  1. A Scene holds the data that does not depend on the view (trimming structures, occurrence tables). It is
//     immutable, and several threads may use it at once. The model must outlive it.
//  2. TraceDirect projects the patches, splits them into leaves, builds the bitmaps, and traces every pixel
//     centre of the camera. The samples are the same bytes for any number of threads and any instruction set.
//  3. Every sample is counted: stats.certified + stats.converged + stats.unresolved = width·height.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "render/base/execution.h"
#include "render/model/model.h"
#include "render/view/camera.h"
#include "render/view/doubt.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"
#include "render/view/section.h"

namespace facetless {

// The arithmetic of the kernels, and how much of the certificate is proven.
enum class Precision : std::uint8_t {
  kFast,       // single precision in the frame of each leaf; the bounds include the rounding
  kStandard,   // double precision
  kCertified,  // double precision, and also the proof that no other face lies within the error of the depth
};

// Which certified samples CertificateCheck (certificate_check.h) verifies. It verifies none if
// DirectOptions::leave_out is set.
enum class CheckLevel : std::uint8_t {
  kAuto,  // kShare with Precision::kCertified, kAll with an audit, else kNone
  kNone,
  // one root in kRootsPerCheckedRoot (of leaves without a certificate, every one), one ray in
  // kRaysPerCheckedRay
  kShare,
  kAll,  // every root, and one ray in kRaysPerAuditedRay
};
// With these values, the check takes less than a tenth of TraceDirect's instructions
// (docs/accuracy-proof.md).
inline constexpr int kRootsPerCheckedRoot = 16;
inline constexpr int kRaysPerCheckedRay = 32768, kRaysPerAuditedRay = 512;  // powers of two

// The results of the check for the samples of one view.
struct CheckStats {
  std::uint64_t roots = 0,
                roots_contradicted = 0;  // certified hits that were verified, and those that do not hold
  // Rays that were verified by subdivision, those on which a nearer hit was found, and those given up.
  std::uint64_t rays = 0, rays_contradicted = 0, rays_open = 0;

  void Add(const CheckStats& other) {
    roots += other.roots;
    roots_contradicted += other.roots_contradicted;
    rays += other.rays;
    rays_contradicted += other.rays_contradicted;
    rays_open += other.rays_open;
  }
};

// The accuracy with which exact surfaces are traced, and the memory limit. All runs use this struct, from the
// command line to the kernels.
struct ExactTraceOptions {
  Precision precision = Precision::kStandard;
  CheckLevel check = CheckLevel::kAuto;
  double newton_tolerance = 0;  // error bound of a root, as a share of half its leaf, at which the iteration
                                // stops; 0: the default of the precision (2^-42; kFast: 2^-17)
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // memory limit of the leaves of a view
};

struct DirectOptions {
  Execution execution;
  ExactTraceOptions accuracy;
  bool uv = false;           // fill samples.uv
  bool depth_error = false;  // fill samples.depth_error
  bool audit = false;  // count every crossing of every ray, with the whole model even if there are sections
  std::vector<SectionPlane> sections;  // the planes that cut the model; certificates then cover the whole ray
  // Indexed by placed face: rays ignore the faces that are set. Null: no face is ignored. It must not be
  // combined with sections or an audit, because solids would be open.
  const std::vector<bool>* leave_out = nullptr;
  // Which pixels are traced again with several samples. Null: none. Not with sections.
  const RefineRequest* refine = nullptr;
};

struct DirectStats {
  double prepare_ms = 0, trace_ms = 0;
  double refine_ms = 0;            // of the refinement: choosing pixels, preparing and tracing them
  std::uint64_t refine_bytes = 0;  // memory of its leaves and bitmaps, beside scene_bytes
  std::uint64_t rays = 0, hits = 0, leaves = 0, hard_leaves = 0;
  std::uint64_t candidates = 0, solves = 0, iterations = 0, fallbacks = 0, trim_tests = 0;
  std::uint64_t certified = 0, converged = 0, unresolved = 0, certified_hits = 0;
  std::uint64_t caps = 0;                                  // number of hits on caps of section planes
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};  // samples with each bit of Doubt
  double depth_error_max = 0;                              // largest error bound of the certified hits, mm
  CheckStats check;
  std::optional<std::uint64_t> odd_rays;            // audit only; null if the model has no closed solid
  std::optional<std::uint64_t> reverse_mismatches;  // audit only
  std::vector<std::uint32_t> odd_samples, mismatched_samples;  // audit only: row·width + column of these rays
  std::vector<std::uint32_t> unseen_faces;  // ids of the placed faces without a bit in any row or column
  std::uint64_t bmssm_bits = 0, bmssm_bytes = 0;
  std::uint64_t scene_bytes = 0;  // memory of the leaves and of all other tracing data, without the model
  std::string isa;                // "scalar", "avx2", "avx512"
};

struct DirectResult {
  CameraFrame frame;
  SampleBuffer samples;
  DirectStats stats;                     // of the pixel centres
  std::optional<Refinement> refinement;  // if one was requested; see RefineRequest::ray_starts
};

class Scene {
 public:
  explicit Scene(const Model& model);
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  const Model& model() const;

  struct Data;
  const Data& data() const { return *data_; }

 private:
  std::unique_ptr<Data> data_;
};

// Traces a view. Errors: kBadUsage (camera, sections, a refinement with sections), kLimitExceeded (the leaves exceed
// the memory limit), kCancelled.
Result<DirectResult> TraceDirect(const Scene& scene, const Camera& camera, const DirectOptions& options);

// The instruction set of the kernels. FACETLESS_ISA=scalar|avx2|avx512 forces one. Error: kBadUsage (the
// processor lacks the forced set).
Result<std::string> ActiveIsa();

}  // namespace facetless
