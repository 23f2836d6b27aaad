// All structures find the same objects: those of a scan, to the bit, whatever the scene and the ray.
#include "render/accel/structures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <thread>

#include "tests/support/sanitized.h"
#include "tests/unit/accel/allocation_count.h"
#include "tests/unit/accel/box_scenes.h"

namespace facetless {
namespace {

using testing::Engine;
using testing::ObjectHit;
using testing::ObjectKind;
using testing::SceneKind;

struct NamedStructure {
  std::string name;
  AnyStructure structure;
};

std::vector<NamedStructure> MakeAll(const std::vector<Box3>& boxes) {
  std::vector<NamedStructure> all;
  for (const StructureName& row : StructureNames()) {
    Result<AnyStructure> made = MakeStructure(row.name, boxes);
    EXPECT_TRUE(made) << row.name << ": " << made.error().message;
    if (made) all.push_back({std::string(row.name), std::move(made).value()});
  }
  return all;
}

ObjectHit NearestBy(const auto& structure, QueryState& state, ObjectKind kind, const std::vector<Box3>& boxes,
                    const RaySegment& ray) {
  ObjectHit nearest;
  structure.Visit(ray, state, [&](std::uint32_t id) {
    testing::AskObject(kind, boxes, ray, id, nearest);
    return nearest.t;
  });
  return nearest;
}

// The number of calls for each object, of a visitor that finds nothing.
std::vector<int> CallsOf(const auto& structure, QueryState& state, std::size_t objects,
                         const RaySegment& ray) {
  std::vector<int> calls(objects, 0);
  structure.Visit(ray, state, [&](std::uint32_t id) {
    ++calls.at(id);
    return INFINITY;
  });
  return calls;
}

std::string Text(const RaySegment& ray) {
  std::string text;
  for (const double x : {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                         ray.direction.z, ray.t_first, ray.t_last}) {
    char number[40];
    std::snprintf(number, sizeof number, "%a ", x);
    text += number;
  }
  return text;
}

bool IsFar(const RaySegment& ray, const std::vector<Box3>& boxes) {
  Box3 bounds;
  for (const Box3& box : boxes) bounds.Add(box.low), bounds.Add(box.high);
  return Length(ray.origin - bounds.center()) > 500 * bounds.diagonal();
}

RC_GTEST_PROP(Structures, FindTheNearestObjectOfAScanToTheBit, (std::uint64_t seed)) {
  Engine engine(seed);
  for (const SceneKind kind : testing::kSceneKinds) {
    const std::vector<Box3> boxes = testing::DrawScene(kind, 300, engine);
    const std::vector<RaySegment> rays = testing::DrawRays(boxes, 20, engine);
    for (const NamedStructure& named : MakeAll(boxes)) {
      WithStructure(named.structure, [&](const auto& structure) {
        QueryState state(structure.state_size());
        for (const RaySegment& ray : rays)
          for (const ObjectKind object : {ObjectKind::kBox, ObjectKind::kSphere}) {
            // From far away, rounding puts the sphere's roots outside of its box.
            if (object == ObjectKind::kSphere && IsFar(ray, boxes)) continue;
            const ObjectHit expected = testing::NearestByScan(object, boxes, ray);
            const ObjectHit found = NearestBy(structure, state, object, boxes, ray);
            if (!(found == expected))
              RC_FAIL(named.name + ", scene " + std::to_string(static_cast<int>(kind)) + ", ray " +
                      Text(ray) + ": object " + std::to_string(found.id) + " instead of " +
                      std::to_string(expected.id));
          }
      });
    }
  }
}

// How a ray meets each box.
struct ExactMeetings {
  std::vector<bool> met, clearly_missed;

  ExactMeetings(const std::vector<Box3>& boxes, const RaySegment& ray) {
    const double margin = 0x1p-30 * BoxSet(boxes).scale();
    for (const Box3& box : boxes) {
      met.push_back(testing::MeetsExactly(ray, box, 0));
      clearly_missed.push_back(!met.back() && !testing::MeetsExactly(ray, box, margin));
    }
  }
};

RC_GTEST_PROP(Structures, ReportEveryBoxThatTheIntervalMeets, (std::uint64_t seed)) {
  Engine engine(seed);
  for (const SceneKind kind : testing::kSceneKinds) {
    const std::vector<Box3> boxes = testing::DrawScene(kind, 200, engine);
    const std::vector<RaySegment> rays = testing::DrawRays(boxes, 30, engine);
    std::vector<ExactMeetings> exact;
    for (const RaySegment& ray : rays) exact.emplace_back(boxes, ray);
    for (const NamedStructure& named : MakeAll(boxes)) {
      const bool with_spheres = named.name.starts_with("sphere");
      WithStructure(named.structure, [&](const auto& structure) {
        QueryState state(structure.state_size());
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::vector<int> calls = CallsOf(structure, state, boxes.size(), rays[i]);
          const bool far = IsFar(rays[i], boxes);
          for (std::size_t id = 0; id < boxes.size(); ++id) {
            const bool lost = calls[id] == 0 && exact[i].met[id], repeated = structure.kOnce && calls[id] > 1;
            // Spheres are met where boxes are missed.
            const bool wrong = calls[id] > 0 && exact[i].clearly_missed[id] && !with_spheres && !far;
            if (lost || repeated || wrong)
              RC_FAIL(named.name + ", scene " + std::to_string(static_cast<int>(kind)) + ", ray " +
                      Text(rays[i]) + ": box " + std::to_string(id) + " is called " +
                      std::to_string(calls[id]) + " times");
          }
        }
      });
    }
  }
}

RC_GTEST_PROP(Structures, StopWhenTheVisitorSaysSo, (std::uint64_t seed)) {
  Engine engine(seed);
  for (const SceneKind kind : testing::kSceneKinds) {
    const std::vector<Box3> boxes = testing::DrawScene(kind, 200, engine);
    const std::vector<RaySegment> rays = testing::DrawRays(boxes, 20, engine);
    for (const NamedStructure& named : MakeAll(boxes)) {
      WithStructure(named.structure, [&](const auto& structure) {
        QueryState state(structure.state_size());
        for (const RaySegment& ray : rays) {
          int calls = 0;
          structure.Visit(ray, state, [&](std::uint32_t) {
            ++calls;
            return kStop;
          });
          if (calls > 1) RC_FAIL(named.name + ": " + std::to_string(calls) + " calls, ray " + Text(ray));
          // What the visit left in the state does not change the next one.
          const std::vector<int> all = CallsOf(structure, state, boxes.size(), ray);
          RC_ASSERT((calls == 1) == (std::ranges::count(all, 0) < std::ssize(all)));
        }
      });
    }
  }
}

TEST(Structures, AnswerTheSameFromFourThreads) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(kSeed);
  Engine engine(kSeed);
  for (const SceneKind kind : {SceneKind::kUniform, SceneKind::kClustered, SceneKind::kTiles}) {
    const std::vector<Box3> boxes = testing::DrawScene(kind, 400, engine);
    const std::vector<RaySegment> rays = testing::DrawRays(boxes, 400, engine);
    std::vector<ObjectHit> expected;
    for (const RaySegment& ray : rays)
      expected.push_back(testing::NearestByScan(ObjectKind::kBox, boxes, ray));
    for (const NamedStructure& named : MakeAll(boxes)) {
      WithStructure(named.structure, [&](const auto& structure) {
        std::atomic<int> unlike = 0;
        std::vector<std::thread> threads;
        for (int thread = 0; thread < 4; ++thread)
          threads.emplace_back([&] {
            QueryState state(structure.state_size());
            for (std::size_t i = 0; i < rays.size(); ++i)
              unlike += !(NearestBy(structure, state, ObjectKind::kBox, boxes, rays[i]) == expected[i]);
          });
        for (std::thread& thread : threads) thread.join();
        EXPECT_EQ(unlike, 0) << named.name;
      });
    }
  }
}

TEST(Structures, AllocateNothingPerRay) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer allocates with operators of its own, which are not counted";
  constexpr unsigned kSeed = 6;
  SCOPED_TRACE(kSeed);
  Engine engine(kSeed);
  const std::vector<Box3> boxes = testing::DrawScene(SceneKind::kUniform, 1000, engine);
  const std::vector<RaySegment> rays = testing::DrawRays(boxes, 300, engine);
  for (const NamedStructure& named : MakeAll(boxes)) {
    WithStructure(named.structure, [&](const auto& structure) {
      QueryState state(structure.state_size());
      const auto trace = [&] {
        for (const RaySegment& ray : rays) NearestBy(structure, state, ObjectKind::kBox, boxes, ray);
      };
      // The direction tree makes its nodes in the first round.
      if (named.name == "direction-tree") trace();
      const std::size_t before = testing::CountAllocations();
      trace();
      EXPECT_EQ(testing::CountAllocations(), before) << named.name;
    });
  }
}

TEST(Structures, RaysThatAreNoneMeetNothing) {
  const std::vector<Box3> boxes(20, Box3{{-1, -1, -1}, {1, 1, 1}});
  const RaySegment none[] = {{{0, 0, 0}, {0, 0, 0}},        {{0, 0, 0}, {NAN, 0, 1}},
                             {{NAN, 0, 0}, {0, 0, 1}},      {{0, 0, 0}, {INFINITY, 0, 1}},
                             {{INFINITY, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {0, 0, 1}, 2, 1},
                             {{0, 0, 0}, {0, 0, 1}, 0, NAN}};
  for (const NamedStructure& named : MakeAll(boxes)) {
    WithStructure(named.structure, [&](const auto& structure) {
      QueryState state(structure.state_size());
      for (const RaySegment& ray : none)
        EXPECT_THAT(CallsOf(structure, state, boxes.size(), ray), ::testing::Each(0)) << named.name;
    });
  }
}

TEST(Structures, ANameThatIsNoneNamesThoseThatAre) {
  const Result<AnyStructure> made = MakeStructure("quadtree", {});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kBadUsage);
  EXPECT_THAT(made.error().message, ::testing::HasSubstr("octree"));
  EXPECT_EQ(StructureNames().front().name, "boxes");
}

TEST(Structures, SayHowMuchMemoryTheyUse) {
  Engine engine(7);
  const std::vector<Box3> few = testing::DrawScene(SceneKind::kOne, 1, engine);
  std::vector<Box3> many;
  while (many.size() < 1000) many = testing::DrawScene(SceneKind::kUniform, 2000, engine);
  for (const StructureName& row : StructureNames()) {
    const auto bytes_of = [&](const std::vector<Box3>& boxes) {
      const Result<AnyStructure> made = MakeStructure(row.name, boxes);
      return WithStructure(made.value(), [](const auto& structure) { return structure.bytes(); });
    };
    EXPECT_GE(bytes_of(few), sizeof(SlabBox)) << row.name;
    EXPECT_GE(bytes_of(many), many.size() * sizeof(SlabBox)) << row.name;
  }
}

}  // namespace
}  // namespace facetless
