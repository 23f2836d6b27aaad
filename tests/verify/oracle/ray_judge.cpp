#include "tests/verify/oracle/ray_judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace facetless::oracle {
namespace {

Real3 Widened(Vec3 v) {
  return {v.x, v.y, v.z};
}

ViewRay RayOf(const RayStart& start, const SecondaryRay& ray) {
  ViewRay line;
  line.origin = line.eye = Widened(start.position);
  line.direction = Widened(ray.direction);
  line.forward = (1 / Dot(line.direction, line.direction)) * line.direction;
  const Real3 along = Normalized(line.direction);
  const Vec3 size{std::fabs(ray.direction.x), std::fabs(ray.direction.y), std::fabs(ray.direction.z)};
  const Real3 helper = size.x <= size.y && size.x <= size.z ? Real3{1, 0, 0}
                       : size.y <= size.z                   ? Real3{0, 1, 0}
                                                            : Real3{0, 0, 1};
  line.across = Normalized(Cross(along, helper));
  line.down = Cross(along, line.across);
  return line;
}

}  // namespace

std::vector<RayJudge::Meeting> RayJudge::Meetings(const RayStart& start, const SecondaryRay& ray) const {
  const ViewRay line = RayOf(start, ray);
  const double reach = kOwnShare * oracle_.model().Diagonal();
  std::vector<Crossing> crossings = oracle_.Crossings(line, -1e300);
  // Take the start's own crossing out. The patches of a closed face may overlap; those outside the trimming do not
  // count in any case.
  auto own = crossings.end();
  double nearest = INFINITY;
  for (auto crossing = crossings.begin(); crossing != crossings.end(); ++crossing) {
    const double distance = std::fabs(static_cast<double>(crossing->depth)),
                 off = distance * crossing->cosine;
    if (crossing->placed_face != start.placed_face || !(off <= reach) || !(distance < nearest) ||
        crossing->standing == Standing::kOutside)
      continue;
    own = crossing;
    nearest = distance;
  }
  if (own != crossings.end()) crossings.erase(own);

  std::vector<Meeting> meetings;
  for (const Crossing& crossing : crossings) {
    Meeting meeting{crossing, crossing.standing == Standing::kInside, false,
                    crossing.standing == Standing::kUnsure};
    const Real low = crossing.depth - crossing.half_depth, high = crossing.depth + crossing.half_depth;
    if (!(high > 0) || !(low < ray.length)) continue;
    meeting.undecided = meeting.undecided || !(low > 0) || !(high < ray.length);
    // At a grazing crossing, an edge within its gap is farther along the ray.
    const double depth = static_cast<double>(crossing.depth);
    const EdgeContact edge =
        oracle_.NearestEdge(line, crossing.placed_face, depth, 1e-12 * oracle_.model().Diagonal(),
                            1e-2 * oracle_.model().Diagonal());
    meeting.at_edge =
        edge.coedge != kNoIndex && edge.distance_mm <= 2 * edge.gap_mm + 1e-12 * oracle_.model().Diagonal();
    meetings.push_back(meeting);
  }
  return meetings;
}

Verdict RayJudge::Passage(const RayStart& start, const SecondaryRay& ray, const RayPassage& passage) const {
  Verdict verdict = passage.blocked ? Verdict::kWrong : Verdict::kRight;
  for (const Meeting& meeting : Meetings(start, ray)) {
    if (passage.blocked) {
      const Verdict own = meeting.undecided ? Verdict::kUndecided
                          : meeting.counts  ? Verdict::kRight
                          : meeting.at_edge ? Verdict::kAtEdge
                                            : Verdict::kWrong;
      verdict = std::min(verdict, own);
    } else if (meeting.counts || meeting.undecided) {
      const Verdict own = meeting.undecided ? Verdict::kUndecided
                          : meeting.at_edge ? Verdict::kAtEdge
                                            : Verdict::kWrong;
      verdict = std::max(verdict, own);
    }
  }
  return verdict;
}

Verdict RayJudge::Hit(const RayStart& start, const SecondaryRay& ray, const SecondaryHit& hit) const {
  RayPassage passage;
  passage.blocked = std::isfinite(hit.distance);
  if (!passage.blocked) return Passage(start, ray, passage);
  Verdict verdict = Verdict::kRight;
  for (const Meeting& meeting : Meetings(start, ray)) {
    const double off = std::fabs(static_cast<double>(meeting.crossing.depth - Real(hit.distance)));
    const double bound = hit.error + static_cast<double>(meeting.crossing.half_depth);
    const Verdict doubt = meeting.undecided ? Verdict::kUndecided
                          : meeting.at_edge ? Verdict::kAtEdge
                                            : Verdict::kWrong;
    if (meeting.crossing.placed_face == hit.placed_face && off <= bound &&
        (meeting.counts || doubt != Verdict::kWrong))
      return std::max(verdict, meeting.counts ? Verdict::kRight : doubt);
    if (meeting.counts || meeting.undecided) verdict = std::max(verdict, doubt);
  }
  return Verdict::kWrong;
}

std::string RayJudge::Describe(const RayStart& start, const SecondaryRay& ray) const {
  std::string text;
  char line[300];
  std::snprintf(line, sizeof line,
                "from face %u (%.17g, %.17g) at %.17g,%.17g,%.17g along %.17g,%.17g,%.17g for %g mm:",
                start.placed_face, start.u, start.v, start.position.x, start.position.y, start.position.z,
                ray.direction.x, ray.direction.y, ray.direction.z, ray.length);
  text += line;
  for (const Meeting& meeting : Meetings(start, ray)) {
    std::snprintf(line, sizeof line, " [%.17g mm ± %.2g, face %u, |N·D| %.2g%s%s%s]",
                  static_cast<double>(meeting.crossing.depth),
                  static_cast<double>(meeting.crossing.half_depth), meeting.crossing.placed_face,
                  meeting.crossing.cosine, meeting.counts ? ", inside" : "",
                  meeting.at_edge ? ", at an edge" : "", meeting.undecided ? ", undecided" : "");
    text += line;
  }
  return text;
}

}  // namespace facetless::oracle
