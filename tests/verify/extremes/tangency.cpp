#include "tests/verify/extremes/tangency.h"

#include <cmath>
#include <functional>

#include "tests/verify/extremes/extreme.h"
#include "tests/verify/extremes/models.h"
#include "tests/verify/oracle/judge.h"

namespace facetless::extremes {
namespace {

// A tangent of the surface: a point, the outward normal there, and a direction in the tangent plane.
struct Tangent {
  Vec3 point, normal, direction;
};

struct Subject {
  std::string name;
  Model model;
  double radius = 1;
  std::vector<Tangent> tangents;
};

constexpr int kPlaces = 8;

// Returns an angle for each place. Multiples of a quarter turn, which are seams, are included.
double AngleOf(int place) {
  constexpr double kQuarter = 1.5707963267948966;
  const int quarters = place / 2;
  return place % 2 == 0 ? quarters * kQuarter : place + 0.3;
}

std::vector<Subject> Subjects() {
  std::vector<Subject> subjects(5);
  subjects[0] = {"sphere", testing::ModelOf({testing::Sphere({0, 0, 0}, 1)}), 1, {}};
  subjects[1] = {"sphere, slanted", subjects[0].model, 1, {}};
  subjects[2] = {"cylinder", testing::ModelOf({testing::Frustum({0, 0, -2}, 1, 1, 4)}), 1, {}};
  subjects[3] = {"torus, outer silhouette", testing::ModelOf({testing::Torus({0, 0, 0}, 3, 1)}), 1, {}};
  subjects[4] = {"torus, inner silhouette", subjects[3].model, 1, {}};
  for (int place = 0; place < kPlaces; ++place) {
    const double angle = AngleOf(place), c = std::cos(angle), s = std::sin(angle);
    subjects[0].tangents.push_back({{c, s, 0}, {c, s, 0}, {0, 0, 1}});
    // A great circle about a slanted axis.
    const Vec3 axis = Normalized({0.3, -0.5, 0.8}), a = Normalized(Cross(axis, {1, 0, 0})),
               b = Cross(axis, a);
    const Vec3 on = Normalized(c * a + s * b);
    subjects[1].tangents.push_back({on, on, axis});
    subjects[2].tangents.push_back({{c, s, 0.1 * place}, {c, s, 0}, Normalized({-s, c, 0.1 * place})});
    subjects[3].tangents.push_back({{4 * c, 4 * s, 0}, {c, s, 0}, {0, 0, 1}});
    subjects[4].tangents.push_back({{2 * c, 2 * s, 0}, {-c, -s, 0}, {0, 0, 1}});
  }
  return subjects;
}

void Ask(const Scene& scene, const oracle::Oracle& surfaces, const Camera& camera, TangentRays& rays) {
  const oracle::Judge judge(surfaces, camera);
  for (std::size_t p = 0; p < kPrecisions.size(); ++p) {
    DirectOptions options;
    options.accuracy.precision = kPrecisions[p];
    options.depth_error = true;
    const DirectResult direct = TraceDirect(scene, camera, options).value();
    const oracle::Claim claim = oracle::Judge::MakeClaim(direct.samples, 0, 0);
    const oracle::Verdict verdict = judge.Ask(claim).verdict;
    TangentRays::Count& count = rays.counts[p];
    ++count.rays;
    if (claim.certificate != Certificate::kCertified) {
      count.doubtful_right += verdict == oracle::Verdict::kRight;
      continue;
    }
    ++count.certified;
    count.certified_wrong += verdict == oracle::Verdict::kWrong;
    count.certified_undecided +=
        verdict == oracle::Verdict::kUndecided || verdict == oracle::Verdict::kWithinRounding;
  }
}

}  // namespace

std::vector<TangentRays> MeasureTangency() {
  constexpr double kAway = 10;
  std::vector<TangentRays> all;
  for (const Subject& subject : Subjects()) {
    const Scene scene(subject.model);
    const oracle::Oracle surfaces(subject.model);
    for (const bool inside : {true, false}) {
      for (int digits = 1; digits <= 16; ++digits) {
        TangentRays rays{subject.name, std::pow(10.0, -digits), inside, {}};
        for (const Tangent& tangent : subject.tangents) {
          const double step = (inside ? -1 : 1) * rays.offset * subject.radius;
          const Vec3 target = tangent.point + step * tangent.normal;
          Ask(scene, surfaces,
              Orthographic("tangent", target - kAway * tangent.direction, target, tangent.normal, 1, 1, 1),
              rays);
        }
        all.push_back(rays);
      }
    }
  }
  return all;
}

}  // namespace facetless::extremes
