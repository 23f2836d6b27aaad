// Section planes in the notation of the options.
#include "server/options/section_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace facetless {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

SectionPlane Resolved(const Json& json, const Box3& bounds = {{-10, 0, 100}, {30, 8, 200}}) {
  auto requests = ParseSections(json);
  EXPECT_TRUE(requests.ok()) << requests.error().message;
  auto planes = ResolveSections(requests.value(), bounds);
  EXPECT_TRUE(planes.ok()) << planes.error().message;
  return planes.value().at(0);
}

std::string MessageOf(const Json& json) {
  const auto requests = ParseSections(json);
  return requests.ok() ? "" : requests.error().message;
}

void ExpectPlane(const SectionPlane& plane, Vec3 point, Vec3 normal) {
  EXPECT_NEAR(Length(plane.point - point), 0, 1e-12);
  EXPECT_NEAR(Length(plane.normal - normal), 0, 1e-15);
}

TEST(SectionOptions, TakeAPointAndANormalOfAnyLength) {
  ExpectPlane(Resolved("1,2,3,0,0,5"), {1, 2, 3}, {0, 0, 1});
  ExpectPlane(Resolved("1, 2, 3, 0, -3e-200, 0"), {1, 2, 3}, {0, -1, 0});
  ExpectPlane(Resolved(Json::array({1, 2, 3, 1, 0, 0})), {1, 2, 3}, {1, 0, 0});
  ExpectPlane(Resolved({{"point", {1, 2, 3}}, {"normal", {0, 3, 4}}}), {1, 2, 3}, {0, 0.6, 0.8});
}

TEST(SectionOptions, TakeAPlaneAcrossAnAxis) {
  ExpectPlane(Resolved("z=12.5"), {0, 0, 12.5}, {0, 0, 1});
  ExpectPlane(Resolved("-x=-3"), {-3, 0, 0}, {-1, 0, 0});
  ExpectPlane(Resolved("x=50%"), {10, 0, 0}, {1, 0, 0});
  ExpectPlane(Resolved("-z=25%"), {0, 0, 125}, {0, 0, -1});
}

TEST(SectionOptions, TakeAListOfAnyOfThem) {
  const auto requests = ParseSections(Json::array({"z=1", Json::array({1, 2, 3, 0, 0, 1}), "0,0,0,1,0,0"}));
  ASSERT_TRUE(requests.ok());
  EXPECT_EQ(requests.value().size(), 3u);
  EXPECT_EQ(ParseSections(Json::array()).value().size(), 0u);
}

TEST(SectionOptions, ThatAreNoPlaneSayWhatIs) {
  for (const char* wrong : {"", "1,2,3", "1,2,3,4,5,6,7", "1,2,3,0,0,x", "w=3", "z=", "z=%", "z=1e999",
                            "1,2,3,0,0,inf", "1,2,3,0,0,nan", "--z=1", "z=5,"})
    EXPECT_THAT(MessageOf(wrong), HasSubstr("must be x,y,z,nx,ny,nz")) << wrong;
  EXPECT_THAT(MessageOf("1,2,3,0,0,0"), HasSubstr("normal is zero"));
  EXPECT_THAT(MessageOf("z=101%"), HasSubstr("from 0% to 100%"));
  EXPECT_THAT(MessageOf(7), HasSubstr("must be"));
  EXPECT_THAT(MessageOf({{"point", {1, 2, 3}}}), HasSubstr("must be"));
  EXPECT_THAT(MessageOf({{"point", {1, 2}}, {"normal", {0, 0, 0, 1}}}), HasSubstr("must be"));
  EXPECT_THAT(MessageOf(Json(std::vector<std::string>(17, "z=1"))), HasSubstr("16 are allowed"));
}

TEST(SectionOptions, AtAShareOfNothingAreRefused) {
  EXPECT_FALSE(ResolveSections(ParseSections("z=50%").value(), {}).ok());
  EXPECT_TRUE(ResolveSections(ParseSections("z=50").value(), {}).ok());
}

}  // namespace
}  // namespace facetless
