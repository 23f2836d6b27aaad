// Compares the programs' answers about every sample with samples/expected.json.
//
//  1. `facetless-import` makes a model with the faces, kinds of surface and closed solids with which the file
//     was made. It loses nothing, and its bounding box contains the shape and is not much larger.
//  2. `facetless inspect` gives the expected exit code, and prints a report for a sound file.
//  3. A broken file gives its exit code, and no model.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "render/model/model.h"
#include "render/model/model_file.h"
#include "render/model/walk.h"
#include "tests/support/files.h"
#include "tests/system/samples/program.h"
#include "tests/system/samples/samples.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json Expected() {
  return json::parse(std::ifstream(Sample("expected.json")));
}

TEST(Samples, TheListIsThere) {
  EXPECT_GE(SampleNames().size(), 15u);
}

class SampleFile : public testing::TestWithParam<std::string> {};

TEST_P(SampleFile, ImportMakesWhatTheFileWasMadeOf) {
  const json expected = Expected()[GetParam()];
  const fs::path model_path =
      fs::path(testing::TempDir()) / (fs::path(GetParam()).filename().string() + ".flm");
  fs::remove(model_path);
  const ProgramResult imported =
      RunProgram("facetless-import '" + Sample(GetParam()) + "' --model '" + model_path.string() + "'");
  ASSERT_EQ(imported.exit_code, expected["exit"].get<int>()) << imported.output;
  if (!expected.contains("faces")) {
    EXPECT_FALSE(fs::exists(model_path));
    return;
  }
  const Result<Model> read = ReadModel(model_path.string());
  fs::remove(model_path);
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Model& model = read.value();

  EXPECT_EQ(model.PlacedFaceCount(), expected["faces"].get<std::uint32_t>());
  EXPECT_TRUE(model.info.faces_lost.empty());
  EXPECT_TRUE(model.info.loops_lost.empty());
  EXPECT_TRUE(model.info.edges_lost.empty());

  int solids = 0, closed = 0;
  std::map<std::string, int> surfaces;
  for (const Instance& instance : model.instances) {
    const Part& part = model.parts[instance.part];
    for (const Face& face : FacesOf(model, part))
      ++surfaces[SurfaceKindName(model.surfaces[face.surface].kind)];
    for (const Solid& solid : SolidsOf(model, part)) {
      ++solids;
      closed += solid.closed ? 1 : 0;
    }
  }
  EXPECT_EQ(solids, expected["solids"].get<int>());
  EXPECT_EQ(closed, expected["closed_solids"].get<int>());
  EXPECT_EQ(json(surfaces), expected["surfaces"]);

  // The bounds are conservative: they contain the shape, and exceed it by at most a tenth of its diagonal.
  const double slack = 0.1 * model.Diagonal();
  // The uncertainty of the file's decimal digits and of OpenCASCADE's own bounding box.
  const double noise = 1e-5;
  const double low[3] = {model.bounds.low.x, model.bounds.low.y, model.bounds.low.z};
  const double high[3] = {model.bounds.high.x, model.bounds.high.y, model.bounds.high.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double expected_low = expected["bounds_mm"][0][axis],
                 expected_high = expected["bounds_mm"][1][axis];
    EXPECT_LE(low[axis], expected_low + noise);
    EXPECT_GE(low[axis], expected_low - slack);
    EXPECT_GE(high[axis], expected_high - noise);
    EXPECT_LE(high[axis], expected_high + slack);
  }
}

TEST_P(SampleFile, InspectGivesItsExitCodeAndReport) {
  const json expected = Expected()[GetParam()];
  const ProgramResult inspected = RunProgram("facetless inspect '" + Sample(GetParam()) + "'");
  ASSERT_EQ(inspected.exit_code, expected["exit"].get<int>()) << inspected.output;
  if (!expected.contains("faces")) return;
  const json model = json::parse(inspected.output)["model"];
  EXPECT_EQ(model["file"], fs::path(GetParam()).filename().string());
  EXPECT_EQ(model["faces_skipped"], json::array());
  EXPECT_EQ(model["loops_lost"], json::array());
}

TEST(VoxelSamples, AreReadAndRendered) {
  ASSERT_EQ(SampleNames(true).size(), 2u);
  for (const std::string& name : SampleNames(true)) {
    SCOPED_TRACE(name);
    const json expected = Expected()[name];
    EXPECT_LT(fs::file_size(Sample(name)), 700'000u);
    const fs::path picture = fs::path(testing::TempDir()) / "voxel_sample.png";
    fs::remove(picture);
    const ProgramResult rendered = RunProgram("facetless render '" + Sample(name) + "' --out '" +
                                              picture.string() + "' --size 64x64 --samples 1");
    ASSERT_EQ(rendered.exit_code, expected["exit"].get<int>()) << rendered.output;
    EXPECT_TRUE(fs::exists(picture));
    const json answer = json::parse(rendered.output);
    for (const char* key : {"size", "filled", "pitch_mm"})
      EXPECT_EQ(answer["voxels"][key], expected["voxels"][key]) << key;
    EXPECT_GT(answer["rays"]["primary"]["hits"], 500);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SampleFile, testing::ValuesIn(SampleNames()),
                         [](const auto& info) { return TestName(info.param); });

}  // namespace
}  // namespace facetless
