// All structures find the same hits.
#include "bench/leaf_search.h"

#include <gtest/gtest.h>

#include "bench/patch_scene.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

void ExpectSameHits(const LeafSearches& searches) {
  ASSERT_EQ(searches.methods.size(), 5u);
  for (const LeafSearch& search : searches.methods) {
    EXPECT_EQ(search.unlike, 0u) << search.name;
    EXPECT_GT(search.rays, 0u) << search.name;
    EXPECT_GT(search.hits, 0u) << search.name;
    EXPECT_GT(search.bytes, 0u) << search.name;
    // There are at least as many candidates as hits, and a sorted structure tests no more candidates than an
    // unsorted one.
    EXPECT_GE(search.candidates_per_ray * static_cast<double>(search.rays), static_cast<double>(search.hits))
        << search.name;
    EXPECT_GE(search.candidates_per_ray * 1.1, searches.methods[0].candidates_per_ray) << search.name;
  }
  const Table table = LeafSearchTable(searches);
  EXPECT_EQ(table.rows.size(), 5u);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  const nlohmann::json json = LeafSearchJson(searches);
  EXPECT_EQ(nlohmann::json::parse(json.dump()), json);
}

TEST(LeafSearch, AllStructuresAgreeOnEveryScene) {
  for (const NamedScene& scene : PatchScenes())
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      SCOPED_TRACE(scene.name);
      const Camera camera = NamedView("iso", scene.model.bounds, projection, 200, 150).value();
      const Result<LeafSearches> searches = MeasureLeafSearches(scene.name, scene.model, camera, 1);
      ASSERT_TRUE(searches.ok()) << searches.error().message;
      ExpectSameHits(searches.value());
    }
}

TEST(LeafSearch, SaysThatNothingIsInView) {
  const Model ball = testing::ModelOf({testing::Sphere({0, 0, 0}, 1)});
  Camera camera = NamedView("iso", ball.bounds, Projection::kOrthographic, 64, 64).value();
  camera.target = camera.target + Vec3{100, 0, 0};
  camera.eye = camera.eye + Vec3{100, 0, 0};
  const Result<LeafSearches> searches = MeasureLeafSearches("ball", ball, camera, 1);
  ASSERT_FALSE(searches.ok());
  EXPECT_EQ(searches.error().code, ErrorCode::kNothingUsable);
}

}  // namespace
}  // namespace facetless
