// Materials: how they are written, and which faces get them.
#include "render/shade/material.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

TEST(Material, IsReadAndWritten) {
  EXPECT_TRUE(rc::check("any glass, any name", [] {
    const double ior = *rc::gen::inRange(1000, 4001) / 1000.0;
    const std::string name = "a=b " + std::to_string(*rc::gen::arbitrary<int>());
    const MaterialRule rule = ParseMaterial(FormatMaterial({name, {MaterialKind::kGlass, ior}})).value();
    RC_ASSERT(rule.pattern == name);
    RC_ASSERT(rule.material.kind == MaterialKind::kGlass);
    RC_ASSERT(rule.material.ior == ior);
  }));
  EXPECT_EQ(ParseMaterial("x=metal").value().material.kind, MaterialKind::kMetal);
  EXPECT_EQ(ParseMaterial("x=mirror").value().material.kind, MaterialKind::kMirror);
  EXPECT_EQ(ParseMaterial("*=matte").value().material.kind, MaterialKind::kMatte);
  EXPECT_EQ(ParseMaterial("x=glass").value().material.ior, 1.5);
  for (const char* wrong : {"", "glass", "=glass", "x=", "x=wood", "x=glass:", "x=glass:0.9", "x=glass:4.1",
                            "x=glass:nan", "x=glass:1.5mm", "x=metal:2"})
    EXPECT_EQ(ParseMaterial(wrong).error().code, ErrorCode::kBadUsage) << wrong;
}

TEST(Material, TheLastRuleThatMatchesCounts) {
  const Model model = testing::ClosedSolid(testing::ModelOf({testing::Sphere({0, 0, 0}, 5)}), "ball");
  const std::string name = model.PlacedFaceName(0);
  const MaterialRule rules[] = {{"*", {MaterialKind::kMirror}}, {"*", {MaterialKind::kGlass, 1.2}}};
  const std::vector<Material> materials = MaterialsOfFaces(model, rules).value();
  ASSERT_EQ(materials.size(), model.PlacedFaceCount());
  for (const Material& one : materials) {
    EXPECT_EQ(one.kind, MaterialKind::kGlass);
    EXPECT_EQ(one.ior, 1.2);
  }
  EXPECT_EQ(MaterialsOfFaces(model, {}).value()[0].kind, MaterialKind::kMatte);
}

TEST(Material, APatternThatMatchesNothingIsAnError) {
  const Model model = testing::ClosedSolid(testing::ModelOf({testing::Sphere({0, 0, 0}, 5)}));
  const MaterialRule rule{"no such part", {MaterialKind::kMirror}};
  const Result<std::vector<Material>> materials = MaterialsOfFaces(model, std::span(&rule, 1));
  EXPECT_EQ(materials.error().code, ErrorCode::kBadUsage);
  EXPECT_NE(materials.error().message.find("no such part"), std::string::npos);
}

TEST(Material, GlassNeedsAClosedSolid) {
  const Model open = testing::Squares(1);
  const MaterialRule glass{"*", {MaterialKind::kGlass}}, mirror{"*", {MaterialKind::kMirror}};
  EXPECT_EQ(MaterialsOfFaces(open, std::span(&glass, 1)).error().code, ErrorCode::kBadUsage);
  EXPECT_TRUE(MaterialsOfFaces(open, std::span(&mirror, 1)).ok());
}

}  // namespace
}  // namespace facetless
