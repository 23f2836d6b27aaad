// Three ways to find the candidates of a ray give the same boxes.
#include "bench/box_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/skala.h"

namespace facetless {
namespace {

constexpr std::uint64_t kSeed = 7;

template <typename Method>
std::vector<std::uint32_t> CandidatesOf(const Method& method, const SceneRay& ray) {
  std::vector<std::uint32_t> found;
  method.Visit(ray, [&](std::uint32_t k) { found.push_back(k); });
  return found;
}

class BoxScene : public testing::TestWithParam<bool> {};

TEST_P(BoxScene, AllMethodsLeadToTheSameBoxes) {
  const bool perspective = GetParam();
  for (const int size : {3, 10, 63}) {
    SCOPED_TRACE(size);
    const std::vector<SceneBox> boxes = RandomBoxes(300, size, perspective, kSeed);
    const BoxScan scan(boxes, perspective);
    const SphereScan spheres(boxes, perspective);
    const RowColumnBitmaps bitmaps(boxes, perspective);
    std::uint64_t hits = 0;
    for (int y = 0; y < kSceneSize; y += 3)
      for (int x = 0; x < kSceneSize; x += 5) {
        const SceneRay ray = ScenePixelRay(x, y, perspective);
        const std::vector<std::uint32_t> exact = CandidatesOf(scan, ray);
        hits += exact.size();
        const auto meet = [&](std::vector<std::uint32_t> candidates) {
          EXPECT_TRUE(std::is_sorted(candidates.begin(), candidates.end()));
          std::erase_if(candidates, [&](std::uint32_t k) { return !scan.Meets(ray, k); });
          return candidates;
        };
        ASSERT_EQ(meet(CandidatesOf(spheres, ray)), exact) << x << " " << y;
        ASSERT_EQ(meet(CandidatesOf(bitmaps, ray)), exact) << x << " " << y;
        // "It can be easily proved that BMSSM is equivalent to minmax box test."
        if (!perspective) {
          ASSERT_EQ(CandidatesOf(bitmaps, ray), exact) << x << " " << y;
        }
      }
    EXPECT_GT(hits, 100u);
  }
}

INSTANTIATE_TEST_SUITE_P(Views, BoxScene, testing::Bool(),
                         [](const auto& info) { return info.param ? "Perspective" : "Parallel"; });

TEST(BoxScenes, FollowFromTheirSeed) {
  const auto low = [](std::uint64_t seed) { return RandomBoxes(5, 10, true, seed)[4].low; };
  EXPECT_EQ(low(1).x, low(1).x);
  EXPECT_NE(low(1).x, low(2).x);
}

TEST(Skala, ScenesHaveThePapersNumberOfHits) {
  // Table 6: a ray meets 0.72 of 400 objects of size 10, and 23.57 of 1,000 objects of size 40.
  const SkalaCell few = MeasureSkalaCell(400, 10, false, 1);
  EXPECT_NEAR(few.mean_hits, 0.72, 0.03);
  EXPECT_GE(few.max_hits, 4);
  const SkalaCell many = MeasureSkalaCell(1000, 40, false, 1);
  EXPECT_NEAR(many.mean_hits, 23.57, 0.7);
  // The memory is (n + m)·p bits, in whole words.
  EXPECT_EQ(many.bitmaps_bytes, 2u * 256 * 16 * 8);
  EXPECT_EQ(few.boxes_bytes, 400 * 4 * sizeof(double));
}

TEST(Skala, TablesHaveARowForEveryNumberOfObjects) {
  std::vector<SkalaCell> cells;
  for (const bool perspective : {false, true})
    for (const int objects : kSkalaObjects)
      for (const int size : kSkalaSizes) {
        SkalaCell cell;
        cell.objects = objects;
        cell.size = size;
        cell.perspective = perspective;
        cell.boxes_ns = 30;
        cell.spheres_ns = 20;
        cell.bitmaps_ns = 10;
        cells.push_back(cell);
      }
  const std::vector<Table> tables = SkalaTables(cells);
  ASSERT_EQ(tables.size(), 7u);
  for (const Table& table : tables) {
    ASSERT_EQ(table.rows.size(), kSkalaObjects.size()) << table.title;
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << table.title;
  }
  EXPECT_EQ(tables[0].rows[0][1], "3.00 (10.4)") << "ours, and the paper's in parentheses";
  EXPECT_EQ(tables[1].rows[6][6], "2.00 (9.48)");
  EXPECT_EQ(tables[2].rows[6][6], "3.00") << "the paper has none there";
  EXPECT_EQ(tables[5].rows[6][6], "0 (1054)");
  const nlohmann::json json = SkalaJson(cells);
  EXPECT_EQ(json.size(), cells.size());
  EXPECT_EQ(nlohmann::json::parse(json.dump()), json);
}

}  // namespace
}  // namespace facetless
