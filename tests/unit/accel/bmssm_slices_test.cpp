// BMSSM in space: the bits of a supervoxel, the forms, and the memory of bitmaps and lists.
#include "render/accel/bmssm_slices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "render/accel/curve_order.h"
#include "render/accel/ssm_lists.h"
#include "tests/unit/accel/box_scenes.h"

namespace facetless {
namespace {

using testing::SceneKind;

RC_GTEST_PROP(BmssmSlices, ASupervoxelHasExactlyTheBitsOfItsList, (std::uint64_t seed)) {
  testing::Engine engine(seed);
  const SceneKind kind = testing::kSceneKinds[engine() % std::size(testing::kSceneKinds)];
  const std::vector<Box3> boxes = testing::DrawScene(kind, 300, engine);
  constexpr std::uint32_t kSlices = 7;
  const SsmLists lists(boxes, kSlices);
  for (const SliceForm form : {SliceForm::kPlain, SliceForm::kSummary}) {
    const BmssmSlices slices(boxes, form, kSlices);
    const SliceMaps& maps = slices.maps();
    for (std::uint32_t k = 0; k < kSlices; ++k)
      for (std::uint32_t j = 0; j < kSlices; ++j)
        for (std::uint32_t i = 0; i < kSlices; ++i) {
          std::set<std::uint32_t> bits;
          for (std::size_t number = 0; number < 64 * maps.words(); ++number) {
            const std::uint64_t word =
                maps.Slice(0, i)[number / 64] & maps.Slice(1, j)[number / 64] & maps.Slice(2, k)[number / 64];
            if (word >> (number % 64) & 1) bits.insert(slices.IdOf(number));
          }
          const auto list = lists.Supervoxel(i, j, k);
          RC_ASSERT((bits == std::set<std::uint32_t>(list.begin(), list.end())));
        }
    // The summary names exactly the words that are not zero.
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t slice = 0; slice < kSlices; ++slice)
        for (std::size_t word = 0; word < maps.words(); ++word)
          RC_ASSERT((maps.Slice(axis, slice)[word] != 0) ==
                    (maps.Summary(axis, slice)[word / 64] >> (word % 64) & 1));
  }
}

TEST(BmssmSlices, AllFormsAskTheSameObjectsOnce) {
  testing::Engine engine(3);
  std::vector<Box3> boxes;
  while (boxes.size() < 1000) boxes = testing::DrawScene(SceneKind::kUniform, 2000, engine);
  const BmssmSlices plain(boxes, SliceForm::kPlain), summary(boxes, SliceForm::kSummary),
      two(boxes, SliceForm::kTwoLevels);
  std::uint64_t repeats = 0;
  for (const RaySegment& ray : testing::DrawRays(boxes, 200, engine)) {
    std::set<std::uint32_t> asked[3];
    const BmssmSlices* forms[] = {&plain, &summary, &two};
    for (int f = 0; f < 3; ++f) {
      QueryState state(forms[f]->state_size());
      forms[f]->Visit(ray, state, [&](std::uint32_t id) {
        EXPECT_TRUE(asked[f].insert(id).second) << id;
        return INFINITY;
      });
      repeats += state.counters.repeats;
      EXPECT_TRUE(std::all_of(state.words(), state.words() + forms[f]->state_size().words,
                              [](std::uint64_t word) { return word == 0; }));
    }
    EXPECT_EQ(asked[0], asked[1]);
    EXPECT_EQ(asked[0], asked[2]);
  }
  EXPECT_GT(repeats, 0u);
}

TEST(BmssmSlices, BitmapsTakeThreeBitsPerSliceAndObject) {
  testing::Engine engine(3);
  std::vector<Box3> boxes;
  while (boxes.size() < 1000) boxes = testing::DrawScene(SceneKind::kUniform, 2000, engine);
  constexpr std::uint32_t kSlices = 16;
  const BmssmSlices slices(boxes, SliceForm::kPlain, kSlices);
  const double source = 3.0 / 8 * kSlices * static_cast<double>(boxes.size());
  // The summary and the planes come on top, and the last word is not full.
  EXPECT_GE(static_cast<double>(slices.map_bytes()), source);
  EXPECT_LT(static_cast<double>(slices.map_bytes()), 1.15 * source + 500);
}

TEST(SsmLists, TheThreeCasesOfMemoryEfficiency) {
  const double slices = 20, objects = 5000;
  // Large objects: q → p.
  EXPECT_NEAR(MemoryEfficiency(slices, objects, objects), 16.0 / 3 * slices * slices, 1);
  // One object per supervoxel, and nearly none.
  EXPECT_NEAR(MemoryEfficiency(slices, objects, 1), 16 * slices * slices / objects, 1e-12);
  EXPECT_NEAR(MemoryEfficiency(slices, objects, 0), 32.0 / 3 * slices * slices / objects, 1e-12);
}

TEST(CurveOrder, IsAPermutationThatKeepsNeighboursTogether) {
  testing::Engine engine(3);
  std::vector<Box3> boxes;
  while (boxes.size() < 1000) boxes = testing::DrawScene(SceneKind::kUniform, 2000, engine);
  const BoxSet set(boxes);
  const std::vector<std::uint32_t> order = CurveOrder(set.boxes());
  std::vector<std::uint32_t> sorted = order, all(boxes.size());
  std::ranges::sort(sorted);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(sorted, all);
  const auto length = [&](const std::vector<std::uint32_t>& path) {
    double sum = 0;
    for (std::size_t i = 1; i < path.size(); ++i)
      sum += Length(boxes[path[i]].center() - boxes[path[i - 1]].center());
    return sum;
  };
  EXPECT_LT(length(order), length(all) / 3);
}

}  // namespace
}  // namespace facetless
