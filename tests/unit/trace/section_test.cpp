// Section planes, compared with closed forms: areas of cuts, and views of a cut model.
#include "render/view/section.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <string>

#include "render/trace/direct.h"
#include "render/trace/section_area.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using std::numbers::pi;
using testing::ClosedSolid;
using testing::Frustum;
using testing::LooseBox;
using testing::ModelOf;
using testing::Sphere;
using testing::Torus;

SectionPlane Plane(Vec3 point, Vec3 normal) {
  return {point, Normalized(normal)};
}

SectionArea Measure(const Model& model, std::vector<SectionPlane> planes, std::size_t index = 0) {
  const Scene scene(model);
  Result<SectionArea> area = MeasureSection(scene, planes, index, {});
  EXPECT_TRUE(area.ok()) << area.error().message;
  return area.ok() ? area.value() : SectionArea{};
}

void ExpectArea(const SectionArea& area, double expected, double share) {
  EXPECT_NEAR(area.area_mm2, expected, share * expected);
  EXPECT_LE(area.error_mm2, share * expected)
      << "rows " << area.error_parts.rows << ", odd " << area.error_parts.odd << ", move "
      << area.error_parts.move << ", gaps " << area.error_parts.gaps << ", missed " << area.error_parts.missed
      << ", undecided " << area.undecided_rows;
  // Only a row that touches a surface may have an odd number of crossings, and it must be marked as doubtful.
  EXPECT_LE(area.odd_rows, area.doubtful_rows);
  EXPECT_LE(area.odd_rows, 8u);
}

TEST(SectionArea, OfASphereIsThatOfItsCircle) {
  const Model model = ClosedSolid(ModelOf({Sphere({1, 2, 3}, 25)}));
  // Cut through the middle, where patches meet; off the middle; and obliquely.
  ExpectArea(Measure(model, {Plane({1, 2, 3}, {0, 0, 1})}), pi * 625, 1e-9);
  ExpectArea(Measure(model, {Plane({1, 2, 10}, {0, 0, 1})}), pi * (625 - 49), 1e-9);
  const Vec3 normal = Normalized({1, -2, 0.7});
  ExpectArea(Measure(model, {Plane(Vec3{1, 2, 3} + 13.0 * normal, normal)}), pi * (625 - 169), 1e-9);
}

TEST(SectionArea, OfATorus) {
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, 20, 6)}));
  // Across the tube there are two circles, and along it a ring.
  ExpectArea(Measure(model, {Plane({0, 0, 0}, {1, 0, 0})}), 2 * pi * 36, 1e-9);
  ExpectArea(Measure(model, {Plane({0, 0, 0}, {0, 0, -1})}), pi * (26 * 26 - 14 * 14), 1e-9);
  // Above the middle at height h, the cut lies between the radii 20 ± √(36 − h²).
  ExpectArea(Measure(model, {Plane({0, 0, 3}, {0, 0, 1})}), pi * 4 * 20 * std::sqrt(27.0), 1e-9);
}

TEST(SectionArea, OfACylinderCutObliquelyIsAnEllipse) {
  const Model model = ClosedSolid(ModelOf({Frustum({0, 0, -50}, 10, 10, 100)}));
  const Vec3 normal = Normalized({1, 0, 2});
  ExpectArea(Measure(model, {Plane({0, 0, 0}, normal)}), pi * 100 / normal.z, 1e-9);
}

TEST(SectionArea, OfABox) {
  const Model model = LooseBox({10, 20, 30}, 0, 1);
  ExpectArea(Measure(model, {Plane({5, 10, 15}, {0, 0, 1})}), 200, 1e-9);
  ExpectArea(Measure(model, {Plane({5, 10, 15}, {1, 0, 0})}), 600, 1e-9);
  ExpectArea(Measure(model, {Plane({5, 10, 15}, {0, 1, 1})}), 10 * 20 * std::sqrt(2.0), 1e-9);
}

TEST(SectionArea, OfAHollowBallIsARing) {
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, 25), Sphere({0, 0, 0}, 20)}));
  ExpectArea(Measure(model, {Plane({0, 0, 5}, {0, 0, 1})}), pi * (625 - 400), 1e-9);
}

TEST(SectionArea, CountsWhatSeveralPlanesLeave) {
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10)}));
  const std::vector<SectionPlane> planes = {Plane({0, 0, 0}, {0, 0, 1}), Plane({0, 0, 0}, {1, 0, 0})};
  ExpectArea(Measure(model, planes, 0), pi * 50, 1e-9);
  ExpectArea(Measure(model, planes, 1), pi * 50, 1e-9);
}

TEST(SectionArea, OfOverlappingSolidsCountsOnceAndForEach) {
  ModelBuilder builder(ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10), Sphere({10, 0, 0}, 10)})));
  builder.SetSolid(1, builder.AddSolid(true, "other"));
  const Model model = testing::Finished(std::move(builder));
  const SectionArea area = Measure(model, {Plane({0, 0, 0}, {0, 0, 1})});
  // Two circles whose centres are one radius apart share the area 2r²·(π/3 − √3/4).
  const double circle = 100 * pi, lens = 200 * (pi / 3 - std::sqrt(3.0) / 4);
  ExpectArea(area, 2 * circle - lens, 1e-9);
  ASSERT_EQ(area.solids.size(), 2u);
  EXPECT_NEAR(area.solids[0].area_mm2, circle, 1e-7);
  EXPECT_NEAR(area.solids[1].area_mm2, circle, 1e-7);
}

TEST(SectionArea, OfAFaceThatLiesInThePlaneIsThatOfTheKeptSide) {
  const Model model = LooseBox({10, 20, 30}, 0, 1);
  // The plane of the top, with the box on the kept side, and with nothing on it.
  const SectionArea kept = Measure(model, {Plane({0, 0, 30}, {0, 0, 1})});
  ExpectArea(kept, 200, 1e-9);
  EXPECT_EQ(kept.coincident_faces.size(), 1u);
  EXPECT_GT(kept.moved_mm, 0);
  const SectionArea removed = Measure(model, {Plane({0, 0, 30}, {0, 0, -1})});
  EXPECT_EQ(removed.area_mm2, 0);
  EXPECT_EQ(removed.coincident_faces, kept.coincident_faces);
}

// A ring in the plane z = base, from a cone's grid that is flattened.
testing::PatchGrid Ring(double base, double outer, double inner) {
  testing::PatchGrid grid = Frustum({0, 0, 0}, outer, inner, 1);
  for (Vec4& p : grid.points) p.z = base * p.w;
  return grid;
}

// Checks that the area is within its own error of the closed form, and that it was found in a short time.
void ExpectCovered(const SectionArea& area, double expected, const std::string& what) {
  EXPECT_LE(std::fabs(area.area_mm2 - expected), area.error_mm2)
      << what << ": " << area.area_mm2 << " for " << expected << ", moved " << area.moved_mm << ", rows "
      << area.error_parts.rows << ", odd " << area.error_parts.odd << ", move " << area.error_parts.move
      << ", missed " << area.error_parts.missed << ", odd rows " << area.odd_rows << ", undecided "
      << area.undecided_rows << ", doubtful " << area.doubtful_rows << " of " << area.rows;
  EXPECT_LT(area.ms, 20'000) << what << ": rows " << area.rows << ", undecided " << area.undecided_rows
                             << ", doubtful " << area.doubtful_rows << ", odd " << area.odd_rows << ", area "
                             << area.area_mm2 << ", error " << area.error_mm2;
}

// Returns the area of the part of a circle of radius r that lies beyond the distance d from its centre.
double Segment(double r, double d) {
  return d >= r ? 0 : d <= -r ? pi * r * r : r * r * std::acos(d / r) - d * std::sqrt((r - d) * (r + d));
}

// Returns the distances of the plane beyond (negative: before) the tangent plane, in mm.
std::vector<double> Offsets() {
  std::vector<double> offsets = {0};
  for (int e = -14; e <= -3; ++e)
    for (const double sign : {1.0, -1.0}) offsets.push_back(sign * 1.37 * std::pow(10.0, e));
  return offsets;
}

TEST(SectionArea, TangentToACylinderAlongAGeneratorOrNearlySo) {
  const double r = 5, h = 20;
  const Model model = ClosedSolid(ModelOf({Frustum({0, 0, 0}, r, r, h), Ring(0, r, 0), Ring(h, r, 0)}));
  for (const double offset : Offsets()) {
    for (const double sign : {1.0, -1.0}) {
      const double inside = -offset;  // depth of the plane within the cylinder
      const double expected = inside > 0 ? h * 2 * std::sqrt(inside * (2 * r - inside)) : 0;
      const SectionArea area = Measure(model, {Plane({r + offset, 0, 0}, {sign, 0, 0})});
      ExpectCovered(area, expected,
                    "cylinder " + std::to_string(sign) + " " + std::to_string(offset * 1e9) + " nm");
      // The stated error must be small, too.
      EXPECT_LE(area.error_mm2, 0.02) << offset;
    }
  }
}

TEST(SectionArea, TangentToASphereOrNearlySo) {
  const double r = 10;
  const Model model = ClosedSolid(ModelOf({Sphere({1, 2, 3}, r)}));
  for (const Vec3 normal : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Normalized({1, -2, 0.7})}) {
    for (const double offset : Offsets()) {
      const double inside = -offset, expected = inside > 0 ? pi * inside * (2 * r - inside) : 0;
      const SectionArea area = Measure(model, {Plane(Vec3{1, 2, 3} + (r + offset) * normal, normal)});
      ExpectCovered(area, expected, "sphere " + std::to_string(offset * 1e9) + " nm");
      EXPECT_LE(area.error_mm2, 1e-3);
    }
  }
}

TEST(SectionArea, TangentToATorusAlongItsTopOrNearlySo) {
  const double major = 20, minor = 6;
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, major, minor)}));
  for (const double offset : Offsets()) {
    const double inside = -offset;
    const double expected = inside > 0 ? 4 * pi * major * std::sqrt(inside * (2 * minor - inside)) : 0;
    const SectionArea area = Measure(model, {Plane({0, 0, minor + offset}, {0, 0, 1})});
    ExpectCovered(area, expected, "torus " + std::to_string(offset * 1e9) + " nm");
    EXPECT_LE(area.error_mm2, 1) << offset;
  }
}

TEST(SectionArea, BitangentToATorusIsTwoCirclesOfVillarceau) {
  // The plane goes through the centre at the angle asin(r/R). It cuts two circles of radius R that overlap
  // between the tangent points. The solid's cut consists of the points that lie in exactly one of them.
  const double major = 20, minor = 6;
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, major, minor)}));
  const double sine = minor / major, cosine = std::sqrt(1 - sine * sine);
  const double lens = 2 * Segment(major, minor);
  const double expected = 2 * (pi * major * major - lens);
  for (const double turn : {0.0, 1.0, 2.5}) {
    const Vec3 normal{-sine * std::cos(turn), -sine * std::sin(turn), cosine};
    ExpectCovered(Measure(model, {Plane({0, 0, 0}, normal)}), expected, "bitangent " + std::to_string(turn));
  }
}

TEST(SectionArea, TangentToAHoleKeepsTheWholePlate) {
  // Two coaxial cylinders: the plane touches the inner one and cuts the outer one.
  const double inner = 3, outer = 8, h = 4;
  const Model model =
      ClosedSolid(ModelOf({Frustum({0, 0, 0}, inner, inner, h), Frustum({0, 0, 0}, outer, outer, h),
                           Ring(0, outer, inner), Ring(h, outer, inner)}));
  for (const double offset : Offsets()) {
    const double d = inner + offset;
    const double hole = d < inner ? 2 * std::sqrt((inner - d) * (inner + d)) : 0;
    const double expected = h * (2 * std::sqrt((outer - d) * (outer + d)) - hole);
    const SectionArea area = Measure(model, {Plane({0, -d, 0}, {0, -1, 0})});
    ExpectCovered(area, expected, "hole " + std::to_string(offset * 1e9) + " nm");
  }
}

TEST(SectionArea, TouchingASolidIsNamed) {
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, 20, 6)}));
  const SectionArea area = Measure(model, {Plane({0, 0, 6}, {0, 0, 1})});
  EXPECT_EQ(area.touching_faces, (std::vector<std::uint32_t>{0}));
  EXPECT_LT(area.moved_mm, 0) << "the plane must move to the removed side, where nothing changes";
  EXPECT_EQ(area.area_mm2, 0);
  EXPECT_GT(area.error_parts.move, 0);
}

TEST(SectionArea, OfARandomPlaneIsWithinItsError) {
  const Model sphere = ClosedSolid(ModelOf({Sphere({1, 2, 3}, 10)}));
  const Model box = LooseBox({10, 20, 30}, 0, 1);
  const Model torus = ClosedSolid(ModelOf({Torus({0, 0, 0}, 20, 6)}));
  const Model cylinder = ClosedSolid(ModelOf({Frustum({0, 0, -500}, 10, 10, 1000)}));
  std::mt19937 random(20261122);
  std::uniform_real_distribution<double> even(-1, 1);
  for (int i = 0; i < 10; ++i) {
    Vec3 normal = Normalized({even(random), even(random), even(random)});
    const double depth = std::pow(10.0, 4 * even(random) - 4);  // distance below a tangent plane: 1e-8 … 1 mm
    const auto covered = [&](const Model& model, const SectionPlane& plane, double expected,
                             const char* what) {
      ExpectCovered(Measure(model, {plane}), expected, std::string(what) + " " + std::to_string(i));
    };
    // Balls, cut near their tangent planes and through their middle.
    for (const double d : {10 - depth, 10 * even(random)})
      covered(sphere, Plane(Vec3{1, 2, 3} + d * normal, normal), pi * (10 - d) * (10 + d), "sphere");
    // A box, cut above a corner: the plane cuts off a triangle. A cut through its middle has four sides.
    const Vec3 corner{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
    const double legs = corner.x * corner.y * corner.z;
    const double cut = std::min({depth, corner.x * 10, corner.y * 20, corner.z * 30});
    covered(box, Plane(cut * corner, corner), cut * cut / (2 * legs), "corner of a box");
    // A torus, cut parallel to its axis and at right angles to it.
    const double turn = pi * even(random), x = (20 - 6) * even(random);
    const Vec3 across{std::cos(turn), std::sin(turn), 0};
    const double height = 6 - std::min(depth, 11.0);
    covered(torus, Plane({0, 0, height}, {0, 0, 1}), 4 * pi * 20 * std::sqrt((6 - height) * (6 + height)),
            "torus");
    if (x == 0) continue;
    // An ellipse on a long cylinder.
    normal = Normalized({across.x, across.y, 0.05 + std::fabs(even(random))});
    covered(cylinder, Plane({0, 0, 100 * even(random)}, normal), pi * 100 / normal.z, "cylinder");
  }
}

TEST(SectionArea, OfAThinPinFarBelowTheSpacingOfTheFirstRows) {
  // Two balls that are a metre apart determine the extent. The pin between them is 0.05 mm thick.
  const Model model = ClosedSolid(
      ModelOf({Sphere({-500, -500, 0}, 1), Sphere({500, 500, 0}, 1), Frustum({3, 5, -10}, 0.05, 0.05, 20)}));
  const SectionArea area = Measure(model, {Plane({0, 0, 0}, {0, 0, 1})});
  ExpectArea(area, pi * (1 + 1 + 0.0025), 1e-7);
}

TEST(SectionArea, OfAnOpenShellIsNothingAndSaysSo) {
  const Model model = ModelOf({Sphere({0, 0, 0}, 10)});  // belongs to no solid
  const SectionArea area = Measure(model, {Plane({0, 0, 1}, {0, 0, 1})});
  EXPECT_EQ(area.area_mm2, 0);
  EXPECT_EQ(area.open_faces, (std::vector<std::uint32_t>{0}));
}

TEST(SectionArea, BesideTheModelIsNothing) {
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, 10)}));
  EXPECT_EQ(Measure(model, {Plane({0, 0, 11}, {0, 0, 1})}).area_mm2, 0);
}

TEST(SectionArea, IsTheSameForAnyNumberOfThreads) {
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, 20, 6), Sphere({40, 1, 2}, 5)}));
  const Scene scene(model);
  const std::vector<SectionPlane> planes = {Plane({1, 2, 0.5}, {0.1, 0.2, 1})};
  const SectionArea one = MeasureSection(scene, planes, 0, {.execution = {.threads = 1}}).value();
  const SectionArea many = MeasureSection(scene, planes, 0, {.execution = {.threads = 5}}).value();
  EXPECT_EQ(one.area_mm2, many.area_mm2);
  EXPECT_EQ(one.error_mm2, many.error_mm2);
  EXPECT_EQ(one.rows, many.rows);
}

TEST(SectionArea, RefusesWhatIsNoPlane) {
  const Model model = ModelOf({Sphere({0, 0, 0}, 10)});
  const Scene scene(model);
  const SectionPlane wrong[] = {{{0, 0, 0}, {0, 0, 0}}, {{NAN, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {0, 0, 2}}};
  for (const SectionPlane& plane : wrong) {
    const Result<SectionArea> area = MeasureSection(scene, {&plane, 1}, 0, {});
    ASSERT_FALSE(area.ok());
    EXPECT_EQ(area.error().code, ErrorCode::kBadUsage);
  }
}

DirectResult View(const Model& model, const Camera& camera, std::vector<SectionPlane> planes,
                  int threads = 0) {
  const Scene scene(model);
  DirectOptions options;
  options.sections = std::move(planes);
  options.execution.threads = threads;
  options.uv = options.depth_error = true;
  Result<DirectResult> result = TraceDirect(scene, camera, options);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return std::move(result).value();
}

// What a ray sees of a ball whose top is removed at height `h`.
struct BallCut {
  double depth = INFINITY;
  bool cap = false;
};
BallCut CutBall(const Ray& ray, double radius, double h) {
  const double a = Dot(ray.direction, ray.direction), b = Dot(ray.origin, ray.direction),
               c = Dot(ray.origin, ray.origin) - radius * radius, disc = b * b - a * c;
  if (disc < 0) return {};
  for (const double root : {(-b - std::sqrt(disc)) / a, (-b + std::sqrt(disc)) / a}) {
    if (ray.origin.z + root * ray.direction.z > h) continue;
    // The ray enters through the ball or through the plane.
    const double plane = (h - ray.origin.z) / ray.direction.z;
    const bool through_plane = ray.direction.z < 0 && plane > (-b - std::sqrt(disc)) / a;
    return through_plane ? BallCut{plane, true} : BallCut{root, false};
  }
  return {};
}

TEST(SectionView, OfACutBallShowsItsCapAndWhatIsKept) {
  const double radius = 10, h = 3;
  const Model model = ClosedSolid(ModelOf({Sphere({0, 0, 0}, radius)}));
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    for (const char* name : {"iso", "top", "iso-below"}) {
      const Camera camera = NamedView(name, model.bounds, projection, 160, 160).value();
      const DirectResult view = View(model, camera, {Plane({0, 0, h}, {0, 0, 1})});
      const std::uint32_t cap = SectionSolids(model).CapId(0, 0);
      std::uint64_t caps = 0, hits = 0;
      for (std::size_t i = 0; i < view.samples.size(); ++i) {
        const BallCut expected = CutBall(PixelRay(view.frame, i % 160 + 0.5, i / 160 + 0.5), radius, h);
        // Rays that graze the ball or its rim may have either answer.
        if (!std::isfinite(expected.depth) && view.samples.certificate[i] != Certificate::kCertified)
          continue;
        ASSERT_EQ(std::isfinite(view.samples.depth[i]), std::isfinite(expected.depth)) << name << " " << i;
        if (!std::isfinite(expected.depth)) continue;
        ++hits;
        caps += expected.cap;
        ASSERT_NEAR(view.samples.depth[i], expected.depth, 1e-9) << name << " " << i;
        ASSERT_EQ(view.samples.face[i], expected.cap ? cap : 0u) << name << " " << i;
        if (!expected.cap) continue;
        ASSERT_EQ(view.samples.normal[i], (std::array<float, 3>{0, 0, 1}));
      }
      EXPECT_EQ(view.stats.caps, caps) << name;
      EXPECT_EQ(view.stats.hits, hits) << name;
      EXPECT_EQ(caps > 0, std::string(name) != "iso-below");
      EXPECT_EQ(view.stats.certified + view.stats.converged + view.stats.unresolved, view.stats.rays);
      EXPECT_GT(view.stats.certified_hits, hits * 9 / 10);
    }
  }
}

TEST(SectionView, OfTwoPlanesKeepsTheirIntersection) {
  const Model model = LooseBox({10, 20, 30}, 0, 1);
  const Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 120, 120).value();
  const std::vector<SectionPlane> planes = {Plane({5, 10, 15}, {0, 0, 1}), Plane({5, 10, 15}, {1, 0, 0})};
  const DirectResult view = View(model, camera, planes);
  const SectionSolids solids(model);
  std::uint64_t caps[2] = {0, 0};
  for (std::size_t i = 0; i < view.samples.size(); ++i) {
    if (view.samples.face[i] == kNoIndex) continue;
    const Ray ray = PixelRay(view.frame, i % 120 + 0.5, i / 120 + 0.5);
    const Vec3 point = ray.origin + view.samples.depth[i] * ray.direction;
    EXPECT_LE(point.z, 15 + 1e-9);
    EXPECT_LE(point.x, 5 + 1e-9);
    for (int k = 0; k < 2; ++k) {
      if (view.samples.face[i] != solids.CapId(k, 0)) continue;
      ++caps[k];
      EXPECT_NEAR(Dot(planes[k].normal, point - planes[k].point), 0, 1e-9);
    }
  }
  EXPECT_GT(caps[0], 100u);
  EXPECT_GT(caps[1], 100u);
}

TEST(SectionView, InAFaceShowsTheCapOrNothing) {
  const Model model = LooseBox({10, 20, 30}, 0, 1);
  const Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 100, 100).value();
  const DirectResult whole = View(model, camera, {});
  const DirectResult kept = View(model, camera, {Plane({0, 0, 30}, {0, 0, 1})});
  EXPECT_EQ(kept.stats.hits, whole.stats.hits);
  EXPECT_GT(kept.stats.caps, 0u);
  for (std::size_t i = 0; i < kept.samples.size(); ++i) {
    if (!std::isfinite(whole.samples.depth[i])) continue;
    ASSERT_NEAR(kept.samples.depth[i], whole.samples.depth[i], 1e-9);
  }
  EXPECT_EQ(View(model, camera, {Plane({0, 0, 30}, {0, 0, -1})}).stats.hits, 0u);
}

TEST(SectionView, BesideTheModelChangesNoDepth) {
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, 20, 6)}));
  const Camera camera = NamedView("iso", model.bounds, Projection::kPerspective, 100, 100).value();
  const DirectResult whole = View(model, camera, {});
  const DirectResult cut = View(model, camera, {Plane({0, 0, 50}, {0, 0, 1})});
  EXPECT_EQ(cut.stats.caps, 0u);
  ASSERT_EQ(0, std::memcmp(whole.samples.depth.data(), cut.samples.depth.data(),
                           whole.samples.size() * sizeof(double)));
  EXPECT_EQ(whole.samples.face, cut.samples.face);
  EXPECT_EQ(whole.samples.uv, cut.samples.uv);
}

TEST(SectionView, HasTheSameBytesForAnyNumberOfThreads) {
  const Model model = ClosedSolid(ModelOf({Torus({0, 0, 0}, 20, 6), Sphere({0, 1, 2}, 5)}));
  const Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 150, 150).value();
  const std::vector<SectionPlane> planes = {Plane({0, 0, 1}, {0.3, 0.2, 1}), Plane({1, 0, 0}, {1, 0, 0})};
  const DirectResult one = View(model, camera, planes, 1), many = View(model, camera, planes, 4);
  EXPECT_EQ(0, std::memcmp(one.samples.depth.data(), many.samples.depth.data(),
                           one.samples.size() * sizeof(double)));
  EXPECT_EQ(one.samples.face, many.samples.face);
  EXPECT_EQ(one.samples.doubt, many.samples.doubt);
  EXPECT_EQ(one.samples.normal, many.samples.normal);
}

TEST(SectionView, OfAnOpenShellHasNoCap) {
  const Model model = ModelOf({Sphere({0, 0, 0}, 10)});
  const Camera camera = NamedView("top", model.bounds, Projection::kOrthographic, 64, 64).value();
  const DirectResult view = View(model, camera, {Plane({0, 0, 0}, {0, 0, 1})});
  EXPECT_EQ(view.stats.caps, 0u);
  // The camera looks into the lower half.
  EXPECT_NEAR(view.samples.depth[32 * 64 + 32] - camera.eye.z, 10, 0.2);
}

}  // namespace
}  // namespace facetless
