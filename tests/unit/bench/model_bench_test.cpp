// Measures both tracers on a ball, with meshes made by hand instead of the importer.
#include "bench/model_bench.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "bench/growth.h"
#include "bench/sample_cost.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::BallMesh;
using testing::ModelOf;
using testing::Sphere;

constexpr double kRadius = 10;

class ModelBench : public ::testing::Test {
 protected:
  ModelBench()
      : model_(ModelOf({Sphere({0, 0, 0}, kRadius)})),
        case_{"ball", &model_, NamedView("iso", model_.bounds, Projection::kOrthographic, 64, 64).value()} {
    importer_.tessellate = [this](double deflection) -> Result<BenchMesh> {
      ++meshes_made_[deflection];
      BenchMesh made;
      made.mesh =
          std::make_shared<const Mesh>(BallMesh(kRadius, deflection == kDefaultDeflection ? 48 : 256));
      made.mesh_ms = deflection == kDefaultDeflection ? 20 : 5000;
      return made;
    };
    importer_.intersect = [this](const std::vector<Ray>& rays) -> Result<ExactAnswers> {
      ExactAnswers answers;
      answers.trace_ms = 1;
      for (std::size_t i = 0; i < 1000; ++i) {
        const double along = -Dot(rays[i].origin, rays[i].direction),
                     rest = kRadius * kRadius - Dot(rays[i].origin, rays[i].origin) + along * along;
        answers.depths.push_back(rest < 0 ? INFINITY : along - std::sqrt(rest));
      }
      return answers;
    };
  }

  Model model_;
  BenchCase case_;
  ImporterSide importer_;
  BenchOptions options_{.execution = {.threads = 2}, .repeats = 2};
  std::map<double, int> meshes_made_;
};

TEST_F(ModelBench, FillsEveryRow) {
  const ModelCosts costs = MeasureModel(case_, importer_, options_).value();
  std::set<std::string> rows;
  for (const BenchValue& value : costs.values) {
    rows.insert(value.aim);
    EXPECT_TRUE(value.skipped.empty()) << value.aim << ": " << value.skipped;
    EXPECT_GT(value.ratio, 0) << value.aim;
    EXPECT_EQ(value.file, "ball");
    EXPECT_EQ(value.view, "iso");
  }
  std::set<std::string> expected = {"first_image_default_mesh",
                                    "first_image_fine_mesh",
                                    "trace_fine_mesh",
                                    "trace_default_mesh",
                                    "trace_default_mesh_fast",
                                    "trace_fine_mesh_raw",
                                    "trace_default_mesh_raw",
                                    "samples",
                                    "trace_exact_intersector",
                                    "next_view",
                                    "memory",
                                    "memory_structures",
                                    "two_cores"};
  EXPECT_EQ(rows, expected);

  // Cheap meshes are made for every round and for the warm-up, expensive ones once.
  EXPECT_EQ(meshes_made_[kDefaultDeflection], 3);
  EXPECT_EQ(meshes_made_[kFineDeflection], 1);
}

TEST_F(ModelBench, BothSidesSeeTheSame) {
  const nlohmann::json details = MeasureModel(case_, importer_, options_).value().details;
  EXPECT_EQ(nlohmann::json::parse(details.dump()), details);
  const nlohmann::json& exact = details.at("exact_intersector");
  EXPECT_EQ(exact.at("rays"), 1000);
  EXPECT_EQ(exact.at("same"), 1000);
  EXPECT_EQ(exact.at("hit_or_miss_differs"), 0);
  const nlohmann::json& one = details.at("threads").at("1");
  const double direct_hits = one.at("counters").at("hits"), mesh_hits = one.at("mesh_1e-5").at("hits");
  // The mesh is inscribed, by less than a pixel at the outline.
  EXPECT_NEAR(direct_hits, mesh_hits, 0.01 * direct_hits);
  EXPECT_EQ(one.at("counters").at("rays"), 64 * 64);
  EXPECT_EQ(one.at("counters").at("certified").get<int>() + one.at("counters").at("converged").get<int>() +
                one.at("counters").at("unresolved").get<int>(),
            64 * 64);
  EXPECT_EQ(one.at("mesh_1e-3").at("triangles"), 48 * (24 - 1) * 2);
  EXPECT_DOUBLE_EQ(one.at("mesh_1e-3").at("mesh_ms"), 20);
}

TEST_F(ModelBench, PicturesAreSampledInAllWays) {
  options_.samples = 9;
  const nlohmann::json details = MeasureModel(case_, importer_, options_).value().details;
  const nlohmann::json& samples = details.at("threads").at("1").at("samples");
  std::map<std::string, int> by_name;
  for (const nlohmann::json& way : samples) {
    by_name[way.at("name")] = way.at("samples");
    EXPECT_GT(way.at("total_ms"), 0);
  }
  EXPECT_EQ(by_name.at("one"), 1);
  EXPECT_EQ(by_name.at("uniform"), 9);
  EXPECT_EQ(by_name.at("default"), 9);
  EXPECT_EQ(samples.front().at("ratio_to_one"), 1);
  EXPECT_EQ(SampleTable({details}).rows.size(), samples.size());
}

TEST_F(ModelBench, AMeshThatIsNotDoneCountsAtTheLimit) {
  const auto tessellate = importer_.tessellate;
  importer_.tessellate = [&](double deflection) -> Result<BenchMesh> {
    if (deflection != kFineDeflection) return tessellate(deflection);
    return BenchMesh{nullptr, 60000, 0, 0, "meshing takes longer than 60 s"};
  };
  const ModelCosts costs = MeasureModel(case_, importer_, options_).value();
  for (const BenchValue& value : costs.values) {
    if (value.aim == "first_image_fine_mesh") {
      EXPECT_TRUE(value.at_limit);
      EXPECT_EQ(value.other, 60000);
      EXPECT_DOUBLE_EQ(value.ratio, 60000 / value.direct);
    } else if (value.aim.starts_with("trace_fine_mesh") || value.aim.starts_with("memory")) {
      EXPECT_EQ(value.skipped, "meshing takes longer than 60 s");
    } else {
      EXPECT_TRUE(value.skipped.empty());
    }
  }
}

TEST_F(ModelBench, AModelWithoutABrepIsMeasuredAlone) {
  std::set<std::string> measured;
  const ModelCosts costs = MeasureModel(case_, {}, options_).value();
  for (const BenchValue& value : costs.values)
    if (value.skipped.empty()) measured.insert(value.aim);
  EXPECT_EQ(measured, (std::set<std::string>{"next_view", "samples", "two_cores"}));
}

TEST_F(ModelBench, StopsWhenItIsTold) {
  const std::atomic<bool> stop{true};
  options_.execution.cancel = &stop;
  const Result<ModelCosts> costs = MeasureModel(case_, importer_, options_);
  ASSERT_FALSE(costs.ok());
  EXPECT_EQ(costs.error().code, ErrorCode::kCancelled);
}

TEST_F(ModelBench, GrowthKnowsItsSteps) {
  GrowthRange range;
  range.sizes = {32, 64, 128};
  range.faces = {16, 100};
  range.scene_size = 64;
  range.repeats = 1;
  const Growth growth = MeasureGrowth("ball", model_, case_.camera, range).value();
  ASSERT_EQ(growth.pictures.size(), 3u);
  EXPECT_EQ(growth.pictures[2].stats.rays, 128u * 128);
  ASSERT_EQ(growth.scenes.size(), 2u);
  EXPECT_EQ(growth.scenes[0].faces, 16u);
  EXPECT_EQ(growth.scenes[1].faces, 100u);
  EXPECT_TRUE(growth.scenes[1].stats.unseen_faces.empty()) << "the work must grow with the faces";
  EXPECT_GT(growth.scenes[1].stats.leaves, growth.scenes[0].stats.leaves);
  EXPECT_TRUE(std::isfinite(growth.scene_exponent));
  EXPECT_EQ(GrowthTable(growth).rows.size(), 5u);
  const std::vector<BenchValue> values = GrowthValues(growth);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[1].ratio, growth.scene_exponent);
  const nlohmann::json json = GrowthJson(growth);
  EXPECT_EQ(nlohmann::json::parse(json.dump()), json);
}

}  // namespace
}  // namespace facetless
