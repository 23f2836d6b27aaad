#include "tests/verify/differential/differential.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "import/bounds.h"
#include "import/convert.h"
#include "import/readers.h"
#include "import/source_file.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

double MillisecondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

void IgnoreProgress(const char*, double) {}

// Keeps only the first instance of each part.
void KeepOnePlacement(Model& model) {
  std::vector<bool> seen(model.parts.size(), false);
  std::vector<Instance> kept;
  std::uint32_t next = 0;
  for (Instance& instance : model.instances) {
    if (seen[instance.part]) continue;
    seen[instance.part] = true;
    instance.first_placed_face = next;
    next += model.parts[instance.part].faces.count;
    kept.push_back(std::move(instance));
  }
  model.instances = std::move(kept);
  model.bounds = PlacedBounds(model);
}

// Decides which answer is right if they differ.
Verdict Decide(const Ray& ray, double ours, double reference, double tolerance, ExactReference& exact,
               Judgement& claim) {
  const bool ours_is_nearer = ours < reference;
  claim = exact.Judge(ray, std::min(ours, reference), tolerance);
  if (claim.standing == Standing::kEdge)
    return claim.inside_edge == ours_is_nearer ? Verdict::kEdgeForOurs : Verdict::kEdgeForReference;
  // If both hits are on one surface, and differ by more than the tolerance along the ray but not across the
  // surface, the hit that is nearer to the surface is right.
  if (std::isfinite(ours) && std::isfinite(reference)) {
    const Judgement other = exact.Judge(ray, std::max(ours, reference), tolerance);
    if (other.face == claim.face && other.standing != Standing::kEdge &&
        std::fabs(ours - reference) * claim.cosine <= tolerance) {
      const bool claim_is_better = claim.surface_mm <= other.surface_mm;
      return claim_is_better == ours_is_nearer ? Verdict::kReferenceImprecise : Verdict::kOursImprecise;
    }
  }
  if (claim.standing == Standing::kOn) return ours_is_nearer ? Verdict::kReferenceLost : Verdict::kOursLost;
  return ours_is_nearer ? Verdict::kOursInvented : Verdict::kReferenceInvented;
}

}  // namespace

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAgree:
      return "agree";
    case Verdict::kEdgeForOurs:
      return "at an edge, which speaks for ours";
    case Verdict::kEdgeForReference:
      return "at an edge, which speaks for the reference";
    case Verdict::kReferenceLost:
      return "reference lost it";
    case Verdict::kReferenceInvented:
      return "reference invented it";
    case Verdict::kReferenceImprecise:
      return "reference imprecise";
    case Verdict::kOursLost:
      return "ours lost it";
    case Verdict::kOursInvented:
      return "ours invented it";
    case Verdict::kOursImprecise:
      return "ours imprecise";
  }
  return "";
}

bool IsDefect(Verdict verdict) {
  return verdict == Verdict::kOursLost || verdict == Verdict::kOursInvented ||
         verdict == Verdict::kOursImprecise;
}

std::uint64_t ViewComparison::Defects() const {
  std::uint64_t defects = 0;
  for (std::size_t v = 0; v < kVerdicts; ++v) defects += IsDefect(static_cast<Verdict>(v)) ? counts[v] : 0;
  return defects;
}

Result<ComparedFile> LoadBoth(const std::string& path, bool one_placement) {
  static const TemporaryFolder scratch;
  if (scratch.path().empty())
    return Error{ErrorCode::kWriteFailed, "No folder for temporary files can be made; set TMPDIR to one."};
  PrepareOpenCascade(scratch.path());
  // Import.
  Result<SourceFile> source = OpenSource(path, scratch.path());
  if (!source.ok()) return source.error();
  Result<CadDocument> document = ReadDocument(source.value(), &IgnoreProgress);
  if (!document.ok()) return document.error();
  Result<Conversion> conversion = Convert(std::move(document.value()), [](double) {});
  if (!conversion.ok()) return conversion.error();
  Model model = std::move(conversion.value().model);
  if (one_placement) KeepOnePlacement(model);
  if (const Result<void> valid = Validate(model); !valid.ok()) return valid.error();
  // Read the file again with OpenCASCADE's plain reader.
  Result<ExactReference> reference = ExactReference::Load(source.value().path, one_placement);
  if (!reference.ok()) return reference.error();
  return ComparedFile{std::move(model), std::move(reference.value())};
}

Result<ViewComparison> CompareView(ComparedFile& file, const Scene& scene, const Camera& camera) {
  ViewComparison view;
  view.view = camera.name;
  // Trace with the direct renderer.
  auto begin = std::chrono::steady_clock::now();
  const Result<DirectResult> direct = TraceDirect(scene, camera, {});
  if (!direct.ok()) return direct.error();
  view.ours_ms = MillisecondsSince(begin);
  const CameraFrame& frame = direct.value().frame;
  const SampleBuffer& samples = direct.value().samples;
  const double tolerance = kAgreement * file.model.Diagonal();
  const double near = frame.projection == Projection::kOrthographic ? -INFINITY : frame.near_mm;
  // Trace with the reference. Its time does not include the judging.
  for (int row = 0; row < samples.height; ++row) {
    for (int column = 0; column < samples.width; ++column) {
      const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(samples.width) +
                             static_cast<std::size_t>(column);
      const Ray ray = PixelRay(frame, column + 0.5, row + 0.5);
      begin = std::chrono::steady_clock::now();
      const ReferenceHit hit = file.reference.Nearest(ray, near);
      view.reference_ms += MillisecondsSince(begin);
      const double ours = samples.depth[at];
      const bool ours_hit = samples.face[at] != kNoIndex;
      ++view.rays;
      view.reference_failures += hit.failed ? 1 : 0;
      view.ours_hit += ours_hit ? 1 : 0;
      view.hit_miss += ours_hit != hit.hit() ? 1 : 0;
      Difference difference{column,           row,      Verdict::kAgree,         ours, hit.depth,
                            samples.face[at], hit.face, samples.certificate[at], {}};
      if (ours_hit && hit.hit()) {
        const double apart = std::fabs(ours - hit.depth);
        ++view.both_hit;
        view.max_difference_mm = std::max(view.max_difference_mm, apart);
        if (apart <= tolerance) {
          ++view.both_within;
          view.max_agreeing_mm = std::max(view.max_agreeing_mm, apart);
        } else {
          difference.verdict = Decide(ray, ours, hit.depth, tolerance, file.reference, difference.claim);
        }
      } else if (ours_hit || hit.hit()) {
        difference.verdict = Decide(ray, ours, hit.depth, tolerance, file.reference, difference.claim);
      }
      ++view.counts[static_cast<std::size_t>(difference.verdict)];
      if (difference.verdict != Verdict::kAgree) view.differences.push_back(difference);
    }
  }
  return view;
}

std::string Describe(const Difference& difference, const ComparedFile& file) {
  constexpr const char* kCertificates[] = {"certified", "converged", "unresolved"};
  const std::string our_face =
      difference.our_face == kNoIndex ? "nothing" : file.model.PlacedFaceName(difference.our_face);
  const std::string reference_face = difference.reference_face < 0
                                         ? "nothing"
                                         : "face " + std::to_string(difference.reference_face) + " (" +
                                               file.reference.SurfaceName(difference.reference_face) + ")";
  const std::string claim_face = difference.claim.face < 0
                                     ? "none"
                                     : std::to_string(difference.claim.face) + " (" +
                                           file.reference.SurfaceName(difference.claim.face) + ")";
  char numbers[400];
  std::snprintf(numbers, sizeof numbers,
                "pixel %d,%d: %s; ours %.9g mm (%s), reference %.9g mm; to the surface %.2g mm, to the edge "
                "%.2g of %.2g mm, "
                "|N.D| %.2g",
                difference.column, difference.row, VerdictName(difference.verdict), difference.ours,
                kCertificates[static_cast<int>(difference.certificate)], difference.reference,
                difference.claim.surface_mm, difference.claim.edge_mm, difference.claim.edge_tolerance_mm,
                difference.claim.cosine);
  return std::string(numbers) + "; ours " + our_face + ", reference " + reference_face + ", claim on " +
         claim_face;
}

}  // namespace facetless
