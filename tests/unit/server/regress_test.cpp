#include "server/run/regress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server/base/exit_code.h"
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
  EXPECT_EQ(verdict.value().at("exit_code"), kExitUnusable);
  EXPECT_FALSE(verdict.value().at("passed").get<bool>());
  ASSERT_EQ(verdict.value().at("files").size(), 3u);
  EXPECT_EQ(verdict.value()["files"][0]["error"]["code"], "format-broken");
  EXPECT_EQ(verdict.value()["files"][1]["error"]["code"], "importer-crashed");
  EXPECT_EQ(verdict.value()["files"][2]["error"]["code"], "file-unreadable");
}

TEST_F(Manifest, WithoutAFileIsRefused) {
  EXPECT_THAT(ErrorOf(R"({"files": []})"), testing::HasSubstr("it lists no file"));
}

}  // namespace
}  // namespace facetless
