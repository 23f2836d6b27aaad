// The tables of the thesis: their form, and that the methods in them find the certified image's hits.
#include "bench/sisojevs.h"

#include <gtest/gtest.h>

#include <set>

#include "bench/thesis_scenes.h"

namespace facetless {
namespace {

// Images of 64 pixels are enough to see that methods find what they should.
constexpr int kDivisor = 8;

TEST(ThesisTables, HaveThePublishedMethodsAndShares) {
  const std::vector<ThesisTable> tables = ThesisTables();
  ASSERT_EQ(tables.size(), 4u);
  std::set<int> numbers;
  for (const ThesisTable& table : tables) {
    numbers.insert(table.number);
    EXPECT_EQ(table.width, table.number == 2 ? 640 : 512);
    for (const ThesisMethod& method : table.methods)
      EXPECT_TRUE(method.published.size() == table.scenes.size() ||
                  (method.published.empty() && method.starts == SolverStarts::kPieces))
          << method.name;
    for (const NamedScene& scene : table.scenes) {
      EXPECT_TRUE(Validate(scene.model).ok()) << scene.name;
      // Only table 5 is about rational surfaces.
      for (const Surface& surface : scene.model.surfaces)
        EXPECT_EQ(surface.rational, table.number == 5) << scene.name;
    }
  }
  EXPECT_EQ(numbers, (std::set<int>{2, 3, 4, 5}));
}

TEST(ThesisScenes, AreMeasured) {
  for (const ThesisTable& table : ThesisTables()) {
    SCOPED_TRACE(table.number);
    std::vector<ThesisScene> scenes;
    for (const NamedScene& scene : table.scenes) {
      SCOPED_TRACE(scene.name);
      scenes.push_back(MeasureThesisScene(table, scene, {.repeats = 1, .divisor = kDivisor}).value());
      const ThesisScene& measured = scenes.back();
      EXPECT_GT(measured.direct.hits, 300u);
      ASSERT_EQ(measured.methods.size(), table.methods.size());
      for (const ThesisFigures& figures : measured.methods) {
        SCOPED_TRACE(figures.name);
        if (!figures.missing.empty()) continue;
        EXPECT_EQ(figures.stats.rays, measured.direct.rays);
        EXPECT_GT(figures.stats.counters.solves, 0u);
        EXPECT_GT(figures.stats.hits, 300u);
        // From a map, rays near outlines are lost.
        const bool map = figures.stats.starts != SolverStarts::kPieces;
        EXPECT_LE(figures.errors.count(HitError::kLost), measured.direct.hits / (map ? 5 : 50));
        EXPECT_LE(figures.errors.count(HitError::kInvented), measured.direct.hits / (map ? 10 : 50));
        // Bézier clipping runs out of work where a ray meets many equal roots.
        EXPECT_LE(figures.errors.count(HitError::kUnresolved), measured.direct.hits / 50);
      }
    }
    const std::vector<Table> texts = ThesisTexts(table, scenes);
    ASSERT_EQ(texts.size(), 2u);
    EXPECT_EQ(texts[0].rows.size(), table.methods.size() + 1);
    for (const Table& text : texts)
      for (const std::vector<std::string>& row : text.rows) EXPECT_EQ(row.size(), text.columns.size());
    // A sentence for each method but the base, or why it is missing; and one about the scenes.
    EXPECT_GE(texts[0].notes.size(), 1 + scenes.size() * (table.methods.size() - 1));
    const nlohmann::json json = ThesisJson(table, scenes);
    EXPECT_EQ(nlohmann::json::parse(json.dump()), json);
    EXPECT_EQ(json.at("scenes").size(), scenes.size());
  }
}

TEST(ThesisTables, ShowPublishedSharesBesideOurs) {
  ThesisTable table{5, "NURBS surfaces", 512, 512, 1, {{"newton-cramer", {5.578}}, {"martin", {6.437}}}, {}};
  ThesisScene scene;
  scene.name = "bird";
  scene.methods.resize(2);
  for (ThesisFigures& figures : scene.methods) figures.stats.rays = 100;
  scene.methods[0].title = "Newton–Cramer";
  scene.methods[0].total_ms = 1;
  scene.methods[0].trace_ms = 0.5;
  scene.methods[0].stats.counters = {.solves = 50, .iterations = 150, .roots = 0, .stops = {}};
  scene.methods[1].title = "Martin et al.";
  scene.methods[1].total_ms = scene.methods[1].trace_ms = 2;
  scene.methods[1].stats.counters = {.solves = 80, .iterations = 160, .roots = 0, .stops = {}};
  const Table times = ThesisTexts(table, {scene})[0];
  EXPECT_EQ(times.rows[0][2], "50.0 %");
  EXPECT_EQ(times.rows[0][3], "86.7 %");
  EXPECT_EQ(times.rows[1][2], "100 %");
  ASSERT_EQ(times.notes.size(), 2u);
  EXPECT_EQ(times.notes[1],
            "- bird, Newton–Cramer: 50.0 % instead of the published 86.7 %, because a ray takes 0.500 solves "
            "of 3.00 "
            "iterations of 3333 ns, and with Martin et al. 0.800 solves of 2.00 iterations of 12500 ns; "
            "preparation is "
            "50.0 % of the time.");
  scene.methods[0].missing = "there is no method of this name";
  const Table without = ThesisTexts(table, {scene})[0];
  EXPECT_EQ(without.rows[0][1], "-");
  EXPECT_EQ(without.notes[1], "- bird, Newton–Cramer: there is no method of this name.");
}

}  // namespace
}  // namespace facetless
