// Which occurrences of an assembly are shown, and where.
#include "render/view/arrangement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ModelOf;
using testing::Sphere;

Placement At(Vec3 p) {
  Placement placement;
  placement.m[0][3] = p.x;
  placement.m[1][3] = p.y;
  placement.m[2][3] = p.z;
  return placement;
}

// Balls of radius 1 at the given places. The part has two faces.
Model Balls(const std::vector<std::pair<std::string, Vec3>>& places) {
  ModelBuilder builder;
  builder.AddPart("part");
  for (const double radius : {1.0, 0.5}) builder.AddFace(Sphere({0, 0, 0}, radius));
  for (const auto& [name, at] : places) {
    Instance ball;
    ball.name = name;
    ball.placement = At(at);
    builder.AddInstance(ball);
  }
  return testing::Finished(std::move(builder));
}

// The model's mesh: one node per instance. The triangles do not matter.
Mesh MeshOf(const Model& model) {
  Mesh mesh;
  mesh.parts.resize(model.parts.size());
  mesh.from_model = true;
  for (const Instance& instance : model.instances)
    mesh.nodes.push_back({instance.part, instance.placement, instance.first_placed_face});
  return mesh;
}

std::string MessageOf(const Model& model, const ArrangementRequest& request) {
  const Result<Arrangement> arrangement = Arrange(model, request);
  if (arrangement.ok()) return "";
  EXPECT_EQ(arrangement.error().code, ErrorCode::kBadUsage);
  return arrangement.error().message;
}

TEST(NameMatches, PiecesAnywhereAndPatternsAsAWhole) {
  EXPECT_TRUE(NameMatches("bolt", "upper flange/Bolt 3"));
  EXPECT_TRUE(NameMatches("FLANGE/bolt", "upper flange/Bolt 3"));
  EXPECT_FALSE(NameMatches("bolt", "nut"));
  EXPECT_TRUE(NameMatches("*bolt*", "upper flange/bolt 3"));
  EXPECT_FALSE(NameMatches("bolt*", "upper flange/bolt 3")) << "a pattern is for the whole name";
  EXPECT_TRUE(NameMatches("*/bolt ?", "upper flange/bolt 3"));
  EXPECT_FALSE(NameMatches("*/bolt ?", "upper flange/bolt 12"));
  EXPECT_TRUE(NameMatches("R?der", "Räder")) << "the question mark must match a character, not a byte";
  EXPECT_TRUE(NameMatches("*a*b*c", "abcabc"));
  EXPECT_FALSE(NameMatches("*a*b*c", "abcab"));
  EXPECT_TRUE(NameMatches("*", ""));
}

TEST(Arrange, ShowsWhatMatchesAndIsNotHidden) {
  const Model model = Balls(
      {{"left/wheel", {0, 0, 0}}, {"left/bolt", {5, 0, 0}}, {"right/wheel", {9, 0, 0}}, {"", {20, 0, 0}}});
  EXPECT_THAT(Arrange(model, ArrangementRequest{{"wheel"}, {}, 0}).value().shown, ElementsAre(0, 2));
  EXPECT_THAT(Arrange(model, ArrangementRequest{{"wheel", "left/*"}, {}, 0}).value().shown,
              ElementsAre(0, 1, 2));
  EXPECT_THAT(Arrange(model, ArrangementRequest{{}, {"wheel"}, 0}).value().shown, ElementsAre(1, 3));
  EXPECT_THAT(Arrange(model, ArrangementRequest{{"wheel"}, {"left"}, 0}).value().shown, ElementsAre(2));
  EXPECT_EQ(OccurrenceName(model, 3), model.parts[0].name) << "the occurrence has no name";
  Model nameless = model;
  nameless.parts[0].name.clear();
  EXPECT_EQ(OccurrenceName(nameless, 3), "part 1");
}

TEST(Arrange, SaysWhichNamesThereAre) {
  const Model model = Balls({{"wheel", {0, 0, 0}}, {"wheel", {5, 0, 0}}, {"bolt", {9, 0, 0}}});
  EXPECT_EQ(MessageOf(model, ArrangementRequest{{"wheel", "whel"}, {}, 0}),
            "--parts: no part's name matches \"whel\"; there are wheel, bolt");
  EXPECT_THAT(MessageOf(model, ArrangementRequest{{}, {"x*"}, 0}), HasSubstr("--hide"));
  EXPECT_THAT(MessageOf(model, ArrangementRequest{{}, {"wheel", "bolt"}, 0}),
              HasSubstr("nothing to be shown"));
  std::vector<std::pair<std::string, Vec3>> many;
  for (int i = 0; i < 40; ++i) many.push_back({std::string(200, 'n') + std::to_string(i), {3.0 * i, 0, 0}});
  const std::string message = MessageOf(Balls(many), ArrangementRequest{{"q"}, {}, 0});
  EXPECT_LT(message.size(), 1000u);
  EXPECT_THAT(message, HasSubstr("and 28 more"));
  EXPECT_THAT(message, HasSubstr("n11 and")) << "the ends of long names must be shown";
}

TEST(Arranged, KeepsModelAndMeshAlikeWithDenseFaces) {
  const Model model = Balls({{"a", {0, 0, 0}}, {"b", {5, 0, 0}}, {"c", {20, 0, 0}}});
  const Arrangement arrangement = Arrange(model, ArrangementRequest{{}, {"b"}, 1}).value();
  const Model arranged = Arranged(model, arrangement);
  ASSERT_TRUE(Validate(arranged).ok()) << Validate(arranged).error().message;
  EXPECT_EQ(arranged.PlacedFaceCount(), 4u);
  EXPECT_THAT(arranged.PlacedFaceName(2), HasSubstr("c/"));
  // Their centre is at 10, so now they are at −10 and 30.
  EXPECT_EQ(arranged.instances[0].placement.m[0][3], -10);
  EXPECT_EQ(arranged.instances[1].placement.m[0][3], 30);
  EXPECT_NEAR(arranged.bounds.low.x, -11, 0.01);
  EXPECT_NEAR(arranged.bounds.high.x, 31, 0.01);
  EXPECT_EQ(arranged.faces.size(), model.faces.size()) << "prototypes stay";

  const Mesh mesh = Arranged(MeshOf(model), model, arrangement).value();
  ASSERT_EQ(mesh.nodes.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(mesh.nodes[i].first_placed_face, arranged.instances[i].first_placed_face);
    EXPECT_EQ(mesh.nodes[i].placement.m[0][3], arranged.instances[i].placement.m[0][3]);
  }
  Mesh foreign = MeshOf(model);
  foreign.from_model = false;
  EXPECT_FALSE(Arranged(foreign, model, arrangement).ok());
}

TEST(Arrange, WithoutAnyWishChangesNothing) {
  const Model model = Balls({{"a", {0, 0, 0}}, {"b", {5, 0, 0}}});
  EXPECT_FALSE(ArrangementRequest{}.ChangesAnything(model));
  const Model arranged = Arranged(model, Arrange(model, {}).value());
  EXPECT_EQ(arranged.instances.size(), 2u);
  EXPECT_EQ(arranged.instances[1].placement.m[0][3], 5);
}

TEST(Arrange, LeavesOutWhatTheFileHidesUnlessAsked) {
  Model model = Balls({{"a", {0, 0, 0}}, {"b", {5, 0, 0}}});
  model.instances[1].hidden = true;
  EXPECT_TRUE(ArrangementRequest{}.ChangesAnything(model));
  EXPECT_EQ(Arrange(model, {}).value().shown, std::vector<std::uint32_t>{0});
  ArrangementRequest all;
  all.show_hidden = true;
  EXPECT_FALSE(all.ChangesAnything(model));
  EXPECT_EQ(Arrange(model, all).value().shown.size(), 2u);
  ArrangementRequest only_hidden;
  only_hidden.parts = {"b"};
  const auto nothing = Arrange(model, only_hidden);
  ASSERT_FALSE(nothing.ok());
  EXPECT_THAT(nothing.error().message, HasSubstr("--show-hidden"));
}

RC_GTEST_PROP(Arrange, ExplodedNothingChangesItsOrderAndNoGapShrinks, ()) {
  const int factor = *rc::gen::inRange(1, 40);
  std::vector<std::pair<std::string, Vec3>> places;
  const int count = *rc::gen::inRange(2, 8);
  for (int i = 0; i < count; ++i)
    places.push_back(
        {"ball",
         {static_cast<double>(*rc::gen::inRange(-50, 50)), static_cast<double>(*rc::gen::inRange(-50, 50)),
          static_cast<double>(*rc::gen::inRange(-50, 50))}});
  const Model model = Balls(places);
  const Arrangement arrangement = Arrange(model, ArrangementRequest{{}, {}, 0.25 * factor}).value();
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < count; ++b) {
      const Vec3 before = places[b].second - places[a].second;
      const Vec3 after = before + arrangement.shifts[b] - arrangement.shifts[a];
      for (const auto& [was, is] : {std::pair{before.x, after.x}, {before.y, after.y}, {before.z, after.z}}) {
        // The tolerance is the rounding of positions below 2000 mm.
        constexpr double kRounding = 1e-9;
        const bool kept = was < 0 ? is < was + kRounding : is > was - kRounding;
        RC_ASSERT(kept);
      }
    }
}

}  // namespace
}  // namespace facetless
