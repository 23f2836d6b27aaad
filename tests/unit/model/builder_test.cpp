// The builder derives what follows from other data, and Finish() refuses everything that Validate() refuses.
#include "render/model/builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "render/model/walk.h"
#include "tests/support/shapes.h"
#include "tests/unit/model/random_structure.h"

namespace facetless {
namespace {

using ::testing::HasSubstr;
using testing::Rectangle;

constexpr Vec3 kBorder[5] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, 0, 1}};

// Adds a unit square with a border of four coedges, without a part or an instance.
void AddSquare(ModelBuilder& builder) {
  builder.AddFace(Rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  builder.AddLoop();
  for (int i = 0; i < 4; ++i) {
    builder.AddCoedge({});
    builder.AddTrimSegment({kBorder + i, 2});
  }
}

ModelBuilder Square() {
  ModelBuilder builder;
  builder.AddPart("square");
  AddSquare(builder);
  builder.AddInstance({});
  return builder;
}

Instance At(std::uint32_t part, double x) {
  Instance instance;
  instance.part = part;
  instance.placement.m[0][3] = x;
  return instance;
}

TEST(ModelBuilder, GivesEveryElementToItsOwner) {
  ModelBuilder builder;
  EXPECT_EQ(builder.AddPart("first"), 0u);
  AddSquare(builder);
  AddSquare(builder);
  EXPECT_EQ(builder.AddSolid(true, "body"), 0u);
  EXPECT_EQ(builder.AddPart("empty"), 1u);
  EXPECT_EQ(builder.AddPart("last"), 2u);
  EXPECT_EQ(builder.AddFace(Rectangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0})), 2u);
  EXPECT_EQ(builder.AddSolid(false), 1u);
  EXPECT_EQ(builder.AddInstance(At(2, 0)), 0u);
  const Model model = testing::Finished(std::move(builder));
  const auto expect = [](Range range, std::uint32_t first, std::uint32_t count) {
    EXPECT_EQ(range.first, first);
    EXPECT_EQ(range.count, count);
  };
  expect(model.parts[0].faces, 0, 2);
  expect(model.parts[0].solids, 0, 1);
  expect(model.parts[1].faces, 2, 0);
  expect(model.parts[1].solids, 1, 0);
  expect(model.parts[2].faces, 2, 1);
  expect(model.parts[2].solids, 1, 1);
  EXPECT_EQ(model.solids[0].part, 0u);
  EXPECT_EQ(model.solids[0].name, "body");
  EXPECT_TRUE(model.solids[0].closed);
  EXPECT_EQ(model.solids[1].part, 2u);
  expect(model.faces[1].loops, 1, 1);
  expect(model.faces[2].loops, 2, 0);
  expect(model.loops[1].coedges, 4, 4);
  expect(model.coedges[5].segments, 5, 1);
  EXPECT_EQ(model.trim_segments[5].first_point, 10u);
  EXPECT_EQ(model.trim_segments[5].degree, 1);
  EXPECT_EQ(model.faces[2].surface, 2u);
  expect(model.surfaces[2].u_spans, 4, 1);
  expect(model.surfaces[2].v_spans, 5, 1);
  EXPECT_EQ(model.surfaces[2].first_control_point, 8u);
}

TEST(ModelBuilder, NumbersPlacedFacesWithoutGaps) {
  ModelBuilder builder = Square();  // its instance comes before the other parts exist
  builder.AddPart("empty");
  builder.AddPart("two");
  for (const double x : {0.0, 1.0}) builder.AddFace(Rectangle({x, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  for (const std::uint32_t part : {2u, 1u, 0u, 2u}) {
    Instance instance = At(part, 0);
    instance.first_placed_face = 77;
    builder.AddInstance(instance);
  }
  const Model model = testing::Finished(std::move(builder));
  std::vector<std::uint32_t> firsts;
  for (const Instance& instance : model.instances) firsts.push_back(instance.first_placed_face);
  EXPECT_EQ(firsts, (std::vector<std::uint32_t>{0, 1, 3, 3, 4}));
  EXPECT_EQ(model.PlacedFaceCount(), 6u);
}

TEST(ModelBuilder, CountsCoedgesAndSeesWeights) {
  ModelBuilder builder;
  builder.AddPart("");
  Edge edge;
  edge.coedge_count = 9;
  builder.AddEdge(edge);
  builder.AddEdgeSegment(std::array{Vec4{0, 0, 0, 1}, Vec4{1, 0, 0, 1}, Vec4{2, 0, 0, 1}}, 3, 5);
  builder.AddFace(testing::Sphere({0, 0, 0}, 1));
  testing::PatchGrid flat = Rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  builder.AddFace(flat);
  flat.rational = true;
  builder.AddFace(flat);
  builder.AddLoop();
  for (int i = 0; i < 4; ++i) {
    Coedge coedge;
    if (i % 2 == 0) coedge.edge = 0;
    builder.AddCoedge(coedge);
    builder.AddTrimSegment({kBorder + i, 2}, i, i + 1);
  }
  const Model model = testing::Finished(std::move(builder));
  EXPECT_EQ(model.edges[0].coedge_count, 2u);
  EXPECT_EQ(model.edges[0].segments.count, 1u);
  EXPECT_EQ(model.edge_segments[0].degree, 2);
  EXPECT_EQ(model.edge_segments[0].begin, 3);
  EXPECT_EQ(model.edge_segments[0].end, 5);
  EXPECT_EQ(model.trim_segments[2].edge_begin, 2);
  EXPECT_EQ(model.trim_segments[2].edge_end, 3);
  EXPECT_TRUE(model.surfaces[0].rational);
  EXPECT_FALSE(model.surfaces[1].rational);
  EXPECT_TRUE(model.surfaces[2].rational) << "as it was said";
}

TEST(ModelBuilder, BoundsHoldWhatIsPlacedAndItsGaps) {
  ModelBuilder builder;
  builder.AddPart("shown");
  builder.AddFace(Rectangle({0, 0, 0}, {1, 0, 0}, {0, 2, 0}));
  builder.AddLoop();
  for (int i = 0; i < 4; ++i) {
    Coedge coedge;
    coedge.gap_mm = i == 2 ? 0.5 : 0;
    builder.AddCoedge(coedge);
    builder.AddTrimSegment({kBorder + i, 2});
  }
  builder.AddPart("not placed");
  builder.AddFace(Rectangle({0, 0, 1000}, {1, 0, 0}, {0, 1, 0}));
  builder.AddInstance(At(0, -10));
  builder.AddInstance(At(0, 20));
  ModelBuilder said = builder;
  const Model model = testing::Finished(std::move(builder));
  EXPECT_EQ(model.bounds.low.x, -10.5);
  EXPECT_EQ(model.bounds.high.x, 21.5);
  EXPECT_EQ(model.bounds.low.y, -0.5);
  EXPECT_EQ(model.bounds.high.y, 2.5);
  EXPECT_EQ(model.bounds.low.z, -0.5);
  EXPECT_EQ(model.bounds.high.z, 0.5);
  said.SetBounds({{-1, -2, -3}, {4, 5, 6}});
  EXPECT_EQ(testing::Finished(std::move(said)).bounds.high.z, 6);
}

TEST(ModelBuilder, OfNothingIsAnEmptyModel) {
  const Model model = testing::Finished(ModelBuilder());
  EXPECT_EQ(model.PlacedFaceCount(), 0u);
  EXPECT_TRUE(model.bounds.empty());
}

RC_GTEST_PROP(ModelBuilder, GoesOnWhereAModelEnds, (std::uint64_t seed)) {
  const Model model = testing::RandomStructure(seed);
  ModelBuilder builder(model);
  if (model.faces.empty() || model.parts.back().faces.count == 0) builder.AddPart("more");
  AddSquare(builder);
  Instance again;
  again.part = static_cast<std::uint32_t>(builder.model().parts.size()) - 1;
  builder.AddInstance(again);
  builder.SetBounds({{0, 0, 0}, {100, 100, 100}});
  const Model longer = testing::Finished(std::move(builder));
  RC_ASSERT(longer.faces.size() == model.faces.size() + 1);
  RC_ASSERT(longer.parts.back().faces.end() == longer.faces.size());
  RC_ASSERT(longer.PlacedFaceCount() >= model.PlacedFaceCount() + longer.parts.back().faces.count);
  std::size_t coedges = 0;
  for (const Coedge& coedge : CoedgesOf(longer, longer.faces.back())) coedges += coedge.segments.count;
  RC_ASSERT(coedges == 4u);
}

// A case that Finish() refuses, and its message.
struct Refusal {
  const char* name;
  std::function<void(ModelBuilder&)> add;  // applied to a square
  ErrorCode code;
  const char* sentence;
};

class ModelBuilderRefuses : public ::testing::TestWithParam<Refusal> {};

TEST_P(ModelBuilderRefuses, WithASentence) {
  ModelBuilder builder = Square();
  GetParam().add(builder);
  const Result<Model> model = std::move(builder).Finish();
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(model.error().code, GetParam().code);
  EXPECT_THAT(model.error().message, HasSubstr(GetParam().sentence));
}

testing::PatchGrid Changed(const std::function<void(testing::PatchGrid&)>& change) {
  testing::PatchGrid grid = Rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  change(grid);
  return grid;
}

std::function<void(ModelBuilder&)> WithSurface(const std::function<void(testing::PatchGrid&)>& change) {
  return [=](ModelBuilder& builder) { builder.AddFace(Changed(change)); };
}

using Points = std::vector<Vec4>;
constexpr ErrorCode kBroken = ErrorCode::kFormatBroken;

INSTANTIATE_TEST_SUITE_P(
    Models, ModelBuilderRefuses,
    ::testing::Values(
        Refusal{"OpenLoop",
                [](ModelBuilder& b) {
                  b.AddLoop();
                  b.AddCoedge({});
                  b.AddTrimSegment({kBorder, 2});
                },
                kBroken, "does not end where the next one starts"},
        Refusal{"EmptyLoop", [](ModelBuilder& b) { b.AddLoop(); }, kBroken, "its coedges are out of range"},
        Refusal{"EmptyCoedge",
                [](ModelBuilder& b) {
                  b.AddLoop();
                  b.AddCoedge({});
                },
                kBroken, "its segments are out of range"},
        Refusal{"NoSuchEdge",
                [](ModelBuilder& b) {
                  b.AddLoop();
                  Coedge coedge;
                  coedge.edge = 3;
                  b.AddCoedge(coedge);
                },
                kBroken, "its edge is out of range"},
        Refusal{"EdgeWithoutACurve", [](ModelBuilder& b) { b.AddEdge({}); }, kBroken,
                "it must have a curve unless it is degenerate"},
        Refusal{"NoSuchVertex",
                [](ModelBuilder& b) {
                  Edge edge;
                  edge.vertices[0] = 5;
                  b.AddEdge(edge);
                  b.AddEdgeSegment(Points(2, {0, 0, 0, 1}));
                },
                kBroken, "a vertex is out of range"},
        Refusal{"EdgeRunsBackwards",
                [](ModelBuilder& b) {
                  b.AddEdge({});
                  b.AddEdgeSegment(Points(2, {0, 0, 0, 1}), 1, 0);
                },
                kBroken, "its parameter does not increase"},
        Refusal{"EdgeOfTooManyPoints",
                [](ModelBuilder& b) {
                  b.AddEdge({});
                  b.AddEdgeSegment(Points(258, {0, 0, 0, 1}));
                },
                kBroken, "its degree is not 1"},
        Refusal{"EdgeOfNoPoints",
                [](ModelBuilder& b) {
                  b.AddEdge({});
                  b.AddEdgeSegment(Points());
                },
                kBroken, "its degree is not 1"},
        Refusal{"VertexNowhere",
                [](ModelBuilder& b) {
                  b.AddVertex({NAN, 0, 0});
                },
                ErrorCode::kNotFinite, "vertices[0]"},
        Refusal{"SurfaceOfDegree0", WithSurface([](testing::PatchGrid& g) {
                  g.degree_u = 0;
                  g.points.resize(2);
                }),
                kBroken, "its degree is not 1"},
        Refusal{"SpansThatDecrease", WithSurface([](testing::PatchGrid& g) {
                  g.u_spans = {{1, 0}};
                }),
                kBroken, "does not increase"},
        Refusal{"SpansApart", WithSurface([](testing::PatchGrid& g) {
                  g.u_spans = {{0, 1}, {2, 3}};
                  g.points.resize(8, {0, 0, 0, 1});
                }),
                kBroken, "does not abut"},
        Refusal{"PointsThatAreMissing", WithSurface([](testing::PatchGrid& g) { g.points.pop_back(); }),
                ErrorCode::kBadUsage,
                "The surface of faces[1] has 3 control points; its spans and degrees need 4."},
        Refusal{"PointNowhere", WithSurface([](testing::PatchGrid& g) { g.points[2].x = INFINITY; }),
                ErrorCode::kNotFinite, "control_points[6]"},
        Refusal{"NegativeWeight", WithSurface([](testing::PatchGrid& g) { g.points[2].w = -1; }), kBroken,
                "a weight that is not positive"},
        Refusal{"NoSuchSolid", [](ModelBuilder& b) { b.SetSolid(0, 4); }, kBroken, "its solid"},
        Refusal{"SolidOfAnotherPart",
                [](ModelBuilder& b) {
                  b.AddPart("other");
                  b.SetSolid(0, b.AddSolid(true));
                },
                kBroken, "its solid belongs to another part"},
        Refusal{"NoSuchPart", [](ModelBuilder& b) { b.AddInstance(At(7, 0)); }, kBroken,
                "its part is out of range"},
        Refusal{"SingularPlacement",
                [](ModelBuilder& b) {
                  Instance flat;
                  flat.placement.m[2][2] = 0;
                  b.AddInstance(flat);
                },
                kBroken, "its placement is singular"},
        Refusal{"LossOfNoFace", [](ModelBuilder& b) { b.info().loops_lost = {{9, "", "", ""}}; }, kBroken,
                "a loss names a face out of range"},
        Refusal{"EmptyBounds", [](ModelBuilder& b) { b.SetBounds({}); }, kBroken,
                "they are empty or infinite"},
        // The point divided by its weight is infinite, although no bound of the sums is.
        Refusal{"InfiniteBounds", WithSurface([](testing::PatchGrid& g) {
                  for (Vec4& p : g.points) p = {1e300, 1e300, 1e300, 1e-200};
                }),
                kBroken, "they are empty or infinite"}),
    [](const auto& test) { return test.param.name; });

// Elements without an owner.
class ModelBuilderMisused : public ::testing::TestWithParam<Refusal> {};

TEST_P(ModelBuilderMisused, NamesWhatComesFirst) {
  ModelBuilder builder;
  GetParam().add(builder);
  const Result<Model> model = std::move(builder).Finish();
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(model.error().code, GetParam().code);
  EXPECT_EQ(model.error().message, GetParam().sentence);
}

constexpr ErrorCode kUsage = ErrorCode::kBadUsage;

INSTANTIATE_TEST_SUITE_P(
    Models, ModelBuilderMisused,
    ::testing::Values(
        Refusal{"Face", [](ModelBuilder& b) { AddSquare(b); }, kUsage,
                "The model has a face that was added before a part: add a part first."},
        Refusal{"Solid", [](ModelBuilder& b) { b.AddSolid(true); }, kUsage,
                "The model has a solid that was added before a part: add a part first."},
        Refusal{"Loop", [](ModelBuilder& b) { b.AddLoop(); }, kUsage,
                "The model has a loop that was added before a face: add a face first."},
        Refusal{"Coedge", [](ModelBuilder& b) { b.AddCoedge({}); }, kUsage,
                "The model has a coedge that was added before a loop: add a loop first."},
        Refusal{"TrimSegment",
                [](ModelBuilder& b) {
                  b.AddTrimSegment({kBorder, 2});
                },
                kUsage, "The model has a trim segment that was added before a coedge: add a coedge first."},
        Refusal{"EdgeSegment", [](ModelBuilder& b) { b.AddEdgeSegment(Points(2)); }, kUsage,
                "The model has an edge segment that was added before an edge: add an edge first."}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace facetless
