#include "server/options/picture_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/options/options.h"
#include "tests/unit/server/parsed_options.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

const Box3 kBounds = {{-10, -20, -30}, {10, 20, 30}};

TEST(PictureOptions, HaveTheDocumentedDefaults) {
  const PictureOptions options = ParsedOptions("{}").picture;
  EXPECT_EQ(options.margin, 0.05);
  EXPECT_EQ(options.up, UpAxis::kZ);
}

TEST(PictureOptions, MarginAndUpReachTheCameras) {
  const RunOptions options = ParsedOptions(R"({"view":"front","margin":0.25,"up":"y","size":"100x100"})");
  const Camera camera = ResolveCameras(options, kBounds).value().front();
  EXPECT_EQ(camera.up.y, 1);
  EXPECT_GT(camera.eye.z, kBounds.high.z);
  // The model is 40 mm high and fills the middle half of the picture.
  EXPECT_NEAR(camera.height, 80, 1e-12);
  const RunOptions numbers = ParsedOptions(R"({"camera":{"eye":[100,0,0]},"margin":0.25,"up":"y"})");
  const Camera given = ResolveCameras(numbers, kBounds).value().front();
  EXPECT_EQ(given.up.y, 1);
  EXPECT_NEAR(given.height, 1.25 * kBounds.diagonal(), 1e-12);
}

TEST(PictureOptions, AreReadByName) {
  const PictureOptions options =
      ParsedOptions(R"({"color":"#ff8000","parts":"bolt, M8","hide":["a","b*"],"explode":0.5,
    "scale-bar":true,"axes":true,"sheet":true,"turntable":36,"turntable_seconds":4})")
          .picture;
  EXPECT_EQ(options.coloring.source, ColorSource::kOne);
  EXPECT_EQ(options.coloring.one.r, 1);
  EXPECT_NEAR(options.coloring.one.g, 128.0 / 255, 1e-6);
  EXPECT_EQ(options.arrangement.parts, std::vector<std::string>{"bolt, M8"})
      << "the comma must be part of the name";
  EXPECT_EQ(options.arrangement.hide, (std::vector<std::string>{"a", "b*"}));
  EXPECT_EQ(options.arrangement.explode, 0.5);
  EXPECT_TRUE(options.scale_bar && options.axes && options.sheet);
  EXPECT_EQ(options.turntable, 36);
  EXPECT_EQ(options.turntable_s, 4);
  EXPECT_EQ(ParsedOptions(R"({"color":"part"})").picture.coloring.source, ColorSource::kPart);
  EXPECT_EQ(ParsedOptions(R"({"color":"face"})").picture.coloring.source, ColorSource::kFile);
}

TEST(PictureOptions, AScaleBarNeedsViewsWithOneScale) {
  EXPECT_THAT(OptionsMessage(R"({"scale_bar":true,"projection":"perspective"})"), HasSubstr("orthographic"));
  const char* const mixed =
      R"({"scale_bar":true,"camera":[{"eye":[1,2,3]},{"eye":[1,2,4],"projection":"perspective"}]})";
  EXPECT_THAT(OptionsMessage(mixed), HasSubstr("orthographic"));
  ParsedOptions(
      R"({"scale_bar":true,"projection":"perspective","camera":{"eye":[1,2,3],"projection":"orthographic"}})");
}

TEST(PictureOptions, ThatAreWrongSayWhatIsAllowed) {
  EXPECT_THAT(OptionsMessage(R"({"margin":0.5})"), HasSubstr("from 0 to 0.45"));
  EXPECT_THAT(OptionsMessage(R"({"margin":"wide"})"), HasSubstr("margin is \"wide\""));
  EXPECT_THAT(OptionsMessage(R"({"up":"w"})"), HasSubstr("x, y, z"));
  for (const char* color : {"red", "#12345", "#12345g", "#-12345", "#1234567", ""})
    EXPECT_THAT(OptionsMessage(Json{{"color", color}}.dump()), HasSubstr("a colour such as")) << color;
  EXPECT_THAT(OptionsMessage(R"({"parts":[""]})"), HasSubstr("empty name"));
  EXPECT_THAT(OptionsMessage(R"({"hide":[3]})"), HasSubstr("not a name"));
  EXPECT_THAT(OptionsMessage(R"({"explode":-1})"), HasSubstr("from 0 to 100"));
  EXPECT_THAT(OptionsMessage(R"({"turntable":1})"), HasSubstr("at least 2 frames"));
  EXPECT_THAT(OptionsMessage(R"({"turntable":361})"), HasSubstr("from 0 to 360"));
}

}  // namespace
}  // namespace facetless
