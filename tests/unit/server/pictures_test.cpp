// Tests pictures that the program makes of an assembly of 13 occurrences.
#include "server/run/pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "render/image/io.h"
#include "server/base/exit_code.h"
#include "server/run/run.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class Pictures : public testing::Test {
 protected:
  // Runs a command on the sample of that name, and returns the report.
  Json Run(const std::string& command, const std::string& out, std::vector<std::string> arguments,
           const std::string& sample = "assembly.step") {
    const std::vector<std::string> common = {command, Sample(sample), "--out", out};
    arguments.insert(arguments.begin(), common.begin(), common.end());
    outcome_ = RunProgram(Program("facetless"), arguments, directory_.path());
    EXPECT_EQ(outcome_.exit_code, kExitDone) << outcome_.error_tail;
    return Json::parse(Read(out + "/report.json"), nullptr, false);
  }
  // Returns the message for invalid options.
  std::string Refusal(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin() + 1, {Sample("assembly.step"), "--out", "refused"});
    outcome_ = RunProgram(Program("facetless"), arguments, directory_.path());
    EXPECT_EQ(outcome_.exit_code, kExitUsage);
    return outcome_.error_tail;
  }
  std::string Read(const std::string& name) { return ReadText(directory_.File(name)); }
  Image8 Picture(const std::string& name) {
    auto picture = ReadPng(directory_.File(name));
    EXPECT_TRUE(picture.ok()) << picture.error().message;
    return picture.ok() ? picture.value() : Image8{};
  }
  TempDir directory_ = TempDir::Create().value();
  ChildOutcome outcome_;
};

TEST_F(Pictures, PartsAndHideDivideTheFacesAndBothTracersAgreeOnWhatIsLeft) {
  const Json all = Run("compare", "all", {"--size", "96x96"});
  const Json bolts = Run("compare", "bolts", {"--size", "96x96", "--parts", "BOLT"});
  const Json rest = Run("compare", "rest", {"--size", "96x96", "--hide", "*bolt*"});
  EXPECT_FALSE(all.contains("arrangement"));
  EXPECT_EQ(bolts.at("model").at("faces").get<int>() + rest.at("model").at("faces").get<int>(),
            all.at("model").at("faces").get<int>());
  EXPECT_EQ(bolts.at("arrangement").at("left_out").at("faces"), rest.at("model").at("faces"));
  EXPECT_EQ(bolts.at("arrangement").at("shown"), 8);
  EXPECT_LT(bolts.at("model").at("diagonal_mm"), all.at("model").at("diagonal_mm"));
  for (const Json& report : {all, bolts, rest}) {
    const Json& view = report.at("views").at(0);
    EXPECT_GT(view.at("direct").at("hits"), 500);
    EXPECT_EQ(view.at("direct").at("unresolved"), 0);
    // If the mesh had another arrangement, the deviation would be the size of a bolt.
    EXPECT_LT(view.at("difference").at("deviation_mm").at("max"), 0.5);
    EXPECT_LT(view.at("difference").at("silhouette").at("max_distance_px"), 2);
  }
  EXPECT_LT(bolts.at("views")[0].at("baseline").at("triangles"),
            all.at("views")[0].at("baseline").at("triangles"));
}

TEST_F(Pictures, ExplodedModelAndMeshMoveAlikeAndTheCameraShowsThem) {
  const Json together = Run("compare", "together", {"--size", "128x128", "--view", "front"});
  const Json apart = Run("compare", "apart", {"--size", "128x128", "--view", "front", "--explode", "1"});
  EXPECT_GT(apart.at("model").at("diagonal_mm"), together.at("model").at("diagonal_mm"));
  EXPECT_LT(apart.at("views")[0].at("difference").at("deviation_mm").at("max"), 0.5);
  EXPECT_EQ(apart.at("model").at("faces"), together.at("model").at("faces"));
  // No part may touch the border.
  const Image8 picture = Picture("apart/front.direct.png");
  for (int x = 0; x < picture.width; ++x) {
    EXPECT_EQ(picture.at(x, 0)[0], picture.at(0, 0)[0]);
    EXPECT_EQ(picture.at(x, picture.height - 1)[0], picture.at(0, 0)[0]);
  }
}

TEST_F(Pictures, WhatCannotBeDoneIsSaidInOneSentence) {
  EXPECT_THAT(Refusal({"render", "--parts", "whel"}),
              HasSubstr("no part's name matches \"whel\"; there are"));
  EXPECT_THAT(Refusal({"render", "--hide", "*"}), HasSubstr("leave nothing"));
  EXPECT_THAT(Refusal({"render", "--scale-bar", "--projection", "perspective"}), HasSubstr("orthographic"));
  EXPECT_THAT(Refusal({"render", "--turntable", "1"}), HasSubstr("at least 2 frames"));
  EXPECT_THAT(Refusal({"compare", "--color", "mauve"}), HasSubstr("#c8b496"));
  const std::string sphere = directory_.File("sphere.stl");
  WriteText(sphere,
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 90 0 0\nvertex 0 90 "
            "40\nendloop\nendfacet\nendsolid a\n");
  EXPECT_THAT(Refusal({"compare", "--mesh", sphere, "--parts", "bolt"}),
              HasSubstr("need Facetless's own mesh"));
}

TEST_F(Pictures, WhatIsDrawnInAtLastChangesNoNumber) {
  const Json bare = Run("compare", "bare", {"--size", "200x150"});
  const Json drawn = Run("compare", "drawn", {"--size", "200x150", "--axes", "--scale-bar", "--sheet"});
  EXPECT_EQ(drawn.at("views")[0].at("difference"), bare.at("views")[0].at("difference"));
  for (const char* role : {"direct", "baseline", "difference"}) {
    const std::string name = std::string("/iso.") + role + ".png";
    EXPECT_NE(Read("drawn" + name), Read("bare" + name)) << role;
  }
  EXPECT_EQ(Read("drawn/iso.depth.tif"), Read("bare/iso.depth.tif"));
}

TEST_F(Pictures, OneColourIsTheOnlyOne) {
  Run("render", "red", {"--size", "64x64", "--color", "#ff0000", "--background", "transparent"});
  const Image8 picture = Picture("red/iso.direct.png");
  int seen = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const std::uint8_t* p = picture.at(x, y);
      if (p[3] < 255) continue;
      ++seen;
      EXPECT_GT(p[0], p[1]);
      EXPECT_NEAR(p[1], p[2], 8) << "the light is nearly white";
    }
  EXPECT_GT(seen, 500);
  Run("render", "part", {"--size", "64x64", "--color", "part"});
  Run("render", "file", {"--size", "64x64"});
  EXPECT_NE(Read("part/iso.direct.png"), Read("file/iso.direct.png"));
}

TEST_F(Pictures, TheSheetHasAllViews) {
  const Json report =
      Run("render", "sheet",
          {"--size", "100x60", "--sheet", "--view", "front", "--view", "top", "--view", "iso"});
  EXPECT_EQ(report.at("files").at("sheet"), "sheet.png");
  const Image8 sheet = Picture("sheet/sheet.png");
  EXPECT_EQ(sheet.width, 16 + 2 * (100 + 16));
  EXPECT_EQ(sheet.height, 16 + 2 * (60 + 34));
  const Json compared =
      Run("compare", "rows", {"--size", "100x60", "--sheet", "--view", "front", "--view", "top"});
  EXPECT_EQ(Picture("rows/sheet.png").width, 16 + 3 * (100 + 16)) << "exact, mesh, difference";
}

TEST_F(Pictures, TheTurntableIsTheSameForAnyNumberOfThreads) {
  const std::vector<std::string> arguments = {
      "--size", "120x90", "--turntable", "5", "--turntable-seconds", "1", "--axes", "--sheet", "--threads"};
  std::vector<std::string> one = arguments, three = arguments;
  one.emplace_back("1");
  three.emplace_back("3");
  const Json report = Run("render", "one", one);
  Run("render", "three", three);
  const Json& turntable = report.at("turntable");
  ASSERT_EQ(turntable.at("frames").size(), 5u);
  EXPECT_EQ(turntable.at("seconds"), 1);
  std::set<std::string> frames;
  for (const Json& frame : turntable.at("frames")) {
    const std::string name = "/" + frame.get<std::string>();
    frames.insert(Read("one" + name));
    EXPECT_EQ(Read("one" + name), Read("three" + name));
  }
  EXPECT_EQ(frames.size(), 5u) << "each frame must show another side";
  EXPECT_EQ(report.at("files").at("turntable"), "turntable.webp");
  EXPECT_EQ(Read("one/turntable.webp").substr(8, 4), "WEBP");
  EXPECT_EQ(Read("one/turntable.webp"), Read("three/turntable.webp"));
  EXPECT_EQ(Read("one/sheet.png"), Read("three/sheet.png"));
}

TEST_F(Pictures, AViewThatNeedsMoreMemoryThanItMayTakeSaysSo) {
  ImportRequest request;
  request.input = Sample("teapot.step");
  const ScopedEnvironment importer("FACETLESS_IMPORTER", Program("facetless-import"));
  auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  RunOptions options;
  options.width = options.height = 32;
  EXPECT_TRUE(RunRender(imported.value(), options, directory_.File("bounded"), {}).ok());
  options.accuracy.max_bytes = 1;
  const auto refused = RunRender(imported.value(), options, directory_.File("bounded"), {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kLimitExceeded);
  EXPECT_NE(refused.error().message.find("more leaves than fit into the memory"), std::string::npos);
}

TEST_F(Pictures, ATurntableCanBeStopped) {
  ImportRequest request;
  request.input = Sample("sphere.step");
  const ScopedEnvironment importer("FACETLESS_IMPORTER", Program("facetless-import"));
  auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  RunOptions options;
  options.width = options.height = 32;
  options.picture.turntable = 360;
  std::atomic<bool> cancel{false};
  double last = 0;
  const RunContext context = {{.threads = 0, .cancel = &cancel},
                              [&](const std::string& stage, double fraction) {
                                if (stage != "turntable") return;
                                last = fraction;
                                if (fraction > 0.02) cancel = true;
                              }};
  const auto report = RunRender(imported.value(), options, directory_.File("stopped"), context);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.error().code, ErrorCode::kCancelled);
  EXPECT_LT(last, 0.1);
  EXPECT_FALSE(std::filesystem::exists(directory_.File("stopped/report.json")));
  EXPECT_FALSE(std::filesystem::exists(directory_.File("stopped/turntable.webp")));
}

}  // namespace
}  // namespace facetless
