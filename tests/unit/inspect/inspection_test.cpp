// The text of --shade: valid values, and the messages for invalid ones.
#include "render/inspect/inspection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace facetless {
namespace {

using ::testing::HasSubstr;

Inspection Parsed(const std::string& text) {
  const Result<Inspection> parsed = ParseInspection(text);
  EXPECT_TRUE(parsed.ok()) << text << ": " << (parsed.ok() ? "" : parsed.error().message);
  return parsed.ok() ? parsed.value() : Inspection{};
}

std::string Refusal(const std::string& text) {
  const Result<Inspection> parsed = ParseInspection(text);
  if (parsed.ok()) return "accepted";
  EXPECT_EQ(parsed.error().code, ErrorCode::kBadUsage);
  return parsed.error().message;
}

TEST(InspectionText, EveryNameStandsAloneAndComesBack) {
  for (const std::string& name : InspectionNames()) {
    const Inspection inspection = Parsed(name);
    EXPECT_EQ(InspectionNames()[static_cast<std::size_t>(inspection.kind)], name);
    const std::string text = FormatInspection(inspection);
    EXPECT_EQ(FormatInspection(Parsed(text)), text);
  }
}

TEST(InspectionText, SettingsAreReadAndComeBack) {
  for (const char* text :
       {"zebra:stripes=7,axis=-y", "zebra:stripes=24,axis=1,0.5,-2", "isophotes:bands=16,light=toward",
        "reflection:lines=3,direction=up", "curvature:kind=gaussian,range=-0.25..0.25", "curvature:kind=min",
        "draft:direction=0,1,1,limit=1.5", "thickness:range=0.5..4", "unseen:pixels=1"})
    EXPECT_EQ(FormatInspection(Parsed(text)), text);
}

TEST(InspectionText, ADirectionKeepsItsCommas) {
  const Inspection inspection = Parsed("draft:direction=0,3,4,limit=2");
  EXPECT_EQ(inspection.direction.vector.y, 3);
  EXPECT_EQ(inspection.limit_deg, 2);
  EXPECT_FALSE(inspection.direction.of_view);
  EXPECT_TRUE(Parsed("zebra:axis=right").direction.of_view);
}

TEST(InspectionText, ARefusalNamesWhatIsAllowed) {
  EXPECT_THAT(Refusal("tiger"), HasSubstr("zebra"));
  EXPECT_THAT(Refusal(""), HasSubstr("studio"));
  EXPECT_THAT(Refusal("zebra:bands=3"), HasSubstr("stripes and axis"));
  EXPECT_THAT(Refusal("zebra:stripes=1"), HasSubstr("from 2 to 1000"));
  EXPECT_THAT(Refusal("zebra:stripes=2.5"), HasSubstr("whole number"));
  EXPECT_THAT(Refusal("zebra:axis=0,0,0"), HasSubstr("direction"));
  EXPECT_THAT(Refusal("zebra:axis=0,0"), HasSubstr("X,Y,Z"));
  EXPECT_THAT(Refusal("zebra:axis=nan,0,1"), HasSubstr("X,Y,Z"));
  EXPECT_THAT(Refusal("zebra:24"), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(Refusal("curvature:kind=big"), HasSubstr("gaussian, mean, max, min"));
  EXPECT_THAT(Refusal("curvature:range=1..0"), HasSubstr("LOW..HIGH"));
  EXPECT_THAT(Refusal("thickness:range=1"), HasSubstr("LOW..HIGH"));
  EXPECT_THAT(Refusal("draft:limit=90"), HasSubstr("between 0 and 90"));
  EXPECT_THAT(Refusal("faces:x=1"), HasSubstr("no settings"));
}

TEST(InspectionText, SaysWhatAMeshCannotShow) {
  for (const std::string& name : InspectionNames()) {
    const bool exact_only = name == "curvature" || name == "thickness";
    EXPECT_EQ(CheckMeshCanShow(Parsed(name), true).ok(), !exact_only) << name;
    const bool needs_faces = name == "faces" || name == "unseen";
    EXPECT_EQ(CheckMeshCanShow(Parsed(name), false).ok(), !exact_only && !needs_faces) << name;
  }
}

}  // namespace
}  // namespace facetless
