// What the oracle says to the renderer's samples.
//
//  1. A sample claims that nothing is hit, or that one face is hit at one depth and nothing nearer. It is
//     right if the oracle's crossings agree: a claimed hit matches a crossing of that face, or of any other,
//     within the depth bound, and no crossing that certainly belongs to its face lies nearer by more than
//     that bound; a claimed miss has no such crossing at all.
//  2. The depth bound is the sample's own where the renderer states one (SampleBuffer::depth_error), else
//     kDepthShare of the model's diagonal over |N·D|.
//  3. A ray that is moved sideways by little must give the sample's answer, by p-curves alone, if the sample
//     is to be excused by an edge or by rounding: an answer that no neighbouring ray has, such as light
//     through a seam, is never excused. `reach_mm` is the least of the distances tried that does; infinite:
//     none up to kDescribedShare of the diagonal.
//  4. kWithinRounding: reach_mm is at most kRayRounding of the distances involved, the rounding of a camera
//     in double. Nothing in double can know better which side of a border it is on. kAtEdge: right if one
//     takes the answer at an edge as free, where the ray passes the 3D edge within the gap that the model
//     records for it (oracle.h, law 4), and reach_mm is at most kReachInGaps of that gap: the p-curves of
//     both faces may lie a gap off the edge, on either side. kAtTwiceTheGap: the same at twice the gap, which
//     is what the renderer allows for how gaps are measured.
//  5. kUndecided: right only if a crossing that the oracle itself can't settle goes the sample's way.
//  6. kWrong: anything else.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/trace/direct.h"
#include "render/view/camera.h"
#include "tests/verify/oracle/oracle.h"

namespace facetless::oracle {

inline constexpr double kDepthShare = 1e-12;
// A camera's axes are rounded to a few units in the last place, and so is a pixel's place along them.
inline constexpr double kRayRounding = 0x1p-49;
inline constexpr double kReachInGaps = 4;
inline constexpr double kDescribedShare = 1e-3;

enum class Verdict : std::uint8_t { kRight, kAtEdge, kAtTwiceTheGap, kWithinRounding, kUndecided, kWrong };
inline constexpr std::size_t kVerdicts = 6;
const char* VerdictName(Verdict verdict);

// One sample of the renderer.
struct Claim {
  int column = 0, row = 0;
  bool hit = false;
  double depth = 0;
  std::uint32_t placed_face = kNoIndex;
  Certificate certificate = Certificate::kUnresolved;
  double depth_error = 0;  // mm; 0 or infinite: none is stated
};

struct Judgement {
  Verdict verdict = Verdict::kRight;
  Claim claim;
  bool matched = false;
  double depth_off_mm = 0;  // of the crossing that the claim matches
  double bound_mm = 0;
  bool other_face = false;  // matched at the same depth, but another face's
  // For the reader of a list, where the verdict is not kRight: the oracle's first certain hit.
  double oracle_depth = 0;  // infinite: none
  std::uint32_t oracle_face = kNoIndex;
  double cosine = 0, trim_mm = 0;
  double edge_mm = 0, gap_mm = 0;  // of the edges that the judgement leans on, the one with the largest gap
  double reach_mm = 0;
  std::string why;
};

class Judge {
 public:
  // Requires the model that `oracle` was made of to be the one that was rendered.
  Judge(const Oracle& oracle, const Camera& camera);

  Judgement Ask(const Claim& claim) const;

  // The claim of one pixel.
  static Claim MakeClaim(const SampleBuffer& samples, int column, int row);

 private:
  enum class Leniency { kNone, kEdge, kTwiceTheGap, kDoubts };
  // `moved_mm`: by how much the ray was moved; depths may differ by what that makes on their slopes.
  bool Agrees(const ViewRay& ray, const std::vector<Crossing>& crossings, const Claim& claim,
              Leniency leniency, double moved_mm, Judgement& judgement) const;
  double Reach(const ViewRay& ray, const Claim& claim) const;
  void Explain(const std::vector<Crossing>& crossings, Judgement& judgement) const;
  double RoundingAt(const Claim& claim) const;

  const Oracle& oracle_;
  View view_;
  double near_ = 0;
};

// Tables of judgements.
struct Tally {
  std::array<std::array<std::uint64_t, kVerdicts>, 3> counts{};  // [certificate][verdict]
  std::array<double, 3> largest_off_mm{};                        // [certificate], of matched depths
  std::array<double, 3> largest_share_of_bound{};
  std::uint64_t other_face = 0;
  std::uint64_t samples = 0;
  std::vector<Judgement> list;  // those other than kRight, the certified ones first by the caller's order

  void Add(const Judgement& judgement);
  std::uint64_t Count(Certificate certificate, Verdict verdict) const {
    return counts[static_cast<std::size_t>(certificate)][static_cast<std::size_t>(verdict)];
  }
  std::uint64_t CertifiedWrong() const { return Count(Certificate::kCertified, Verdict::kWrong); }
};

// Judges the pixels (row·width + column) in parallel, in their order.
Tally JudgePixels(const Judge& judge, const SampleBuffer& samples, const std::vector<std::uint32_t>& pixels);

// One line on a judgement.
std::string Describe(const Judgement& judgement, const Model& model);

}  // namespace facetless::oracle
