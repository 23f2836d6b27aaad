// The model file: a model that is read back is equal to the one that was written, and no bytes make the
// reader crash or return an invalid model.
#include "render/model/model_file.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <utility>

#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

// A unit square face in the plane z = 0, bounded by four edges, and a quarter of a cylinder without loops.
Model TwoFaces() {
  ModelBuilder builder;
  ImportInfo& info = builder.info();
  info.file = "two.step";
  info.sha256 = std::string(64, 'a');
  info.format = "STEP AP214";
  info.unit = "inch";
  info.unit_mm = 25.4;
  info.faces_declared = 3;
  info.faces_imported = 2;
  info.faces_lost = {{kNoIndex, "lost", "#7", "no surface"}};
  info.loops_lost = {{0, "", "#8", "dropped"}};
  info.approximated = {{1, 1e-9}};
  info.healed = {{"part", "#8", "a loop does not close", 2, 1, 3, 4, 0.125}};
  info.warnings = {"Grüße", ""};
  info.read_ms = 1.5;
  info.peak_bytes = 1ull << 33;
  info.max_edge_gap_mm = 0.25;
  info.max_edge_gap_entity = "#8";
  builder.AddPart("part");
  builder.AddSolid(true, "body");
  // The square: one bilinear patch, four straight coedges.
  Face top;
  top.reversed = true;
  top.solid = 0;
  top.has_color = true;
  top.color = {1, 0.5f, 0};
  top.tolerance_mm = 1e-5;
  top.name = "top";
  top.entity = "#8";
  builder.AddFace({SurfaceKind::kPlane,
                   1,
                   1,
                   {{0, 1}},
                   {{0, 1}},
                   {{0, 0, 0, 1}, {0, 1, 0, 1}, {1, 0, 0, 1}, {1, 1, 0, 1}}},
                  top);
  builder.AddLoop();
  const Vec2 corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Vec2 a = corners[i], b = corners[(i + 1) % 4];
    builder.AddVertex({a.x, a.y, 0}, 1e-7);
    Edge edge;
    edge.vertices[0] = i;
    edge.vertices[1] = (i + 1) % 4;
    edge.tolerance_mm = 1e-7;
    edge.entity = "#" + std::to_string(20 + i);
    Coedge coedge;
    coedge.edge = builder.AddEdge(edge);
    coedge.from_file = true;
    coedge.gap_mm = 0.125 * i;
    builder.AddEdgeSegment(std::array{Vec4{a.x, a.y, 0, 1}, Vec4{b.x, b.y, 0, 1}});
    builder.AddCoedge(coedge);
    builder.AddTrimSegment(std::array{Vec3{a.x, a.y, 1}, Vec3{b.x, b.y, 1}});
  }
  // The cylinder: a rational quarter arc times a line.
  const double half = std::sqrt(0.5);
  SurfaceGrid cylinder{SurfaceKind::kCylinder,
                       2,
                       1,
                       {{0, std::numbers::pi / 2, SpanMap::kHalfAngle}},
                       {{-1, 1}},
                       {{1, 0, -1, 1},
                        {1, 0, 1, 1},
                        {half, half, -half, half},
                        {half, half, half, half},
                        {0, 1, -1, 1},
                        {0, 1, 1, 1}}};
  cylinder.extendable_u = true;
  cylinder.period_u = 2 * std::numbers::pi;
  builder.AddFace(cylinder);
  builder.AddPart("empty");
  Instance instance;
  instance.name = "a";
  builder.AddInstance(instance);
  Instance nothing;
  nothing.part = 1;
  nothing.name = "nothing";
  builder.AddInstance(nothing);
  Instance shifted;
  shifted.placement.m[1][3] = 5;
  shifted.has_color = true;
  shifted.color = {0, 1, 0};
  builder.AddInstance(shifted);
  return testing::Finished(std::move(builder));
}

TEST(ModelFile, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  const Model model = TwoFaces();
  const std::string path = folder.File("a.flm"), again = folder.File("b.flm");
  ASSERT_TRUE(WriteModel(model, path).ok());
  const Result<Model> read = ReadModel(path);
  ASSERT_TRUE(read.ok()) << read.error().message;
  // Check some elements of each kind, and then compare everything: the same model gives the same bytes.
  EXPECT_EQ(read.value().info.warnings[0], "Grüße");
  EXPECT_EQ(read.value().info.faces_lost[0].entity, "#7");
  EXPECT_EQ(read.value().info.peak_bytes, 1ull << 33);
  EXPECT_EQ(read.value().surfaces[1].kind, SurfaceKind::kCylinder);
  EXPECT_EQ(read.value().spans[2].map, SpanMap::kHalfAngle);
  EXPECT_EQ(read.value().edges[2].entity, "#22");
  EXPECT_EQ(read.value().coedges[3].gap_mm, 0.375);
  EXPECT_EQ(read.value().faces[0].color.g, 0.5f);
  EXPECT_TRUE(read.value().faces[0].reversed);
  EXPECT_EQ(read.value().instances[2].placement.m[1][3], 5);
  ASSERT_TRUE(WriteModel(read.value(), again).ok());
  std::ifstream a(path, std::ios::binary), b(again, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(a), {}),
            std::string(std::istreambuf_iterator<char>(b), {}));
}

TEST(ModelFile, NamesAndIndicesOfPlacedFaces) {
  const Model model = TwoFaces();
  ASSERT_EQ(model.PlacedFaceCount(), 4u);
  EXPECT_EQ(model.InstanceOfPlacedFace(1), 0u);
  EXPECT_EQ(model.InstanceOfPlacedFace(2), 2u);  // not the empty instance that starts there, too
  EXPECT_EQ(model.FaceOfPlacedFace(3), 1u);
  EXPECT_EQ(model.PlacedFaceName(0), "a/top #8");
  EXPECT_EQ(model.PlacedFaceName(3), "part/face 1");
  EXPECT_EQ(model.PlacedFaceColor(2).r, 1);     // the face's own colour
  EXPECT_EQ(model.PlacedFaceColor(3).g, 1);     // the instance's colour
  EXPECT_EQ(model.PlacedFaceColor(1).g, 0.7f);  // neither has a colour
}

TEST(ModelFile, RefusesWhatIsNoModelFile) {
  const TemporaryFolder folder;
  EXPECT_EQ(ReadModel(folder.File("absent")).error().code, ErrorCode::kFileUnreadable);
  for (const std::string& bytes :
       {std::string(), std::string("x"), std::string(1000, '\0'), std::string("ISO-10303-21;")}) {
    const std::string path = folder.File("other");
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_EQ(ReadModel(path).error().code, ErrorCode::kFormatUnknown);
  }
}

TEST(ModelFile, DamagedBytesGiveAnErrorOrAValidModel) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.flm"), damaged = folder.File("damaged.flm");
  ASSERT_TRUE(WriteModel(TwoFaces(), path).ok());
  std::ifstream in(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  const unsigned seed = 20260117;
  std::mt19937 random(seed);
  int errors = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string changed = bytes;
    // Cut the file, or change up to four bytes, both in offsets and in numbers.
    if (round % 10 == 0) {
      changed.resize(random() % bytes.size());
    } else {
      for (unsigned i = 0; i <= random() % 4; ++i)
        changed[random() % changed.size()] = static_cast<char>(random());
    }
    std::ofstream(damaged, std::ios::binary | std::ios::trunc) << changed;
    const Result<Model> read = ReadModel(damaged);
    if (read.ok()) {
      EXPECT_TRUE(Validate(read.value()).ok()) << "seed " << seed << ", round " << round;
    } else {
      ++errors;
    }
  }
  EXPECT_GT(errors, 1000);
}

TEST(ModelFile, WritesInFullOrNotAtAll) {
  const TemporaryFolder folder;
  EXPECT_EQ(WriteModel(TwoFaces(), folder.File("no/such/folder.flm")).error().code, ErrorCode::kWriteFailed);
  Model invalid = TwoFaces();
  invalid.control_points[0].w = 0;
  EXPECT_FALSE(WriteModel(invalid, folder.File("invalid.flm")).ok());
  EXPECT_FALSE(std::filesystem::exists(folder.File("invalid.flm")));
}

// Each violation is found. The message names the element and, for geometry, its face.
struct Violation {
  const char* what;
  void (*damage)(Model&);
  ErrorCode code;
  const char* message;
};

void PrintTo(const Violation& v, std::ostream* out) {
  *out << v.what;
}

class Validation : public ::testing::TestWithParam<Violation> {};

TEST_P(Validation, FindsIt) {
  Model model = TwoFaces();
  ASSERT_TRUE(Validate(model).ok()) << Validate(model).error().message;
  GetParam().damage(model);
  const Result<void> result = Validate(model);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, GetParam().code);
  EXPECT_NE(result.error().message.find(GetParam().message), std::string::npos) << result.error().message;
}

const double kNan = std::nan("");

INSTANTIATE_TEST_SUITE_P(
    Laws, Validation,
    ::testing::Values(
        Violation{"surface", [](Model& m) { m.faces[1].surface = 9; }, ErrorCode::kFormatBroken, "faces[1]"},
        Violation{"loop", [](Model& m) { m.faces[0].loops.count = 2; }, ErrorCode::kFormatBroken, "faces[0]"},
        Violation{"overflow",
                  [](Model& m) {
                    m.loops[0].coedges = {2, 0xffffffffu};
                  },
                  ErrorCode::kFormatBroken, "loops[0]"},
        Violation{"span order", [](Model& m) { m.spans[0].end = -1; }, ErrorCode::kFormatBroken, "faces[0]"},
        Violation{"half turn", [](Model& m) { m.spans[2].end = 3.2; }, ErrorCode::kFormatBroken,
                  "half a turn"},
        Violation{"nan point", [](Model& m) { m.control_points[5].x = kNan; }, ErrorCode::kNotFinite,
                  "control_points[5]"},
        Violation{"weight", [](Model& m) { m.control_points[6].w = 0; }, ErrorCode::kFormatBroken,
                  "not positive"},
        Violation{"weights",
                  [](Model& m) {
                    for (std::size_t i = m.surfaces[1].first_control_point; i < m.control_points.size(); ++i)
                      m.control_points[i] = 1e-260 * m.control_points[i];
                  },
                  ErrorCode::kFormatBroken, "scale them"},
        Violation{"polynomial", [](Model& m) { m.control_points[0].w = 2; }, ErrorCode::kFormatBroken,
                  "polynomial"},
        Violation{"gap", [](Model& m) { m.trim_points[3].x += 1e-9; }, ErrorCode::kFormatBroken, "(#8)"},
        Violation{"trim weight", [](Model& m) { m.trim_points[0].z = -1; }, ErrorCode::kFormatBroken,
                  "trim_points[0]"},
        Violation{"edge", [](Model& m) { m.coedges[1].edge = 4; }, ErrorCode::kFormatBroken, "coedges[1]"},
        Violation{"edge curve", [](Model& m) { m.edges[1].segments.count = 0; }, ErrorCode::kFormatBroken,
                  "edges[1]"},
        Violation{"edge nan", [](Model& m) { m.edge_points[1].z = kNan; }, ErrorCode::kNotFinite,
                  "edge_points[1]"},
        Violation{"solid", [](Model& m) { m.faces[0].solid = 1; }, ErrorCode::kFormatBroken, "faces[0]"},
        Violation{"dense", [](Model& m) { m.instances[2].first_placed_face = 3; }, ErrorCode::kFormatBroken,
                  "instances[2]"},
        Violation{"singular", [](Model& m) { m.instances[0].placement.m[0][0] = 0; },
                  ErrorCode::kFormatBroken, "singular"},
        Violation{"orphan", [](Model& m) { m.parts[0].faces.count = 1; }, ErrorCode::kFormatBroken, ""},
        Violation{"bounds", [](Model& m) { m.bounds = {}; }, ErrorCode::kFormatBroken, "bounds"},
        Violation{"degree", [](Model& m) { m.surfaces[0].degree_u = 26; }, ErrorCode::kFormatBroken,
                  "degree"},
        Violation{"points", [](Model& m) { m.surfaces[1].first_control_point = 5; }, ErrorCode::kFormatBroken,
                  "control points"}),
    [](const auto& info) {
      std::string name = info.param.what;
      for (char& c : name) c = c == ' ' ? '_' : c;
      return name;
    });

TEST(ErrorCodes, HaveStableNames) {
  EXPECT_STREQ(ErrorCodeName(ErrorCode::kBadUsage), "bad-usage");
  EXPECT_STREQ(ErrorCodeName(ErrorCode::kImporterCrashed), "importer-crashed");
  EXPECT_STREQ(SurfaceKindName(SurfaceKind::kBspline), "bspline");
}

}  // namespace
}  // namespace facetless
