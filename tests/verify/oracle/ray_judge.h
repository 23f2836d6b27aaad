// The oracle's verdicts on rays that start on surfaces (render/view/secondary_rays.h).
//
//  1. The ray is the line through the start's position along the direction, both taken as exact. The start's own
//     crossing is the one on the start's face that is nearest to the position, as seen along the normal; it must lie
//     within kOwnShare of the model's diagonal.
//  2. A claim that the ray is blocked is right if another crossing lies inside its face, in front of the start and within
//     the length. A claim that it is clear is right if none does. A nearest hit is right if its face and distance are
//     those of the first such crossing, within the bound that the hit states and what rounds in a double.
//  3. kAtEdge: the answer is right if a crossing counts that passes an edge of its face within twice the edge's gap, or
//     if one does not count (oracle.h, law 4). kUndecided: it is right if a crossing counts, or does not count, that
//     the oracle cannot decide. kWrong: anything else.
#pragma once

#include "render/view/secondary_rays.h"
#include "tests/verify/oracle/judge.h"
#include "tests/verify/oracle/oracle.h"

namespace facetless::oracle {

inline constexpr double kOwnShare = 1e-9;

class RayJudge {
 public:
  // `oracle` must outlive the judge.
  explicit RayJudge(const Oracle& oracle) : oracle_(oracle) {}

  Verdict Passage(const RayStart& start, const SecondaryRay& ray, const RayPassage& passage) const;
  Verdict Hit(const RayStart& start, const SecondaryRay& ray, const SecondaryHit& hit) const;
  // For the reader of a list: the crossings of the ray.
  std::string Describe(const RayStart& start, const SecondaryRay& ray) const;

 private:
  struct Meeting {
    Crossing crossing;
    bool counts = false;   // by the p-curves
    bool at_edge = false;  // an edge may decide otherwise
    bool undecided = false;
  };
  std::vector<Meeting> Meetings(const RayStart& start, const SecondaryRay& ray) const;

  const Oracle& oracle_;
};

}  // namespace facetless::oracle
