#include "server/run/regress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "server/base/exit_code.h"
#include "tests/unit/server/option_samples.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;

Image8 Plain(int width, int height, std::vector<std::uint8_t> pixel) {
  Image8 image{width, height, static_cast<int>(pixel.size()), {}};
  for (int i = 0; i < width * height; ++i) image.bytes.insert(image.bytes.end(), pixel.begin(), pixel.end());
  return image;
}

TEST(SideBySide, ShowsThreeOnWhite) {
  const Image8 joined =
      SideBySide(Plain(4, 3, {10, 20, 30}), Plain(4, 3, {0, 0, 0, 0}), Plain(4, 3, {200, 0, 0, 255}));
  EXPECT_EQ(joined.width, 3 * 4 + 2 * 8);
  EXPECT_EQ(joined.height, 3);
  EXPECT_EQ(joined.at(0, 0)[1], 20);
  EXPECT_EQ(joined.at(4, 1)[0], 255) << "the gap";
  EXPECT_EQ(joined.at(12, 1)[0], 255) << "transparent";
  EXPECT_EQ(joined.at(24, 2)[0], 200);
  EXPECT_EQ(joined.at(24, 2)[1], 0);
}

TEST(ErrorPicture, GrowsLighterWithTheError) {
  std::vector<float> errors;
  for (int i = 0; i <= 100; ++i) errors.push_back(static_cast<float>(i) / 100);
  const Image8 picture = ErrorPicture(errors, 101, 1);
  int before = -1;
  for (int x = 0; x < 101; ++x) {
    const int sum = picture.at(x, 0)[0] + picture.at(x, 0)[1] + picture.at(x, 0)[2];
    EXPECT_GE(sum, before);
    before = sum;
  }
  EXPECT_EQ(picture.at(0, 0)[0], 0);
  EXPECT_EQ(picture.at(100, 0)[2], 255);
}

TEST(CompareDepths, CountsWhatOnlyOneHits) {
  const DepthImage a = {3, 1, {1.0, INFINITY, 5.0}}, b = {3, 1, {1.5, 2.0, 5.0}};
  const DepthDifference difference = CompareDepths(a, b).value();
  EXPECT_EQ(difference.max_mm, 0.5);
  EXPECT_EQ(difference.silhouette_pixels, 1u);
  EXPECT_EQ(CompareDepths(a, {1, 1, {1.0}}).error().code, ErrorCode::kSizeMismatch);
  EXPECT_EQ(CompareDepths(a, {3, 1, {NAN, 2.0, 5.0}}).error().code, ErrorCode::kNotFinite);
}

class Manifest : public testing::Test {
 protected:
  std::string ErrorOf(const std::string& text) {
    RegressRequest request;
    request.manifest = WriteText(directory_.File("manifest.json"), text);
    auto verdict = RunRegress(request);
    EXPECT_FALSE(verdict.ok());
    if (verdict.ok()) return "";
    EXPECT_EQ(verdict.error().code, ErrorCode::kBadUsage);
    return verdict.error().message;
  }
  TempDir directory_ = TempDir::Create().value();
};

TEST_F(Manifest, ThatIsWrongSaysWhere) {
  EXPECT_THAT(ErrorOf("nonsense"), HasSubstr("is not valid JSON: line 1, column 2"));
  EXPECT_THAT(ErrorOf("{}"), HasSubstr("list \"files\""));
  EXPECT_THAT(ErrorOf(R"({"files":[],"extra":1})"), HasSubstr("there is no \"extra\""));
  EXPECT_THAT(ErrorOf(R"({"files":[{}]})"), HasSubstr("an object with a \"file\""));
  EXPECT_THAT(ErrorOf(R"({"files":[{"file":"a.step","veiw":"iso"}]})"),
              HasSubstr("there is no option \"veiw\""));
  EXPECT_THAT(ErrorOf(R"({"files":[{"file":"a.step","mesh":"b.glb"}]})"),
              HasSubstr("mesh has no meaning here"));
  EXPECT_THAT(ErrorOf(R"({"files":[{"file":"a.step","tolerances":{"flop":1}}]})"),
              HasSubstr("no tolerance \"flop\""));
  EXPECT_THAT(ErrorOf(R"({"files":[{"file":"a.step","tolerances":{"max":-1}}]})"), HasSubstr("at least 0"));
  EXPECT_THAT(ErrorOf(R"({"files":[{"file":"a/x.step"},{"file":"b/x.step"}]})"),
              HasSubstr("two files are named x"));
}

TEST_F(Manifest, AFileThatCannotBeUsedFailsAloneAndTheRestGoesOn) {
  const ScopedEnvironment importer("FACETLESS_IMPORTER", Program("facetless-fake-importer"));
  WriteText(directory_.File("broken.step"), "unusable format-broken");
  WriteText(directory_.File("crash.step"), "crash");
  RegressRequest request;
  request.manifest =
      WriteText(directory_.File("manifest.json"),
                R"({"files":[{"file":"broken.step"},{"file":"crash.step"},{"file":"absent.step"}]})");
  auto verdict = RunRegress(request);
  ASSERT_TRUE(verdict.ok()) << verdict.error().message;
  EXPECT_EQ(verdict.value().exit_code, kExitUnusable);
  const nlohmann::json& json = verdict.value().verdict;
  EXPECT_EQ(json.at("exit_code"), kExitUnusable);
  EXPECT_FALSE(json.at("passed").get<bool>());
  ASSERT_EQ(json.at("files").size(), 3u);
  EXPECT_EQ(json["files"][0]["error"]["code"], "format-broken");
  EXPECT_EQ(json["files"][1]["error"]["code"], "importer-crashed");
  EXPECT_EQ(json["files"][2]["error"]["code"], "file-unreadable");
  EXPECT_THAT(verdict.value().failures,
              testing::ElementsAre(testing::StartsWith("broken: "), testing::StartsWith("crash: "),
                                   testing::StartsWith("absent: ")));
}

TEST_F(Manifest, WithoutAFileIsRefused) {
  EXPECT_THAT(ErrorOf(R"({"files": []})"), testing::HasSubstr("it lists no file"));
}

// The options of a manifest are those of its rows in the option table.
class ManifestOptions : public testing::Test {
 protected:
  // Returns the exit code for a manifest whose only file is `sample` with these options; −1 if the manifest
  // is invalid.
  int Regress(const std::string& sample, nlohmann::json options, bool update) {
    options["file"] = Sample(sample);
    RegressRequest request;
    request.manifest =
        WriteText(directory_.File("manifest.json"), nlohmann::json{{"files", {options}}}.dump());
    request.update = update;
    request.unit_mm = unit_mm_;
    auto verdict = RunRegress(request);
    if (!verdict.ok()) {
      message_ = verdict.error().message;
      return -1;
    }
    result_ = verdict.value();
    return result_.exit_code;
  }
  // Checks that the option `name` changes the picture or the depth, and that a second run with it gives the
  // same result.
  void ExpectFollowed(const std::string& sample, const nlohmann::json& base, const std::string& name,
                      const nlohmann::json& value) {
    nlohmann::json with = base;
    with[name] = value;
    EXPECT_EQ(Regress(sample, with, true), kExitDone) << message_;
    EXPECT_EQ(Regress(sample, with, false), kExitDone) << message_;
    EXPECT_EQ(Regress(sample, base, false), kExitFailed) << name << " makes no difference";
  }

  const ScopedEnvironment importer_{"FACETLESS_IMPORTER", Program("facetless-import")};
  TempDir directory_ = TempDir::Create().value();
  double unit_mm_ = 0;  // of --unit
  std::string message_;
  RegressResult result_;
};

TEST_F(ManifestOptions, AreEachTakenOrRefusedAsTheTableSays) {
  for (const OptionRow& row : AllOptions()) {
    if (row.name == "tolerances") continue;  // a key of the manifest itself
    SCOPED_TRACE(row.name);
    message_.clear();
    (void)Regress("no such file.step", {{row.name, AnotherValueOf(row)}}, false);
    if ((row.commands & kManifest) != 0)
      EXPECT_EQ(message_, "");
    else
      EXPECT_THAT(message_, HasSubstr("the option " + row.name + " has no meaning here"));
  }
}

TEST_F(ManifestOptions, ShadeIsFollowed) {
  ExpectFollowed("cone.step", {{"size", "48x40"}}, "shade", "zebra");
}

TEST_F(ManifestOptions, OrientIsFollowed) {
  // A sheet seen from below shows the side that the file does not call the outside.
  ExpectFollowed("wavy_sheet.step", {{"size", "48x40"}, {"view", "bottom"}, {"shade", "curvature:kind=mean"}},
                 "orient", "viewer");
}

TEST_F(ManifestOptions, NewtonToleranceIsFollowed) {
  ExpectFollowed("wavy_sheet.step", {{"size", "48x40"}, {"tolerances", {{"depth_mm", 0}, {"max", 1}}}},
                 "newton_tolerance", 1e-3);
}

TEST_F(ManifestOptions, UnitIsFollowedAndComesBeforeThatOfTheCommandLine) {
  nlohmann::json options = {{"size", "32x32"}, {"tolerances", {{"depth_mm", 1e-9}, {"max", 1}}}};
  ASSERT_EQ(Regress("sphere.step", options, true), kExitDone) << message_;
  unit_mm_ = 25.4;
  EXPECT_EQ(Regress("sphere.step", options, false), kExitFailed) << "--unit makes no difference";
  EXPECT_THAT(result_.failures, testing::ElementsAre(HasSubstr("depth_mm")));
  options["unit"] = "mm";
  EXPECT_EQ(Regress("sphere.step", options, false), kExitDone) << message_;
  options["unit"] = "in";
  unit_mm_ = 0;
  EXPECT_EQ(Regress("sphere.step", options, false), kExitFailed) << "the manifest's unit makes no difference";
}

TEST_F(ManifestOptions, MaxViewMemoryIsFollowed) {
  EXPECT_EQ(Regress("teapot.step", {{"size", "512x512"}}, true), kExitDone) << message_;
  EXPECT_EQ(Regress("teapot.step", {{"size", "512x512"}, {"max_view_memory", 1}}, false), kExitUnusable);
  EXPECT_EQ(result_.verdict.at("files").at(0).at("error").at("code"), "limit-exceeded");
}

TEST_F(ManifestOptions, ThatBreakTolerancesAreNamedWithTheirViews) {
  const nlohmann::json two = {{"size", "32x32"}, {"view", {"iso", "top"}}};
  ASSERT_EQ(Regress("cone.step", two, true), kExitDone) << message_;
  EXPECT_THAT(result_.failures, testing::IsEmpty());
  std::filesystem::remove(directory_.File("references/cone.top.png"));
  nlohmann::json other = two;
  other["shade"] = "zebra";
  EXPECT_EQ(Regress("cone.step", other, false), kExitFailed);
  ASSERT_EQ(result_.failures.size(), 2u);
  EXPECT_THAT(result_.failures[0],
              testing::MatchesRegex("cone, view 'iso': the tolerance max is broken: the value "
                                    "is 0[.][0-9]+, the limit is 0"));
  EXPECT_THAT(result_.failures[1], HasSubstr("cone, view 'top': no reference: run with --update"));
}

}  // namespace
}  // namespace facetless
