#include "server/run/report_html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/compare/pixel_data.h"
#include "render/image/io.h"
#include "server/base/web_assets.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Base64, OfRfc4648) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64("\xff\xfe\xfd"), "//79");
}

class ReportPage : public testing::Test {
 protected:
  ReportPage() { WriteText(directory_.File("iso.direct.png"), "PNG"); }
  nlohmann::json report_ = {
      {"model", {{"file", "part.step"}}},
      {"views", {{{"name", "iso"}, {"files", {{"direct", "iso.direct.png"}, {"depth", "iso.depth.tif"}}}}}}};
  TempDir directory_ = TempDir::Create().value();
};

TEST_F(ReportPage, CarriesEverythingAndFetchesNothing) {
  auto html = ReportHtml(report_, directory_.path());
  ASSERT_TRUE(html.ok()) << html.error().message;
  EXPECT_THAT(html.value(), HasSubstr("\"iso.direct.png\":\"data:image/png;base64,UE5H\""));
  EXPECT_THAT(html.value(), HasSubstr("<title>part.step"));
  EXPECT_THAT(html.value(), HasSubstr(std::string(WebAsset("report.js"))));
  EXPECT_THAT(html.value(), HasSubstr(std::string(WebAsset("style.css"))));
  for (const char* outside : {"http://", "https://", "@import", "src=\"", "url("})
    EXPECT_THAT(html.value(), Not(HasSubstr(outside))) << outside;
}

TEST_F(ReportPage, DoesNotRunWhatAFileCarries) {
  report_["model"]["file"] = "</title></script><script>alert(1)</script>{{pictures}}<!--";
  auto html = ReportHtml(report_, directory_.path());
  ASSERT_TRUE(html.ok());
  EXPECT_THAT(html.value(), Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html.value(), Not(HasSubstr("<!--")));
  EXPECT_THAT(html.value(), HasSubstr("&lt;/title&gt;"));
  // Text that looks like a placeholder must stay unchanged.
  EXPECT_THAT(html.value(), HasSubstr("{{pictures}}"));
}

TEST_F(ReportPage, IsOneScriptWithoutModulesToFetch) {
  const std::string script(WebAsset("report.js"));
  EXPECT_THAT(script, HasSubstr("const showReport"));
  EXPECT_THAT(script, Not(HasSubstr("\nimport ")));
  EXPECT_THAT(script, Not(HasSubstr("\nexport ")));
}

TEST_F(ReportPage, CarriesPixelDataReducedAndNoPictureOfTheDifference) {
  // 2000 × 1000 pixels are too many for a report, so it contains every second one.
  Image8 plane = {2000, 1000, 3, std::vector<std::uint8_t>(6'000'000, 7)};
  ASSERT_TRUE(WriteDataPng(directory_.File("iso.pixel-deviation.png"), plane).ok());
  WriteText(directory_.File("iso.difference.png"), "PNG");
  report_["views"][0]["camera"] = {{"width", 2000}, {"height_px", 1000}};
  report_["views"][0]["files"] = {{"difference", "iso.difference.png"},
                                  {"pixel-deviation", "iso.pixel-deviation.png"}};
  auto html = ReportHtml(report_, directory_.path());
  ASSERT_TRUE(html.ok()) << html.error().message;
  EXPECT_THAT(html.value(), Not(HasSubstr("\"iso.difference.png\":\"data:")));
  const std::string embedded = Base64(EncodeDataPng(ReducedPlane(PixelPlane::kDeviation, plane, 2)).value());
  EXPECT_THAT(html.value(), HasSubstr("\"iso.pixel-deviation.png\":\"data:image/png;base64," + embedded));
}

TEST_F(ReportPage, OfARegressHasThePicturesOfWhatFailed) {
  const nlohmann::json verdict = {
      {"command", "regress"},
      {"manifest", "manifest.json"},
      {"files",
       {{{"name", "part"},
         {"views", {{{"name", "iso"}, {"files", {{"image", directory_.File("iso.direct.png")}}}}}}},
        {{"name", "unreadable"}, {"error", {{"message", "<script>"}}}}}}};
  auto html = RegressHtml(verdict);
  ASSERT_TRUE(html.ok()) << html.error().message;
  EXPECT_THAT(html.value(), HasSubstr("iso.direct.png\":\"data:image/png;base64,UE5H\""));
  EXPECT_THAT(html.value(), Not(HasSubstr("\"<script>")));
}

TEST_F(ReportPage, NeedsItsPictures) {
  std::filesystem::remove(directory_.File("iso.direct.png"));
  EXPECT_EQ(ReportHtml(report_, directory_.path()).error().code, ErrorCode::kFileUnreadable);
}

}  // namespace
}  // namespace facetless
