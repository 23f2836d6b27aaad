// The direct renderer: from a model and a camera to samples, on the exact surfaces.
//
//  1. A Scene is what does not depend on the view (trimming structures, occurrence tables); it is immutable
//     and may serve many calls at once. The Model must outlive it.
//  2. TraceDirect projects, splits into leaves, numbers them in bitmaps and traces every pixel centre of the
//     camera. Its samples are the same bytes for any number of threads and any instruction set.
//  3. Nothing is silent: stats.certified + stats.converged + stats.unresolved = width·height.
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
#include "render/view/samples.h"
#include "render/view/section.h"

namespace facetless {

// What a sample's certificate stands on.
enum class Precision : std::uint8_t {
  kFast,       // kernels in single precision, in each leaf's own frame; bounds include their rounding
  kStandard,   // double precision
  kCertified,  // double precision, and the rest of the proof: no other face within the error of the depth
};

// How many certified samples CertificateCheck (certificate_check.h) tests again; none where
// DirectOptions::leave_out is set.
enum class CheckLevel : std::uint8_t {
  kAuto,  // kShare with Precision::kCertified, kAll with an audit, else kNone
  kNone,
  // one root in kRootsPerCheckedRoot (of leaves without a certificate, every one), one ray in
  // kRaysPerCheckedRay
  kShare,
  kAll,  // every root, and one ray in kRaysPerAuditedRay
};
// Chosen so that the share costs less than a tenth of TraceDirect's instructions (docs/accuracy-proof.md).
inline constexpr int kRootsPerCheckedRoot = 16;
inline constexpr int kRaysPerCheckedRay = 32768, kRaysPerAuditedRay = 512;  // powers of two

// What the check said, of this view's samples.
struct CheckStats {
  std::uint64_t roots = 0, roots_contradicted = 0;  // certified hits asked again, and those that do not hold
  // Rays followed by subdivision, those on which a nearer hit was found, and those given up.
  std::uint64_t rays = 0, rays_contradicted = 0, rays_open = 0;

  void Add(const CheckStats& other) {
    roots += other.roots;
    roots_contradicted += other.roots_contradicted;
    rays += other.rays;
    rays_contradicted += other.rays_contradicted;
    rays_open += other.rays_open;
  }
};

// How accurately exact surfaces are traced, and how much memory that may take: what every run says in the same
// way, from the command line to the kernels.
struct ExactTraceOptions {
  Precision precision = Precision::kStandard;
  CheckLevel check = CheckLevel::kAuto;
  double newton_tolerance = 0;  // a root's error bound, as a share of half its leaf, at which the iteration
                                // stops; 0: the precision's own (2^-42, fast 2^-17)
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // what the leaves of a view may take
};

struct DirectOptions {
  Execution execution;
  ExactTraceOptions accuracy;
  bool uv = false;           // fill samples.uv
  bool depth_error = false;  // fill samples.depth_error
  bool audit = false;        // count every crossing of every ray; of the whole model, sections or not
  std::vector<SectionPlane> sections;  // what is cut away; certified samples then answer for their whole ray
  // By placed face: those that rays pass as if they were not there. Null: none. Not with sections or an
  // audit, whose solids would be open.
  const std::vector<bool>* leave_out = nullptr;
};

struct DirectStats {
  double prepare_ms = 0, trace_ms = 0;
  std::uint64_t rays = 0, hits = 0, leaves = 0, hard_leaves = 0;
  std::uint64_t candidates = 0, solves = 0, iterations = 0, fallbacks = 0, trim_tests = 0;
  std::uint64_t certified = 0, converged = 0, unresolved = 0, certified_hits = 0;
  std::uint64_t caps = 0;                                  // hits on caps of section planes
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};  // samples with each bit of Doubt
  double depth_error_max = 0;                              // mm, of the certified hits
  CheckStats check;
  std::optional<std::uint64_t> odd_rays;            // audit only; null where the model has no closed solid
  std::optional<std::uint64_t> reverse_mismatches;  // audit only
  std::vector<std::uint32_t> odd_samples, mismatched_samples;  // audit only: row·width + column of those rays
  std::vector<std::uint32_t> unseen_faces;  // placed-face ids that no row or no column holds
  std::uint64_t bmssm_bits = 0, bmssm_bytes = 0;
  std::uint64_t scene_bytes = 0;  // leaves and all that tracing holds, without the model
  std::string isa;                // "scalar", "avx2", "avx512"
};

struct DirectResult {
  CameraFrame frame;
  SampleBuffer samples;
  DirectStats stats;
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

// Errors: kBadUsage (camera, sections), kLimitExceeded (more leaves than memory allows), kCancelled.
Result<DirectResult> TraceDirect(const Scene& scene, const Camera& camera, const DirectOptions& options);

// The instruction set that the kernels run on: FACETLESS_ISA=scalar|avx2|avx512 forces one (kBadUsage if the
// machine lacks it).
Result<std::string> ActiveIsa();

}  // namespace facetless
