// Compares the direct renderer with OpenCASCADE's exact intersector: same file, same rays, and a verdict on
// every ray on which they differ.
//
//  1. The nearer of the two hits is a claim: it says that there is a surface, and the other answer says that
//     there is none. ExactReference::Judge decides whether the claim is true, so each difference gets one of
//     the verdicts below.
//  2. Two depths agree if they differ by at most kAgreement of the model's diagonal.
//  3. With `one_placement`, only one placement of each part is compared.
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
  // The ray passes an edge within the tolerance that the shape gives to the edge. Either answer may be right.
  // The side on which the ray passes the edge's 3D curve supports one of the two.
  kEdgeForOurs,
  kEdgeForReference,
  kReferenceLost,       // our hit is on a face, and the reference has lost it
  kReferenceInvented,   // the reference's hit is on no face
  kReferenceImprecise,  // both are on the same spot of one surface, and ours is nearer to it
  kOursLost,            // our defect: the reference's hit is on a face
  kOursInvented,        // our defect: our hit is on no face
  kOursImprecise,       // our defect: as above, but the reference's is nearer
};
inline constexpr std::size_t kVerdicts = 9;
const char* VerdictName(Verdict verdict);

// Returns whether the verdict is a defect of Facetless.
bool IsDefect(Verdict verdict);

struct Difference {
  int column = 0, row = 0;
  Verdict verdict = Verdict::kAgree;
  double ours = 0, reference = 0;  // depths in mm; +inf: missed
  std::uint32_t our_face = kNoIndex;
  int reference_face = -1;
  Certificate certificate = Certificate::kUnresolved;  // of our sample
  Judgement claim;                                     // about the nearer hit
};

struct ViewComparison {
  std::string view;
  std::uint64_t rays = 0, ours_hit = 0, both_hit = 0, both_within = 0;
  std::uint64_t hit_miss = 0;                     // one hits, the other misses
  std::array<std::uint64_t, kVerdicts> counts{};  // by Verdict
  std::uint64_t reference_failures = 0;           // rays on which the reference threw an exception
  double max_agreeing_mm = 0;                     // largest |depth difference| of those that agree
  double max_difference_mm = 0;                   // largest difference where both hit
  double ours_ms = 0, reference_ms = 0;
  std::vector<Difference> differences;

  double ShareWithin() const {
    return both_hit ? static_cast<double>(both_within) / static_cast<double>(both_hit) : 1;
  }
  double ShareHitMiss() const { return rays ? static_cast<double>(hit_miss) / static_cast<double>(rays) : 0; }
  std::uint64_t Defects() const;
};

// A file, read by both sides.
struct ComparedFile {
  Model model;
  ExactReference reference;
};

// Imports the file as facetless-import does, and reads it again for the reference, after the same repairs of
// the text. Errors: those of either side.
Result<ComparedFile> LoadBoth(const std::string& path, bool one_placement);

// Traces the view with both and judges the differences. Errors: those of TraceDirect.
Result<ViewComparison> CompareView(ComparedFile& file, const Scene& scene, const Camera& camera);

// Returns one line about a difference, for readers who look for its cause.
std::string Describe(const Difference& difference, const ComparedFile& file);

}  // namespace facetless
