// The direct renderer against OpenCASCADE's exact intersector: same file, same rays, and a verdict on every
// ray where they differ.
//
//  1. The nearer of the two hits is a claim: it says that there is a surface, and the other says that there
//     is none. ExactReference::Judge decides whether the claim holds, so each difference ends with one of the
//     verdicts below.
//  2. Two depths agree if they differ by at most kAgreement of the model's diagonal.
//  3. Of a part that is placed several times, one placement is compared where `one_placement` is asked for.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/model/model.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"
#include "tests/verify/differential/exact_reference.h"

namespace facetless {

inline constexpr double kAgreement = 1e-7;

enum class Verdict : std::uint8_t {
  kAgree,  // both miss, or both hit at the same depth
  // The ray passes an edge within the tolerance that the shape gives it. Either may be right; the side on
  // which the ray passes the edge's 3D curve speaks for one of the two.
  kEdgeForOurs,
  kEdgeForReference,
  kReferenceLost,       // our hit is on a face: the reference lost it
  kReferenceInvented,   // the reference's hit is on no face
  kReferenceImprecise,  // both on the same spot of one surface; ours is the nearer to it
  kOursLost,            // our defect: the reference's hit is on a face
  kOursInvented,        // our defect: our hit is on no face
  kOursImprecise,       // our defect: as above, the reference's is the nearer
};
inline constexpr std::size_t kVerdicts = 9;
const char* VerdictName(Verdict verdict);

// Verdicts that are defects of Facetless.
bool IsDefect(Verdict verdict);

struct Difference {
  int column = 0, row = 0;
  Verdict verdict = Verdict::kAgree;
  double ours = 0, reference = 0;  // depths in mm; +inf: missed
  std::uint32_t our_face = kNoIndex;
  int reference_face = -1;
  Certificate certificate = Certificate::kUnresolved;  // of our sample
  Judgement claim;                                     // on the nearer hit
};

struct ViewComparison {
  std::string view;
  std::uint64_t rays = 0, ours_hit = 0, both_hit = 0, both_within = 0;
  std::uint64_t hit_miss = 0;                     // one hit, the other missed
  std::array<std::uint64_t, kVerdicts> counts{};  // by Verdict
  std::uint64_t reference_failures = 0;           // rays on which the reference threw
  double max_agreeing_mm = 0;                     // largest |depth difference| of those within
  double max_difference_mm = 0;                   // of all where both hit
  double ours_ms = 0, reference_ms = 0;
  std::vector<Difference> differences;

  double ShareWithin() const {
    return both_hit ? static_cast<double>(both_within) / static_cast<double>(both_hit) : 1;
  }
  double ShareHitMiss() const { return rays ? static_cast<double>(hit_miss) / static_cast<double>(rays) : 0; }
  std::uint64_t Defects() const;
};

// A file, both ways.
struct ComparedFile {
  Model model;
  ExactReference reference;
};

// Imports the file as facetless-import does, and reads it again for the reference (after the same repairs of
// the text). Errors: those of either.
Result<ComparedFile> LoadBoth(const std::string& path, bool one_placement);

// Traces the view twice and judges. Errors: those of TraceDirect.
Result<ViewComparison> CompareView(ComparedFile& file, const Scene& scene, const Camera& camera);

// One line on a difference, for people who look for its cause.
std::string Describe(const Difference& difference, const ComparedFile& file);

}  // namespace facetless
