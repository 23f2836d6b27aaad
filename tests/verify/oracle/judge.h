// The oracle's verdicts on the renderer's samples.
//
//  1. A sample claims that nothing is hit, or that one face is hit at one depth and nothing is nearer. It is
//     right if the oracle's crossings agree: a claimed hit matches a crossing of that face, or of any other,
//     within the depth bound, and no crossing that certainly belongs to its face is nearer by more than that
//     bound. For a claimed miss there must be no such crossing at all.
//  2. The depth bound is the sample's own if the renderer states one (SampleBuffer::depth_error), else
//     kDepthShare of the model's diagonal divided by |N·D|.
//  3. If a sample is to be excused by an edge or by rounding, a ray that is moved sideways by a small
//     distance must give the sample's answer, by p-curves alone. An answer that no neighbouring ray has, such
//     as light through a seam, is never excused. `reach_mm` is the smallest distance tried at which a ray
//     gives the answer; infinite: none up to kDescribedShare of the diagonal.
//  4. kWithinRounding: reach_mm is at most kRayRounding of the distances involved, which is the rounding of a
//     camera in double. No computation in double can determine on which side of a border such a ray is.
//     kAtEdge: the sample is right if either answer is accepted where the ray passes the 3D edge within the
//     gap that the model records for it (oracle.h, law 4), and reach_mm is at most kReachInGaps of that gap:
//     the p-curves of both faces may lie a gap off the edge, on either side. kAtTwiceTheGap: the same at
//     twice the gap, which is what the renderer allows because of the way gaps are measured.
//  5. kUndecided: the sample is right only if a crossing that the oracle itself cannot decide agrees with the
//     sample.
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
// A camera's axes are rounded to a few units in the last place, and so is a pixel's position along them.
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
  double depth_error = 0;  // mm; 0 or infinite: no bound is stated
};

struct Judgement {
  Verdict verdict = Verdict::kRight;
  Claim claim;
  bool matched = false;
  double depth_off_mm = 0;  // error relative to the crossing that the claim matches
  double bound_mm = 0;
  bool other_face = false;  // matches a crossing at the same depth, but of another face
  // For the reader of a list, if the verdict is not kRight: the oracle's first certain hit.
  double oracle_depth = 0;  // infinite: none
  std::uint32_t oracle_face = kNoIndex;
  double cosine = 0, trim_mm = 0;
  // Of the edges on which the judgement depends, the one with the largest gap.
  double edge_mm = 0, gap_mm = 0;
  double reach_mm = 0;
  std::string why;
};

class Judge {
 public:
  // Requires that `oracle` was made of the model that was rendered.
  Judge(const Oracle& oracle, const Camera& camera);

  Judgement Ask(const Claim& claim) const;

  // Returns the claim of one pixel.
  static Claim MakeClaim(const SampleBuffer& samples, int column, int row);

 private:
  enum class Leniency { kNone, kEdge, kTwiceTheGap, kDoubts };
  // `moved_mm` is the distance by which the ray was moved. Depths may differ by what this makes on their
  // slopes.
  bool Agrees(const ViewRay& ray, const std::vector<Crossing>& crossings, const Claim& claim,
              Leniency leniency, double moved_mm, Judgement& judgement) const;
  double Reach(const ViewRay& ray, const Claim& claim) const;
  void Explain(const std::vector<Crossing>& crossings, Judgement& judgement) const;
  double RoundingAt(const Claim& claim) const;

  const Oracle& oracle_;
  View view_;
  double near_ = 0;
};

// Counts of judgements.
struct Tally {
  std::array<std::array<std::uint64_t, kVerdicts>, 3> counts{};  // [certificate][verdict]
  std::array<double, 3> largest_off_mm{};                        // [certificate], for matched depths
  std::array<double, 3> largest_share_of_bound{};
  std::uint64_t other_face = 0;
  std::uint64_t samples = 0;
  std::vector<Judgement> list;  // those other than kRight; the caller sorts the certified ones first

  void Add(const Judgement& judgement);
  std::uint64_t Count(Certificate certificate, Verdict verdict) const {
    return counts[static_cast<std::size_t>(certificate)][static_cast<std::size_t>(verdict)];
  }
  std::uint64_t CertifiedWrong() const { return Count(Certificate::kCertified, Verdict::kWrong); }
};

// Judges the pixels (row·width + column) in parallel. The results are in their order.
Tally JudgePixels(const Judge& judge, const SampleBuffer& samples, const std::vector<std::uint32_t>& pixels);

// Returns one line about a judgement.
std::string Describe(const Judgement& judgement, const Model& model);

}  // namespace facetless::oracle
