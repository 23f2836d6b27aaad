// Rays that start on surfaces with closed forms: what they meet, what is certified, and that they do not meet their own
// start again, whatever the size of the model and its distance from the origin.
#include "render/rays/exact_rays.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;

// For properties that build many models.
constexpr double kCoarse = 1e-3;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double low, double high) { return low + (high - low) * (double(engine_() >> 11) * 0x1p-53); }
  Vec3 Direction() {
    const double z = Uniform(-1, 1), angle = Uniform(0, 2 * kPi), r = std::sqrt(1 - z * z);
    return Normalized({r * std::cos(angle), r * std::sin(angle), z});
  }

 private:
  std::mt19937_64 engine_;
};

// A model with its rays.
class Shot {
 public:
  explicit Shot(Model model, const std::string& structure = kBlocks,
                const std::vector<bool>* leave_out = nullptr, double open_share = kOpenShare)
      : model_(std::move(model)), scene_(model_) {
    Result<std::unique_ptr<ExactRays>> built = ExactRays::Build(
        scene_, {.structure = structure, .leave_out = leave_out, .open_share = open_share}, {});
    if (!built.ok()) throw std::runtime_error(built.error().message);
    rays_ = std::move(built).value();
  }

  // The start at native parameters of a placed face.
  RayStart At(std::uint32_t id, double u, double v) const {
    const std::uint32_t face = model_.FaceOfPlacedFace(id);
    const Placement& placement = model_.instances[model_.InstanceOfPlacedFace(id)].placement;
    const SurfacePoint point = SurfaceEval(model_, model_.faces[face].surface).First(u, v);
    RayStart start;
    start.position = placement.Point(point.position);
    const double side = (model_.faces[face].reversed ? -1 : 1) * (placement.Determinant() < 0 ? -1 : 1);
    start.normal = side * Normalized(Cross(placement.Vector(point.du), placement.Vector(point.dv)));
    start.placed_face = id;
    start.u = u;
    start.v = v;
    return start;
  }
  SecondaryHit Nearest(const RayStart& start, Vec3 direction) const {
    const SecondaryRay ray{0, direction, INFINITY};
    SecondaryHit hit;
    rays_->FindNearest({&start, 1}, {&ray, 1}, {&hit, 1});
    return hit;
  }
  RayPassage Passage(const RayStart& start, Vec3 direction, double length = INFINITY) const {
    const SecondaryRay ray{0, direction, length};
    RayPassage passage;
    rays_->FindBlocked({&start, 1}, {&ray, 1}, {&passage, 1});
    return passage;
  }
  const Model& model() const { return model_; }
  const ExactRays& rays() const { return *rays_; }

 private:
  Model model_;
  Scene scene_;
  std::unique_ptr<ExactRays> rays_;
};

// A direction on the outer side of the normal, with the cosine `rise`.
Vec3 Rising(Vec3 normal, double rise, Random& random) {
  Vec3 along = random.Direction();
  along = Normalized(along - Dot(along, normal) * normal);
  return Normalized(rise * normal + std::sqrt(1 - rise * rise) * along);
}

Placement Shifted(Vec3 by) {
  Placement placement;
  placement.m[0][3] = by.x;
  placement.m[1][3] = by.y;
  placement.m[2][3] = by.z;
  return placement;
}

TEST(ExactRays, TheChordOfASphereEndsWhereTheClosedFormSays) {
  const double radius = 5;
  const Shot shot(testing::ModelOf({testing::Sphere({1, 2, 3}, radius)}));
  Random random(1);
  int certified = 0;
  for (int i = 0; i < 500; ++i) {
    const RayStart start = shot.At(0, random.Uniform(0, 2 * kPi), random.Uniform(-1.5, 1.5));
    const double rise = random.Uniform(0.001, 1);
    const Vec3 out = Rising(start.normal, rise, random), in = -out;
    const RayPassage outward = shot.Passage(start, out);
    EXPECT_FALSE(outward.blocked && outward.certified) << i;
    EXPECT_FALSE(outward.blocked) << i;
    const SecondaryHit hit = shot.Nearest(start, in);
    const double chord = 2 * radius * Dot(start.normal, out);
    // The start lies off the sphere by its rounding, which at a grazing chord makes more of a difference.
    EXPECT_NEAR(hit.distance, chord, hit.error + 1e-14 / rise) << i;
    EXPECT_TRUE(shot.Passage(start, in).blocked) << i;
    EXPECT_TRUE(shot.Passage(start, in, 1.001 * chord).blocked) << i;
    EXPECT_FALSE(shot.Passage(start, in, 0.999 * chord).blocked) << i;
    // The hit's normal points out of the sphere, along the chord's other end.
    EXPECT_NEAR(Dot(hit.normal, in), rise, 1e-9) << i;
    certified += outward.certified && hit.certified && shot.Passage(start, in).certified;
  }
  EXPECT_EQ(certified, 500);
}

TEST(ExactRays, ATorusIsMetWhereItsEquationChangesSign) {
  constexpr double kMajor = 20, kMinor = 6;
  const auto outside = [&](Vec3 p) {
    const double ring = std::sqrt(p.x * p.x + p.y * p.y) - kMajor;
    return std::sqrt(ring * ring + p.z * p.z) - kMinor;
  };
  const Shot shot(testing::ModelOf({testing::Torus({0, 0, 0}, kMajor, kMinor)}));
  Random random(2);
  int certified = 0, blocked = 0;
  constexpr int kRays = 400;
  for (int i = 0; i < kRays; ++i) {
    const RayStart start = shot.At(0, random.Uniform(0, 2 * kPi), random.Uniform(0, 2 * kPi));
    const Vec3 direction = random.Direction();
    if (std::fabs(Dot(direction, start.normal)) < 0.01) continue;
    const SecondaryHit hit = shot.Nearest(start, direction);
    const RayPassage passage = shot.Passage(start, direction);
    EXPECT_EQ(passage.blocked, std::isfinite(hit.distance));
    // Walk along the ray: the sign is that of the first step until the hit.
    const bool inside = Dot(direction, start.normal) < 0;
    const double end = std::isfinite(hit.distance) ? hit.distance : 60;
    for (int step = 1; step < 400; ++step) {
      const double at = step / 400.0 * end, value = outside(start.position + at * direction);
      EXPECT_TRUE(inside ? value < 1e-12 : value > -1e-12) << i << " at " << at << " of " << end;
    }
    if (std::isfinite(hit.distance)) {
      EXPECT_LT(std::fabs(outside(hit.position)), 1e-12) << i;
    }
    certified += passage.certified && hit.certified;
    blocked += passage.blocked;
  }
  EXPECT_GT(certified, 390);
  EXPECT_GT(blocked, 190);
}

// From inside a box, the exit is on the face whose plane comes first.
TEST(ExactRays, ABoxIsLeftThroughTheRightFace) {
  const Vec3 size{30, 20, 10};
  const Shot shot(testing::LooseBox(size, 0, 1));
  Random random(3);
  int certified = 0;
  constexpr int kRays = 600;
  for (int i = 0; i < kRays; ++i) {
    const std::uint32_t face = static_cast<std::uint32_t>(i % 6);
    RayStart start = shot.At(face, random.Uniform(0.01, 0.99), random.Uniform(0.01, 0.99));
    const Vec3 in = Rising(-start.normal, random.Uniform(0.01, 1), random);
    double exit = INFINITY;
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      if (start.normal.*axis != 0) {
        exit = std::min(exit, size.*axis / std::fabs(in.*axis));
      } else {
        exit = std::min(exit, ((in.*axis > 0 ? size.*axis : 0) - start.position.*axis) / in.*axis);
      }
    }
    const SecondaryHit hit = shot.Nearest(start, in);
    EXPECT_NEAR(hit.distance, exit, 1e-11) << i;
    EXPECT_NE(hit.placed_face, face) << i;
    EXPECT_GT(Dot(hit.normal, in), 0) << i;
    const RayPassage outward = shot.Passage(start, Rising(start.normal, random.Uniform(0.001, 1), random));
    EXPECT_FALSE(outward.blocked) << i;
    certified += hit.certified && outward.certified && shot.Passage(start, in).certified;
  }
  EXPECT_GE(certified, kRays - 3);
}

// Along axes rays pass through borders of patches, seams and poles, and hit edges and vertices of a box.
TEST(ExactRays, RaysAlongAxesAndThroughVerticesAreNeverWrongAndCertified) {
  const Shot sphere(testing::ModelOf({testing::Sphere({0, 0, 0}, 2)}));
  const Shot box(testing::LooseBox({1, 1, 1}, 0, 7));
  RayStart inside;
  inside.position = {0, 0, 0};
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    for (const double sign : {-1.0, 1.0}) {
      const SecondaryHit hit = sphere.Nearest(inside, sign * axis);
      EXPECT_NEAR(hit.distance, 2, 1e-8);
      const RayPassage passage = sphere.Passage(inside, sign * axis);
      EXPECT_TRUE(passage.blocked || !passage.certified);
      EXPECT_TRUE(passage.blocked);
    }
  }
  RayStart middle;
  middle.position = {0.5, 0.5, 0.5};
  for (int corner = 0; corner < 27; ++corner) {
    const Vec3 target{corner % 3 * 0.5, corner / 3 % 3 * 0.5, corner / 9 * 0.5};
    const Vec3 way = target - middle.position;
    if (Dot(way, way) == 0) continue;
    const RayPassage passage = box.Passage(middle, Normalized(way));
    EXPECT_TRUE(passage.blocked || !passage.certified) << corner;
    // Straight at the middle of a face there is nothing to doubt.
    if (Dot(way, way) < 0.3) {
      EXPECT_TRUE(passage.blocked && passage.certified) << corner;
    }
  }
  // Rays in the plane of a face, from that face: a doubt, but not a shadow.
  const RayStart top = box.At(0, 0.3, 0.6);
  const Vec3 across = Normalized(box.At(0, 0.8, 0.6).position - top.position);
  const RayPassage grazing = box.Passage(top, across);
  EXPECT_FALSE(grazing.blocked && grazing.certified);
}

// No point of a smooth closed face lies in the shadow of itself.
void ExpectNoSelfShadow(const Shot& shot, double u_end, double v_begin, double v_end, std::uint64_t seed,
                        int* certified, int* rays) {
  Random random(seed);
  for (int i = 0; i < 20; ++i) {
    const RayStart start = shot.At(0, random.Uniform(0, u_end), random.Uniform(v_begin, v_end));
    // From straight up to grazing. Below a hundred-thousandth, double precision has no proof for the start's own root.
    const double rise = std::pow(10.0, random.Uniform(-7, 0));
    const RayPassage passage = shot.Passage(start, Rising(start.normal, rise, random));
    RC_ASSERT(!passage.blocked);
    if (rise < 2e-5) continue;
    *certified += passage.certified;
    ++*rays;
  }
}

RC_GTEST_PROP(ExactRays, ConvexFacesCastNoShadowOnThemselvesAtAnyScale, ()) {
  const double scale = std::pow(10.0, *rc::gen::inRange(-6000, 9001) * 0.001);
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint64_t>();
  int certified = 0, rays = 0;
  const Shot sphere(testing::ModelOf({testing::Sphere({0.3 * scale, -0.2 * scale, scale}, scale)}), kBlocks,
                    nullptr, kCoarse);
  ExpectNoSelfShadow(sphere, 2 * kPi, -1.57, 1.57, seed, &certified, &rays);
  const Shot tube(testing::ModelOf({testing::Frustum({0, 0, 0}, scale, 0.7 * scale, 3 * scale)}), kBlocks,
                  nullptr, kCoarse);
  ExpectNoSelfShadow(tube, 2 * kPi, 0, 3 * scale, seed, &certified, &rays);
  RC_ASSERT(certified >= rays - 1);
}

RC_GTEST_PROP(ExactRays, ConvexFacesCastNoShadowOnThemselvesFarFromTheOrigin, ()) {
  // Far away either by the placement, or by the coordinates themselves.
  const double scale = std::pow(10.0, *rc::gen::inRange(-6000, 4000) * 0.001);
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint64_t>();
  const bool placed = *rc::gen::arbitrary<bool>();
  Random random(seed);
  const Vec3 far = 1e7 * random.Direction();
  Model model = testing::ModelOf({testing::Sphere(placed ? Vec3{} : far, scale)});
  if (placed) testing::Place(&model, Shifted(far));
  const Shot shot(std::move(model), kBlocks, nullptr, kCoarse);
  for (int i = 0; i < 20; ++i) {
    const RayStart start = shot.At(0, random.Uniform(0, 2 * kPi), random.Uniform(-1.5, 1.5));
    // Below the rounding of the position, up and down mean nothing.
    const Vec3 out = Rising(start.normal, random.Uniform(0.1, 1), random);
    const RayPassage passage = shot.Passage(start, out);
    RC_ASSERT(!(passage.blocked && passage.certified));
    if (scale > 1e-3) RC_ASSERT(!passage.blocked);
    if (scale > 1) RC_ASSERT(passage.certified);
  }
}

RC_GTEST_PROP(ExactRays, PlacementsTurnMirrorAndScale, ()) {
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint64_t>();
  Random random(seed);
  const double radius = 3;
  Model model = testing::ModelOf({testing::Sphere({1, 0, 0}, radius)});
  const double scale = std::pow(10.0, random.Uniform(-3, 3));
  const Vec3 x = random.Direction(), y = Normalized(Cross(x, random.Direction()));
  const Vec3 z = (*rc::gen::arbitrary<bool>() ? -1.0 : 1.0) * Cross(x, y);
  Placement placement;
  const Vec3 axes[3] = {scale * x, scale * y, scale * z};
  for (int c = 0; c < 3; ++c) {
    placement.m[0][c] = axes[c].x;
    placement.m[1][c] = axes[c].y;
    placement.m[2][c] = axes[c].z;
  }
  const Vec3 shift = 1000 * random.Direction();
  placement.m[0][3] = shift.x;
  placement.m[1][3] = shift.y;
  placement.m[2][3] = shift.z;
  testing::Place(&model, placement);
  const Shot shot(std::move(model), kBlocks, nullptr, kCoarse);
  for (int i = 0; i < 10; ++i) {
    const RayStart start = shot.At(0, random.Uniform(0, 2 * kPi), random.Uniform(-1.5, 1.5));
    const Vec3 center = placement.Point({1, 0, 0});
    RC_ASSERT(Dot(start.normal, start.position - center) > 0);
    const Vec3 out = Rising(start.normal, random.Uniform(0.01, 1), random);
    RC_ASSERT(!shot.Passage(start, out).blocked);
    const SecondaryHit hit = shot.Nearest(start, -out);
    const double chord = 2 * radius * scale * Dot(start.normal, out);
    RC_ASSERT(std::fabs(hit.distance - chord) <= 1e-10 * (scale * radius + 1000));
    RC_ASSERT(Dot(hit.normal, hit.position - center) > 0);
  }
}

// Nearest and blocked are two questions about the same roots.
TEST(ExactRays, AllStructuresGiveTheSameAnswers) {
  Model model = testing::ModelOf({testing::Torus({0, 0, 0}, 20, 6), testing::Sphere({20, 3, 2}, 2),
                                  testing::Rectangle({-30, -30, -8}, {60, 0, 0}, {0, 60, 0})});
  const Shot reference(model, "boxes");
  Random random(5);
  std::vector<RayStart> starts;
  std::vector<SecondaryRay> rays;
  for (std::uint32_t i = 0; i < 120; ++i) {
    starts.push_back(reference.At(i % 2, random.Uniform(0, 2 * kPi), random.Uniform(0.1, 1.5)));
    for (int k = 0; k < 2; ++k)
      rays.push_back({i, random.Direction(), k == 0 ? INFINITY : random.Uniform(1, 30)});
  }
  std::vector<RayPassage> expected(rays.size()), passages(rays.size());
  std::vector<SecondaryHit> expected_hits(rays.size()), hits(rays.size());
  reference.rays().FindBlocked(starts, rays, expected);
  reference.rays().FindNearest(starts, rays, expected_hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (expected[i].certified && expected_hits[i].certified) {
      EXPECT_EQ(expected[i].blocked, std::isfinite(expected_hits[i].distance)) << i;
    }
  }
  std::vector<std::string> names{kBlocks};
  for (const StructureName& name : StructureNames()) names.emplace_back(name.name);
  for (const std::string& name : names) {
    const Shot shot(model, name);
    shot.rays().FindBlocked(starts, rays, passages);
    shot.rays().FindNearest(starts, rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(passages[i].blocked, expected[i].blocked) << name << " " << i;
      EXPECT_EQ(passages[i].certified, expected[i].certified) << name << " " << i;
      EXPECT_EQ(hits[i].distance, expected_hits[i].distance) << name << " " << i;
      EXPECT_EQ(hits[i].placed_face, expected_hits[i].placed_face) << name << " " << i;
      EXPECT_EQ(hits[i].certified, expected_hits[i].certified) << name << " " << i;
    }
  }
}

// Threads that ask parts of a batch at the same time get what one thread gets for all of it.
TEST(ExactRays, AnswersDependOnNeitherThreadsNorGroups) {
  const Shot shot(testing::ModelOf({testing::Torus({0, 0, 0}, 20, 6), testing::Sphere({20, 3, 2}, 2)}));
  Random random(6);
  std::vector<RayStart> starts;
  std::vector<SecondaryRay> rays;
  for (std::uint32_t i = 0; i < 500; ++i) {
    starts.push_back(shot.At(i % 2, random.Uniform(0, 2 * kPi), random.Uniform(0.1, 1.5)));
    for (int k = 0; k < 3; ++k) rays.push_back({i, random.Direction(), INFINITY});
  }
  std::vector<RayPassage> together(rays.size()), apart(rays.size());
  std::vector<SecondaryHit> hits(rays.size()), hits_apart(rays.size());
  shot.rays().FindBlocked(starts, rays, together);
  shot.rays().FindNearest(starts, rays, hits);
  RunWithThreads(4, [&] {
    ParallelForBlocks(0, rays.size(), 7, [&](std::size_t first, std::size_t last) {
      const auto part = std::span<const SecondaryRay>(rays).subspan(first, last - first);
      shot.rays().FindBlocked(starts, part, std::span<RayPassage>(apart).subspan(first, last - first));
      shot.rays().FindNearest(starts, part, std::span<SecondaryHit>(hits_apart).subspan(first, last - first));
    });
  });
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(together[i].blocked, apart[i].blocked) << i;
    EXPECT_EQ(together[i].doubt, apart[i].doubt) << i;
    EXPECT_EQ(hits[i].distance, hits_apart[i].distance) << i;
    EXPECT_EQ(hits[i].u, hits_apart[i].u) << i;
    EXPECT_EQ(hits[i].doubt, hits_apart[i].doubt) << i;
    EXPECT_EQ(together[i].blocked, std::isfinite(hits[i].distance)) << i;
  }
}

TEST(ExactRays, FacesThatAreLeftOutAreNotThere) {
  Model model = testing::ModelOf({testing::Rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                  testing::Rectangle({0, 0, 2}, {1, 0, 0}, {0, 1, 0})});
  const Shot all(model);
  const RayStart start = all.At(0, 0.4, 0.6);
  EXPECT_TRUE(all.Passage(start, {0, 0, 1}).blocked);
  const std::vector<bool> leave_out{false, true};
  const Shot rest(model, kBlocks, &leave_out);
  const RayPassage passage = rest.Passage(start, {0, 0, 1});
  EXPECT_FALSE(passage.blocked);
  EXPECT_TRUE(passage.certified);
}

TEST(ExactRays, FailuresHaveTheirCodes) {
  const Model model = testing::ModelOf({testing::Sphere({0, 0, 0}, 1)});
  const Scene scene(model);
  const auto unknown = ExactRays::Build(scene, {.structure = "tea leaves"}, {});
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::kBadUsage);
  const auto large = ExactRays::Build(scene, {.max_bytes = 1000}, {});
  ASSERT_FALSE(large.ok());
  EXPECT_EQ(large.error().code, ErrorCode::kLimitExceeded);
  const std::atomic<bool> stop = true;
  const auto cancelled = ExactRays::Build(scene, {}, {.threads = 1, .cancel = &stop});
  ASSERT_FALSE(cancelled.ok());
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace facetless
