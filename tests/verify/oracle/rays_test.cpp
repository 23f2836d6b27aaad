// Rays that start on random surfaces and on a box, judged by the oracle: whatever is certified is right.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "render/rays/exact_rays.h"
#include "render/trace/scene.h"
#include "tests/verify/oracle/random_models.h"
#include "tests/verify/oracle/ray_judge.h"

namespace facetless::oracle {
namespace {

Vec3 RandomDirection(Random& random) {
  for (;;) {
    const Vec3 v{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
    if (Dot(v, v) > 0.01) return facetless::Normalized(v);
  }
}

struct Shares {
  int certified = 0, rays = 0, blocked = 0;
};

// Rays from random points of the faces.
Shares JudgeRays(const Model& model, int count, Random& random) {
  const Scene scene(model);
  const Result<std::unique_ptr<ExactRays>> exact = ExactRays::Build(scene, {}, {});
  RC_ASSERT(exact.ok());
  const Oracle oracle(model);
  const RayJudge judge(oracle);
  Shares shares;
  for (int i = 0; i < count; ++i) {
    RayStart start;
    start.placed_face = random.Below(model.PlacedFaceCount());
    const std::uint32_t face = model.FaceOfPlacedFace(start.placed_face);
    const Placement& placement = model.instances[model.InstanceOfPlacedFace(start.placed_face)].placement;
    const SurfaceEval surface(model, model.faces[face].surface);
    for (int tries = 0; tries < 100; ++tries) {
      start.u = random.Uniform(surface.u_begin(), surface.u_end());
      start.v = random.Uniform(surface.v_begin(), surface.v_end());
      if (scene.data().faces[face].trim.Query(start.u, start.v, 0, 0).inside) break;
    }
    start.position = placement.Point(surface.Position(start.u, start.v));
    const SecondaryRay ray{0, RandomDirection(random), random.Below(2) ? INFINITY : random.Uniform(0.1, 10)};
    RayPassage passage;
    SecondaryHit hit;
    exact.value()->FindBlocked({&start, 1}, {&ray, 1}, {&passage, 1});
    exact.value()->FindNearest({&start, 1}, {&ray, 1}, {&hit, 1});
    const Verdict of_passage = judge.Passage(start, ray, passage), of_hit = judge.Hit(start, ray, hit);
    if ((passage.certified && of_passage == Verdict::kWrong) ||
        (hit.certified && of_hit == Verdict::kWrong)) {
      RC_LOG() << "blocked " << passage.blocked << ", nearest " << hit.distance << " ± " << hit.error << ", "
               << judge.Describe(start, ray) << "\n";
      RC_FAIL("a certified answer is wrong");
    }
    shares.certified += passage.certified && hit.certified;
    shares.blocked += passage.blocked;
    ++shares.rays;
  }
  return shares;
}

RC_GTEST_PROP(RaysOnSurfaces, OfAnyDegreesAreRightWhereTheyAreCertified, ()) {
  const auto degree = [] { return *rc::gen::inRange(1, 7); };
  const int p = degree(), q = degree();
  const SurfaceRecipe recipe{p,
                             q,
                             *rc::gen::inRange(1, 4),
                             *rc::gen::inRange(1, 4),
                             *rc::gen::element(0.0, 0.1, 0.5, 1.0),
                             *rc::gen::element(1.0, 1.0, 2.0, 10.0),
                             *rc::gen::arbitrary<std::uint64_t>()};
  Model model = RandomSurface(recipe);
  if (*rc::gen::arbitrary<bool>()) AddRandomLoop(model, 5, 0.8, false, recipe.seed + 1);
  Random random(recipe.seed + 2);
  const Shares shares = JudgeRays(model, 12, random);
  RC_ASSERT(shares.certified >= shares.rays - 3);
}

RC_GTEST_PROP(RaysOnSurfaces, OfAPlacedBoxAreRightWhereTheyAreCertified, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const Model model = SolidBox(RandomPlacement(random));
  const Shares shares = JudgeRays(model, 20, random);
  RC_ASSERT(shares.certified >= shares.rays - 1);
  RC_ASSERT(shares.blocked > 0);
}

}  // namespace
}  // namespace facetless::oracle
