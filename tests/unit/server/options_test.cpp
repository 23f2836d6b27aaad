#include "server/options/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/compare/report.h"
#include "tests/unit/server/parsed_options.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

const Box3 kBounds = {{-10, -20, -30}, {10, 20, 30}};

TEST(Options, HaveTheDocumentedDefaults) {
  const RunOptions options = ParsedOptions("{}");
  EXPECT_EQ(options.views, std::vector<std::string>{"iso"});
  EXPECT_EQ(options.width, 1024);
  EXPECT_EQ(options.height, 1024);
  EXPECT_EQ(options.projection, Projection::kOrthographic);
  EXPECT_EQ(options.samples, 4);
  EXPECT_EQ(options.accuracy.precision, Precision::kStandard);
  EXPECT_EQ(options.tessellation.deflection, 1e-3);
  EXPECT_EQ(options.tessellation.deflection_mm, 0);
  EXPECT_EQ(options.tessellation.angular_deg, 20);
  EXPECT_FALSE(options.strict);
  EXPECT_FALSE(options.fail.deviation_mm.has_value());
}

TEST(Options, TakeListsOfNumbersForATrade) {
  const TradeOptions defaults = ParsedOptions("{}").trade;
  EXPECT_EQ(defaults.deflections, (std::vector<double>{1e-2, 1e-3, 1e-4, 1e-5, 1e-6}));
  EXPECT_EQ(defaults.budget_s, 60);
  EXPECT_FALSE(defaults.limits.error_px.has_value());
  const TradeOptions trade = ParsedOptions(R"({"deflections":"1e-2,0.003","angles":[30,5],"tolerances":1e-4,
    "budget-seconds":5,"max-error-mm":0.1,"error-measure":"max"})")
                                 .trade;
  EXPECT_EQ(trade.deflections, (std::vector<double>{1e-2, 0.003}));
  EXPECT_EQ(trade.angles_deg, (std::vector<double>{30, 5}));
  EXPECT_EQ(trade.tolerances, std::vector<double>{1e-4});
  EXPECT_EQ(trade.limits.error_mm, 0.1);
  EXPECT_EQ(trade.measure, ErrorMeasure::kMax);
  EXPECT_THAT(OptionsMessage(R"({"deflections":"1e-2,"})"), HasSubstr("deflections is \"\""));
  EXPECT_THAT(OptionsMessage(R"({"angles":[]})"), HasSubstr("angles is an empty list"));
  EXPECT_THAT(OptionsMessage(R"({"tolerances":[2]})"), HasSubstr("from 1e-13 to 0.001"));
  EXPECT_THAT(OptionsMessage(R"({"error-measure":"p50"})"), HasSubstr("mean, p95, p99, max"));
}

TEST(Options, AreReadByName) {
  const RunOptions options =
      ParsedOptions(R"({"view":["front","top"],"size":"320x200","projection":"perspective","samples":9,
    "precision":"certified","threads":3,"audit":true,"edges":true,"background":"transparent","aov":"depth,uv",
    "deflection-mm":0.25,"angular":10,"strict":true,"fail_deviation_mm":0.5,"fail-flip":0})");
  EXPECT_EQ(options.views, (std::vector<std::string>{"front", "top"}));
  EXPECT_EQ(options.width, 320);
  EXPECT_EQ(options.height, 200);
  EXPECT_EQ(options.projection, Projection::kPerspective);
  EXPECT_EQ(options.samples, 9);
  EXPECT_EQ(options.accuracy.precision, Precision::kCertified);
  EXPECT_EQ(options.background, Background::kTransparent);
  EXPECT_TRUE(options.WantsAov("uv"));
  EXPECT_FALSE(options.WantsAov("normal"));
  EXPECT_EQ(options.tessellation.deflection_mm, 0.25);
  EXPECT_EQ(options.fail.deviation_mm, 0.5);
  EXPECT_EQ(options.fail.flip, 0.0);
}

TEST(Options, ShadeIsATextOrAnObject) {
  const auto shade = [](const char* json) { return FormatInspection(ParsedOptions(json).inspection); };
  EXPECT_EQ(shade("{}"), "studio");
  EXPECT_EQ(shade(R"({"shade":"zebra:stripes=7"})"), "zebra:stripes=7,axis=z");
  EXPECT_EQ(shade(R"({"shade":{"name":"zebra","stripes":7,"axis":[1,0,0.5]}})"),
            "zebra:stripes=7,axis=1,0,0.5");
  EXPECT_EQ(shade(R"({"shade":{"name":"curvature","kind":"max","range":[-1,2]}})"),
            "curvature:kind=max,range=-1..2");
  EXPECT_THAT(OptionsMessage(R"({"shade":"tiger"})"),
              HasSubstr("there is no \"tiger\"; there are studio, zebra"));
  EXPECT_THAT(OptionsMessage(R"({"shade":{"name":"zebra","bands":7}})"), HasSubstr("stripes and axis"));
  EXPECT_THAT(OptionsMessage(R"({"shade":{"stripes":7}})"), HasSubstr("an object with a name"));
  EXPECT_THAT(OptionsMessage(R"({"shade":{"name":"zebra","axis":"z,stripes=9"}})"),
              HasSubstr("an object with a name"));
  EXPECT_THAT(OptionsMessage(R"({"shade":3})"), HasSubstr("must be a string"));
}

TEST(Options, ThatAreWrongNameThemselvesAndWhatIsAllowed) {
  EXPECT_THAT(OptionsMessage(R"({"colour":1})"),
              HasSubstr("there is no option \"colour\" (did you mean color?); the options are view, camera"));
  EXPECT_THAT(OptionsMessage(R"({"view":"above"})"),
              HasSubstr("there is no view \"above\"; the views are front, back"));
  EXPECT_THAT(OptionsMessage(R"({"size":"10"})"), HasSubstr("WIDTHxHEIGHT"));
  EXPECT_THAT(OptionsMessage(R"({"size":"0x10"})"), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(OptionsMessage(R"({"size":"10x70000"})"), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(OptionsMessage(R"({"size":"10x10x10"})"), HasSubstr("WIDTHxHEIGHT"));
  EXPECT_THAT(OptionsMessage(R"({"size":[10,-1]})"), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(OptionsMessage(R"({"samples":7})"), HasSubstr("use one of 1 2 4 6 8 9 12"));
  EXPECT_THAT(OptionsMessage(R"({"samples":65})"), HasSubstr("from 1 to 64"));
  EXPECT_THAT(OptionsMessage(R"({"samples":2.5})"), HasSubstr("whole number"));
  EXPECT_THAT(OptionsMessage(R"({"precision":"exact"})"), HasSubstr("one of fast, standard, certified"));
  EXPECT_THAT(OptionsMessage(R"({"deflection":0})"), HasSubstr("a number from 1e-09 to 1"));
  EXPECT_THAT(OptionsMessage(R"({"deflection":"1e-3"})"), HasSubstr("a number from"));
  EXPECT_THAT(OptionsMessage(R"({"audit":1})"), HasSubstr("true or false"));
  EXPECT_THAT(OptionsMessage(R"({"aov":"curvature"})"), HasSubstr("there is no AOV \"curvature\""));
  EXPECT_THAT(OptionsMessage(R"({"fail_flip":-1})"), HasSubstr("at least 0"));
  EXPECT_THAT(OptionsMessage(R"({"deflection":1e-3,"deflection_mm":1})"),
              HasSubstr("either deflection or deflection_mm"));
  EXPECT_THAT(OptionsMessage(R"({"view":"iso","camera":{"eye":[1,2,3]}})"),
              HasSubstr("either view or camera"));
  EXPECT_THAT(OptionsMessage(R"({"deflection_mm":1,"deflection-mm":1})"), HasSubstr("given twice"));
  EXPECT_THAT(OptionsMessage(R"([])"), HasSubstr("JSON object"));
}

TEST(Options, NumbersThatAreWrongAreRepeatedAsTheyWereGiven) {
  const auto message = [](const char* text) { return ParseOptions(Json::parse(text)).error().message; };
  EXPECT_THAT(message(R"({"resolution":70000.0})"),
              HasSubstr("resolution is 70000, but must be a number from 2 to 65536"));
  EXPECT_THAT(message(R"({"resolution":2.5})"), HasSubstr("resolution is 2.5, but must be a whole number"));
  EXPECT_THAT(message(R"({"fraction":4.5})"), HasSubstr("fraction is 4.5, but must be a whole number"));
  EXPECT_THAT(message(R"({"pitch_mm":0})"),
              HasSubstr("pitch_mm is 0, but must be a number above 0, at most 1e+12"));
}

TEST(Options, VoxelsBesideTheMeshAreNumbersAndAnEncoding) {
  const RunOptions options =
      ParsedOptions(R"({"voxels":"64,256,runs","with":"fast,voxels:64","voxel_normals":"grid"})");
  EXPECT_EQ(options.voxel_look().encoding, "runs");
  EXPECT_EQ(options.voxel_look().normals, VoxelNormals::kGrid);
  std::vector<std::string> names;
  for (const MethodChoice& choice : options.MethodsBeside()) names.push_back(choice.Name());
  EXPECT_EQ(names, (std::vector<std::string>{"fast", "voxels-64", "voxels-256"}));
  EXPECT_EQ(ParsedOptions("{}").voxel_look().normals, VoxelNormals::kExact);
  for (const char* wrong : {R"({"voxels":"1"})", R"({"voxels":"65537"})", R"({"voxels":"2.5"})",
                            R"({"voxels":"runs"})", R"({"voxels":"runs,64"})", R"({"voxels":"64,mesh"})"})
    EXPECT_EQ(ParseOptions(Json::parse(wrong)).error().code, ErrorCode::kBadUsage) << wrong;
}

TEST(Options, SamplesMakeNearSquareGrids) {
  for (const int samples : {1, 2, 4, 6, 8, 9, 12, 16, 20, 25, 36, 64})
    EXPECT_EQ(ParsedOptions("{\"samples\":" + std::to_string(samples) + "}").samples, samples);
  for (const int samples : {3, 5, 7, 10, 11, 14, 26})
    EXPECT_NE(OptionsMessage("{\"samples\":" + std::to_string(samples) + "}"), "") << samples;
}

TEST(Cameras, AreNamedViewsOrGivenByNumbers) {
  auto named = ResolveCameras(ParsedOptions(R"({"view":["front","iso"],"size":"64x32"})"), kBounds);
  ASSERT_TRUE(named.ok()) << named.error().message;
  ASSERT_EQ(named.value().size(), 2u);
  EXPECT_EQ(named.value()[0].name, "front");
  EXPECT_EQ(named.value()[1].width_px, 64);

  auto given = ResolveCameras(
      ParsedOptions(
          R"({"camera":[{"eye":[100,0,0]},{"eye":[0,0,50],"name":"above","projection":"perspective","fov_y_deg":30}]})"),
      kBounds);
  ASSERT_TRUE(given.ok()) << given.error().message;
  ASSERT_EQ(given.value().size(), 2u);
  const Camera& side = given.value()[0];
  EXPECT_EQ(side.name, "camera");
  EXPECT_EQ(side.target.x, 0);
  EXPECT_EQ(side.up.z, 1);
  EXPECT_GE(side.height, kBounds.diagonal());
  // When the camera looks straight down, Z cannot be up.
  const Camera& above = given.value()[1];
  EXPECT_EQ(above.name, "above");
  EXPECT_EQ(above.up.y, 1);
  EXPECT_EQ(above.fov_y_deg, 30);
}

TEST(Cameras, OfAReportCanBeGivenBack) {
  auto views =
      ResolveCameras(ParsedOptions(R"({"view":"iso","size":"64x32","projection":"perspective"})"), kBounds);
  ASSERT_TRUE(views.ok());
  const Json json = CameraJson(views.value()[0]);
  RunOptions options;
  options.cameras = Json::array({json});
  auto again = ResolveCameras(options, kBounds);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(CameraJson(again.value()[0]), json);
}

TEST(Cameras, ThatAreWrongSayWhy) {
  const auto message = [](const std::string& camera) {
    auto options = ParseOptions(Json{{"camera", Json::parse(camera)}});
    if (!options) return options.error().message;
    auto cameras = ResolveCameras(options.value(), kBounds);
    return cameras.ok() ? std::string() : cameras.error().message;
  };
  EXPECT_THAT(message("{}"), HasSubstr("needs an \"eye\""));
  EXPECT_THAT(message("[]"), HasSubstr("empty list"));
  EXPECT_THAT(message("3"), HasSubstr("must be an object"));
  EXPECT_THAT(message(R"({"eye":[1,2]})"), HasSubstr("must be [x, y, z]"));
  EXPECT_THAT(message(R"({"eye":[1,2,3],"zoom":2})"), HasSubstr("a camera has no \"zoom\""));
  EXPECT_THAT(message(R"({"eye":[1,2,3],"name":"a/b"})"), HasSubstr("letters, digits"));
  EXPECT_THAT(message(R"({"eye":[1,2,3],"fov_y_deg":40})"), HasSubstr("no fov_y_deg"));
  EXPECT_NE(message(R"({"eye":[0,0,0]})"), "") << "the eye is the target";
  EXPECT_THAT(message(R"([{"eye":[1,2,3],"name":"a"},{"eye":[1,2,4],"name":"a"}])"),
              HasSubstr("two views are named a"));
}

}  // namespace
}  // namespace facetless
