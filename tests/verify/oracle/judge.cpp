#include "tests/verify/oracle/judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "render/base/parallel.h"

namespace facetless::oracle {
namespace {

// Perspective views do not show anything nearer than this share of the model's diagonal (docs/cameras.md).
constexpr double kNearShare = 1e-9;
// An edge explains a crossing if its distance along the ray is at most the edge's gap at that slant, times
// this factor, because the band is measured generously.
constexpr double kSlantReach = 8;
constexpr double kMostSlant = 64;
// The largest slope that the depth of a moved ray may follow: that of a face seen at an angle whose cosine is
// the inverse.
constexpr double kMovedSlope = 1000;

View ViewOf(const Camera& camera) {
  return {camera.eye,    camera.target,    camera.up,       camera.projection == Projection::kPerspective,
          camera.height, camera.fov_y_deg, camera.width_px, camera.height_px};
}

}  // namespace

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight:
      return "right";
    case Verdict::kAtEdge:
      return "at an edge";
    case Verdict::kAtTwiceTheGap:
      return "at twice the gap";
    case Verdict::kWithinRounding:
      return "within rounding";
    case Verdict::kUndecided:
      return "undecided";
    case Verdict::kWrong:
      return "wrong";
  }
  return "";
}

Judge::Judge(const Oracle& oracle, const Camera& camera)
    : oracle_(oracle),
      view_(ViewOf(camera)),
      near_(view_.perspective ? kNearShare * oracle.model().Diagonal() : -INFINITY) {}

Claim Judge::MakeClaim(const SampleBuffer& samples, int column, int row) {
  const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(samples.width) +
                         static_cast<std::size_t>(column);
  Claim claim{column,
              row,
              samples.face[at] != kNoIndex,
              samples.depth[at],
              samples.face[at],
              samples.certificate[at],
              samples.depth_error.empty() ? 0.0 : static_cast<double>(samples.depth_error[at])};
  return claim;
}

double Judge::RoundingAt(const Claim& claim) const {
  const double size = oracle_.model().Diagonal() + Length(view_.eye) + Length(view_.target);
  return kRayRounding * (size + (claim.hit ? std::fabs(claim.depth) : 0));
}

// Laws 1, 3 and 5.
bool Judge::Agrees(const ViewRay& ray, const std::vector<Crossing>& crossings, const Claim& claim,
                   Leniency leniency, double moved_mm, Judgement& judgement) const {
  const double diagonal = oracle_.model().Diagonal();
  const double rounding = RoundingAt(claim);
  // Returns the edge that makes this crossing uncertain, if any.
  const auto edge_at = [&](std::uint32_t face, double depth, double cosine) {
    const double slack = leniency == Leniency::kTwiceTheGap ? 1 : 0;
    const double slant = std::min(kMostSlant, 1 / std::max(cosine, 1e-300));
    EdgeContact best;
    // Gaps differ from edge to edge: search within the largest gap, and compare with each edge's own gap.
    const double largest = oracle_.model().info.max_edge_gap_mm;
    const EdgeContact contact = oracle_.NearestEdge(ray, face, depth, slack * largest + rounding,
                                                    kSlantReach * slant * (2 * largest + rounding));
    if (contact.coedge != kNoIndex && contact.distance_mm <= (1 + slack) * contact.gap_mm + rounding)
      best = contact;
    return best;
  };
  const bool edges =
      leniency == Leniency::kEdge || leniency == Leniency::kTwiceTheGap || leniency == Leniency::kDoubts;
  const auto lean_on = [&](const EdgeContact& contact) {
    if (contact.gap_mm < judgement.gap_mm) return;
    judgement.edge_mm = contact.distance_mm;
    judgement.gap_mm = contact.gap_mm;
  };
  const auto free = [&](const Crossing& crossing) {
    if (leniency == Leniency::kDoubts && crossing.standing == Standing::kUnsure) return true;
    if (!edges) return false;
    const EdgeContact contact =
        edge_at(crossing.placed_face, static_cast<double>(crossing.depth), crossing.cosine);
    if (contact.coedge == kNoIndex) return false;
    lean_on(contact);
    return true;
  };
  const bool states_bound = claim.depth_error > 0 && std::isfinite(claim.depth_error);
  bool covered = !claim.hit;
  double bound = states_bound ? claim.depth_error : kDepthShare * diagonal;
  if (claim.hit) {
    // Find the crossing that the claim means, first among those of its own face.
    for (const bool own : {true, false}) {
      for (const Crossing& crossing : crossings) {
        if ((crossing.placed_face == claim.placed_face) != own || covered) continue;
        const double slope = 1 / std::max(crossing.cosine, 1e-12);
        const double allowed = (states_bound ? claim.depth_error : kDepthShare * diagonal * slope) +
                               2 * moved_mm * std::min(slope, kMovedSlope);
        const double off = static_cast<double>(claim.depth - crossing.depth);
        if (!(std::fabs(off) <= allowed + static_cast<double>(crossing.half_depth))) continue;
        if (crossing.standing != Standing::kInside && !free(crossing)) continue;
        covered = true;
        bound = allowed;
        judgement.matched = crossing.proven;
        judgement.depth_off_mm = off;
        judgement.bound_mm = allowed;
        judgement.cosine = crossing.cosine;
        judgement.other_face = !own;
      }
    }
    // Within an edge's gap, the claim may lie on the continuation of a patch beyond its border, where the
    // oracle finds nothing.
    if (!covered && edges) {
      const EdgeContact contact = edge_at(claim.placed_face, claim.depth, 0);
      covered = contact.coedge != kNoIndex;
      if (covered) lean_on(contact);
    }
  }
  if (!covered) return false;
  // No certain crossing may be nearer.
  for (const Crossing& crossing : crossings) {
    if (claim.hit && !(crossing.depth + crossing.half_depth < claim.depth - bound)) break;
    if (crossing.standing == Standing::kInside && !free(crossing)) return false;
  }
  return true;
}

Judgement Judge::Ask(const Claim& claim) const {
  Judgement judgement;
  judgement.claim = claim;
  const ViewRay ray = ViewPixelRay(view_, claim.column + 0.5, claim.row + 0.5);
  const std::vector<Crossing> crossings = oracle_.Crossings(ray, near_);
  if (Agrees(ray, crossings, claim, Leniency::kNone, 0, judgement)) return judgement;
  Explain(crossings, judgement);
  judgement.reach_mm = Reach(ray, claim);

  const double rounding = RoundingAt(claim);
  const auto at_edge = [&](Leniency leniency) {
    judgement.gap_mm = 0;
    return Agrees(ray, crossings, claim, leniency, 0, judgement) &&
           judgement.reach_mm <= kReachInGaps * judgement.gap_mm + rounding;
  };
  if (judgement.reach_mm <= rounding)
    judgement.verdict = Verdict::kWithinRounding;
  else if (at_edge(Leniency::kEdge))
    judgement.verdict = Verdict::kAtEdge;
  else if (at_edge(Leniency::kTwiceTheGap))
    judgement.verdict = Verdict::kAtTwiceTheGap;
  else if (Agrees(ray, crossings, claim, Leniency::kDoubts, 0, judgement))
    judgement.verdict = Verdict::kUndecided;
  else
    judgement.verdict = Verdict::kWrong;
  return judgement;
}

double Judge::Reach(const ViewRay& ray, const Claim& claim) const {
  constexpr int kDirections = 8;
  // Distances that decide a verdict are searched closely. For a wrong sample, the order of magnitude of the
  // distance is enough.
  const double rounding = RoundingAt(claim);
  const double telling = std::max(rounding, 2 * kReachInGaps * oracle_.model().info.max_edge_gap_mm);
  const double farthest = std::max(telling, kDescribedShare * oracle_.model().Diagonal());
  for (double reach = rounding / 4; reach <= farthest; reach *= reach < telling ? 2 : 8) {
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2 * std::numbers::pi * k / kDirections;
      const ViewRay moved = ray.Moved(reach * std::cos(angle), reach * std::sin(angle));
      Judgement ignored;
      if (Agrees(moved, oracle_.Crossings(moved, near_), claim, Leniency::kNone, reach, ignored))
        return reach;
    }
  }
  return INFINITY;
}

// Describes what the oracle sees, for the reader of a list.
void Judge::Explain(const std::vector<Crossing>& crossings, Judgement& judgement) const {
  const Claim& claim = judgement.claim;
  judgement.oracle_depth = INFINITY;
  judgement.trim_mm = INFINITY;
  const double described = kDescribedShare * oracle_.model().Diagonal();
  for (const Crossing& crossing : crossings) {
    if (crossing.standing != Standing::kInside) continue;
    judgement.oracle_depth = static_cast<double>(crossing.depth);
    judgement.oracle_face = crossing.placed_face;
    judgement.cosine = crossing.cosine;
    judgement.trim_mm = oracle_.TrimDistance(crossing, described);
    break;
  }
  // Find the crossing of its face to which a claimed hit comes nearest.
  judgement.why = claim.hit ? "its face is not hit there" : "a hit is lost";
  double nearest = INFINITY;
  for (const Crossing& crossing : crossings) {
    const double off = static_cast<double>(claim.depth - crossing.depth);
    if (!claim.hit || crossing.placed_face != claim.placed_face || !(std::fabs(off) < std::fabs(nearest)))
      continue;
    nearest = off;
    constexpr const char* kStandings[] = {"inside", "outside", "in doubt"};
    char text[300];
    std::snprintf(text, sizeof text,
                  "%.3g mm off its face's surface, which is %s there, |N.D| %.3g, %.3g mm to the trim", off,
                  kStandings[static_cast<int>(crossing.standing)], crossing.cosine,
                  oracle_.TrimDistance(crossing, described));
    judgement.why = text;
  }
}

void Tally::Add(const Judgement& judgement) {
  const auto certificate = static_cast<std::size_t>(judgement.claim.certificate);
  ++samples;
  ++counts[certificate][static_cast<std::size_t>(judgement.verdict)];
  other_face += judgement.other_face ? 1 : 0;
  if (judgement.matched) {
    largest_off_mm[certificate] = std::max(largest_off_mm[certificate], std::fabs(judgement.depth_off_mm));
    largest_share_of_bound[certificate] =
        std::max(largest_share_of_bound[certificate], std::fabs(judgement.depth_off_mm) / judgement.bound_mm);
  }
  if (judgement.verdict != Verdict::kRight) list.push_back(judgement);
}

Tally JudgePixels(const Judge& judge, const SampleBuffer& samples, const std::vector<std::uint32_t>& pixels) {
  std::vector<Judgement> judgements(pixels.size());
  ParallelFor(std::size_t{0}, pixels.size(), [&](std::size_t i) {
    const int column = static_cast<int>(pixels[i]) % samples.width,
              row = static_cast<int>(pixels[i]) / samples.width;
    judgements[i] = judge.Ask(Judge::MakeClaim(samples, column, row));
  });
  Tally tally;
  for (const Judgement& judgement : judgements) tally.Add(judgement);
  return tally;
}

std::string Describe(const Judgement& judgement, const Model& model) {
  constexpr const char* kCertificates[] = {"certified", "converged", "unresolved"};
  const auto name = [&](std::uint32_t face) {
    return face == kNoIndex ? std::string("nothing")
                            : std::to_string(face) + " (" + model.PlacedFaceName(face) + ")";
  };
  char numbers[500];
  std::snprintf(numbers, sizeof numbers,
                "%s, %s: pixel %d,%d; renderer %.17g mm (stated error %.3g), oracle %.17g mm, |N.D| %.3g, to "
                "the trim %.3g mm, "
                "to the edge %.3g of "
                "%.3g mm, ray to move by %.2g mm",
                kCertificates[static_cast<int>(judgement.claim.certificate)], VerdictName(judgement.verdict),
                judgement.claim.column, judgement.claim.row,
                judgement.claim.hit ? judgement.claim.depth : INFINITY, judgement.claim.depth_error,
                judgement.oracle_depth, judgement.cosine, judgement.trim_mm, judgement.edge_mm,
                judgement.gap_mm, judgement.reach_mm);
  return std::string(numbers) + "; renderer " + name(judgement.claim.placed_face) + ", oracle " +
         name(judgement.oracle_face) + "; " + judgement.why;
}

}  // namespace facetless::oracle
