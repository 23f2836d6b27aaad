// Mesh files: units, axes, hierarchy, our own files bit for bit, and files with wrong declarations.
#include "render/baseline/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/files.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/baseline/meshes.h"

namespace facetless {
namespace {

using nlohmann::json;
using testing::TriangleFile;

Result<Mesh> Load(const std::string& bytes, const MeshLoadOptions& options = {},
                  const Model* model = nullptr) {
  const TemporaryFolder folder;
  return LoadMesh(folder.Write("mesh", bytes), options, model);
}

ErrorCode CodeOf(const std::string& bytes) {
  const Result<Mesh> mesh = Load(bytes);
  EXPECT_FALSE(mesh.ok());
  return mesh.ok() ? ErrorCode::kInternal : mesh.error().code;
}

Vec3 Corner(const Mesh& mesh, std::size_t node, std::size_t triangle, int k) {
  const MeshPart& part = mesh.parts[mesh.nodes[node].part];
  const auto& p = part.positions[part.triangles[triangle][k]];
  return mesh.nodes[node].placement.Point({p[0], p[1], p[2]});
}

void ExpectPoint(Vec3 a, Vec3 b, double tolerance = 0) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Gltf, MetresAndYUpBecomeMillimetresAndZUp) {
  const Result<Mesh> mesh = Load(TriangleFile().Bytes());
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  ASSERT_EQ(PlacedTriangleCount(mesh.value()), 1u);
  ExpectPoint(Corner(mesh.value(), 0, 0, 1), {1000, 0, 0});
  ExpectPoint(Corner(mesh.value(), 0, 0, 2), {0, 0, 1000});
  EXPECT_FALSE(mesh.value().from_model);
}

TEST(Gltf, UnitAndUpAxisCanBeOverridden) {
  const Result<Mesh> mesh = Load(TriangleFile().Bytes(), {.unit = "in", .up = "z"});
  ASSERT_TRUE(mesh.ok());
  ExpectPoint(Corner(mesh.value(), 0, 0, 1), {25.4, 0, 0});
  ExpectPoint(Corner(mesh.value(), 0, 0, 2), {0, 25.4, 0});
  EXPECT_EQ(Load(TriangleFile().Bytes(), {.unit = "furlong"}).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(Load(TriangleFile().Bytes(), {.up = "x"}).error().code, ErrorCode::kBadUsage);
}

TEST(Gltf, NodesMultiplyParentFirstAndAMatrixEqualsItsParts) {
  TriangleFile file;
  file.json["nodes"] = {
      {{"children", {1}}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}},
      {{"mesh", 0}, {"scale", {2, 2, 2}}}};
  const Result<Mesh> parts = Load(file.Bytes(), {.unit = "mm", .up = "z"});
  ASSERT_TRUE(parts.ok());
  // A quarter turn around Z takes the corner (1,0,0), scaled to (2,0,0), to (0,2,0).
  ExpectPoint(Corner(parts.value(), 0, 0, 1), {1, 4, 3}, 1e-15);

  file.json["nodes"] = {{{"children", {1}}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}}},
                        {{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}}}};
  const Result<Mesh> matrices = Load(file.Bytes(), {.unit = "mm", .up = "z"});
  ASSERT_TRUE(matrices.ok());
  for (int k = 0; k < 3; ++k)
    ExpectPoint(Corner(parts.value(), 0, 0, k), Corner(matrices.value(), 0, 0, k), 1e-14);
}

TEST(Gltf, OurOwnFileComesBackBitForBit) {
  TriangleFile file;
  // The file is as the importer writes it: the root node transforms millimetres, Z up, into metres, Y up.
  file.json["asset"]["extras"] = {{"from_model", true},
                                  {"deflection_mm", 0.25},
                                  {"angular_deg", 20.0},
                                  {"mesh_ms", 7.5},
                                  {"faces_unmeshed", {"part/face #12"}}};
  file.json["meshes"][0]["primitives"][0]["extras"] = {{"face", 3}};
  file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 1;  // the same vectors serve as normals
  const double x = 1234567.1, y = -0.1, z = 3e-7;
  file.json["nodes"] = {
      {{"children", {1}}, {"matrix", {1e-3, 0, 0, 0, 0, 0, -1e-3, 0, 0, 1e-3, 0, 0, 0, 0, 0, 1}}},
      {{"mesh", 0},
       {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, x, y, z, 1}},
       {"extras", {{"first_placed_face", 40}}}}};
  const Result<Mesh> mesh = Load(file.Bytes());
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  const Mesh& m = mesh.value();
  EXPECT_TRUE(m.from_model);
  EXPECT_EQ(m.deflection_mm, 0.25);
  EXPECT_EQ(m.angular_deg, 20);
  EXPECT_EQ(m.mesh_ms, 7.5);
  EXPECT_EQ(m.faces_unmeshed, std::vector<std::string>{"part/face #12"});
  EXPECT_EQ(m.nodes[0].first_placed_face, 40u);
  EXPECT_EQ(m.parts[0].face_of_triangle[0], 3u);
  const double expected[3][4] = {{0, -1, 0, x}, {1, 0, 0, y}, {0, 0, 1, z}};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) EXPECT_EQ(m.nodes[0].placement.m[r][c], expected[r][c]) << r << c;
  ASSERT_EQ(m.parts[0].positions.size(), 3u);
  EXPECT_EQ(m.parts[0].positions[1], (std::array<float, 3>{1, 0, 0}));
}

TEST(Gltf, AMeshOfAnotherModelIsForeign) {
  TriangleFile file;
  file.json["asset"]["extras"] = {{"from_model", true}};
  file.json["meshes"][0]["primitives"][0]["extras"] = {{"face", 3}};
  file.json["nodes"][0]["extras"] = {{"first_placed_face", 0}};
  const Model model = testing::Squares(2);
  const Result<Mesh> other = Load(file.Bytes(), {}, &model);
  ASSERT_TRUE(other.ok());
  EXPECT_FALSE(other.value().from_model) << "face 3 of a part of two faces";
  file.json["meshes"][0]["primitives"][0]["extras"] = {{"face", 1}};
  const Result<Mesh> own = Load(file.Bytes(), {}, &model);
  ASSERT_TRUE(own.ok());
  EXPECT_TRUE(own.value().from_model);
}

TEST(Gltf, StripsAndFansKeepTheOrientation) {
  TriangleFile file;
  // A square 0 1 / 2 3 in the plane z = 0: both triangles of the strip, and of the fan, turn the same way.
  const float square[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  file.bin.assign(reinterpret_cast<const char*>(square), sizeof square);
  file.json["buffers"][0]["byteLength"] = sizeof square;
  file.json["bufferViews"] = {{{"buffer", 0}, {"byteLength", sizeof square}}};
  file.json["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}}};
  for (int mode : {5, 6}) {
    file.json["meshes"][0]["primitives"] = {{{"attributes", {{"POSITION", 0}}}, {"mode", mode}}};
    const Result<Mesh> mesh = Load(file.Bytes(), {.unit = "mm", .up = "z"});
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    ASSERT_EQ(PlacedTriangleCount(mesh.value()), 2u);
    if (mode == 6) continue;  // this square is not a convex fan
    for (std::size_t t = 0; t < 2; ++t) {
      const Vec3 a = Corner(mesh.value(), 0, t, 0), b = Corner(mesh.value(), 0, t, 1),
                 c = Corner(mesh.value(), 0, t, 2);
      EXPECT_GT(Cross(b - a, c - a).z, 0) << t;
    }
  }
}

TEST(Gltf, RefusesByNameWhatItDoesNotRead) {
  const auto message = [](const auto& change) {
    TriangleFile file;
    change(file.json);
    const Result<Mesh> mesh = Load(file.Bytes());
    EXPECT_FALSE(mesh.ok());
    return mesh.ok() ? std::string() : mesh.error().message;
  };
  EXPECT_NE(
      message([](json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }).find("KHR_draco"),
      std::string::npos);
  EXPECT_NE(message([](json& j) {
              j["accessors"][1]["sparse"] = {{"count", 1},
                                             {"indices", {{"bufferView", 0}, {"componentType", 5123}}},
                                             {"values", {{"bufferView", 1}}}};
            }).find("sparse"),
            std::string::npos);
  EXPECT_NE(message([](json& j) { j["accessors"][1]["componentType"] = 5122; }).find("quantised"),
            std::string::npos);
  EXPECT_NE(message([](json& j) { j["buffers"][0]["uri"] = "/etc/passwd"; }), "");
}

TEST(Gltf, RefusesFilesThatLie) {
  const auto broken = [](const auto& change) {
    TriangleFile file;
    change(file);
    return CodeOf(file.Bytes());
  };
  const auto kBroken = ErrorCode::kFormatBroken;
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["accessors"][1]["count"] = 4; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["accessors"][1]["count"] = 4294967295u; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["accessors"][1]["byteOffset"] = 1; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["bufferViews"][1]["byteOffset"] = 40; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["bufferViews"][1]["buffer"] = 7; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["bufferViews"][1]["byteStride"] = 4; }), kBroken);
  EXPECT_EQ(
      broken([](TriangleFile& f) { f.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; }),
      kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["meshes"][0]["primitives"][0]["indices"] = 1; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.bin[0] = 3; }), kBroken) << "vertex 3 of 3";
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["nodes"][0]["mesh"] = 5; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["scenes"][0]["nodes"] = {3}; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["nodes"][0]["children"] = {0}; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["nodes"][0]["rotation"] = {0, 0, 0, 0}; }), kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) {
              f.json["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
            }),
            kBroken);
  EXPECT_EQ(broken([](TriangleFile& f) {
              const float nan = std::numeric_limits<float>::quiet_NaN();
              std::memcpy(&f.bin[12], &nan, 4);
            }),
            ErrorCode::kNotFinite);
  EXPECT_EQ(broken([](TriangleFile& f) {
              f.json["nodes"][0]["translation"] = {1e308, 1e308, 0};
            }),
            ErrorCode::kNotFinite);
  EXPECT_EQ(broken([](TriangleFile& f) {
              f.json["nodes"][0]["scale"] = {0, 0, 0};
            }),
            ErrorCode::kNothingUsable);
  EXPECT_EQ(broken([](TriangleFile& f) { f.json["nodes"][0].erase("mesh"); }), ErrorCode::kNothingUsable);
}

TEST(Gltf, ASmallFileCannotDescribeAHugeMesh) {
  TriangleFile file;
  json primitives = json::array();
  for (int i = 0; i < 1000; ++i) primitives.push_back(file.json["meshes"][0]["primitives"][0]);
  file.json["meshes"][0]["primitives"] = primitives;
  MeshLoadOptions options;
  options.max_memory_bytes = 3 * 24 + 1000 * 16 - 1;
  EXPECT_EQ(Load(file.Bytes(), options).error().code, ErrorCode::kLimitExceeded);
  options.max_memory_bytes += 1;
  EXPECT_TRUE(Load(file.Bytes(), options).ok());
}

TEST(Gltf, DeepJsonIsRefusedBeforeItIsParsed) {
  TriangleFile file;
  json deep = 0;
  for (int i = 0; i < 2000; ++i) deep = json::array({std::move(deep)});
  file.json["extras"] = std::move(deep);
  EXPECT_EQ(CodeOf(file.Bytes()), ErrorCode::kLimitExceeded);
}

TEST(Gltf, AnyCutAndAnyChangedByteGivesAMeshOrAnError) {
  const std::string bytes = TriangleFile().Bytes();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Result<Mesh> mesh = Load(bytes.substr(0, length));
    EXPECT_FALSE(mesh.ok()) << length;
  }
  EXPECT_TRUE(rc::check("changed bytes", [&] {
    std::string changed = bytes;
    const int changes = *rc::gen::inRange(1, 6);
    for (int i = 0; i < changes; ++i)
      changed[*rc::gen::inRange<std::size_t>(0, changed.size())] =
          static_cast<char>(*rc::gen::inRange(0, 256));
    const Result<Mesh> mesh = Load(changed);
    if (!mesh.ok()) {
      RC_ASSERT(!mesh.error().message.empty());
      return;
    }
    for (const MeshPart& part : mesh.value().parts) {
      RC_ASSERT(part.normals.size() == part.positions.size());
      RC_ASSERT(part.face_of_triangle.size() == part.triangles.size());
      for (const auto& triangle : part.triangles)
        for (std::uint32_t vertex : triangle) RC_ASSERT(vertex < part.positions.size());
    }
  }));
}

TEST(MeshFile, SaysWhatItCannotRead) {
  EXPECT_EQ(LoadMesh("/nowhere/mesh.glb", {}, nullptr).error().code, ErrorCode::kFileUnreadable);
  EXPECT_EQ(LoadMesh("/tmp", {}, nullptr).error().code, ErrorCode::kFileUnreadable);
  EXPECT_EQ(CodeOf(""), ErrorCode::kFormatUnknown);
  EXPECT_EQ(CodeOf("ISO-10303-21; HEADER;"), ErrorCode::kFormatUnknown);
  MeshLoadOptions small;
  small.max_file_bytes = 10;
  EXPECT_EQ(Load(TriangleFile().Bytes(), small).error().code, ErrorCode::kLimitExceeded);
}

// Returns a binary STL file with one triangle per three corners.
std::string BinaryStl(const std::vector<std::array<float, 9>>& triangles) {
  std::string bytes(80, ' ');
  const std::uint32_t count = static_cast<std::uint32_t>(triangles.size());
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& corners : triangles) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(corners.data()), 36);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST(Stl, BinaryAndTextAreMillimetresAndZUp) {
  const std::string text =
      "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1.5 0 0\nvertex 0 2.5 "
      "0\nendloop\nendfacet\nendsolid one\n";
  for (const std::string& bytes : {BinaryStl({{0, 0, 0, 1.5, 0, 0, 0, 2.5, 0}}), text,
                                   BinaryStl({{0, 0, 0, 1.5, 0, 0, 0, 2.5, 0}}) + "trailing"}) {
    const Result<Mesh> mesh = Load(bytes);
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    ASSERT_EQ(PlacedTriangleCount(mesh.value()), 1u);
    const Box3 bounds = MeshBounds(mesh.value());
    ExpectPoint(bounds.high, {1.5, 2.5, 0});
    EXPECT_EQ(mesh.value().parts[0].normals[0], (std::array<float, 3>{0, 0, 1}));
  }
}

TEST(Stl, TextMayHoldSeveralSolidsInAnyCaseAndSpacing) {
  const std::string facet =
      "FACET NORMAL 1.#QNAN 0 -nan OUTER LOOP VERTEX +1 0 0\r\n\tVertex 1E0 2.5e-1 0 vertex 0 1 1e-60 "
      "endLoop "
      "endfacet\r\n";
  const Result<Mesh> mesh =
      Load("  solid first one\r\n" + facet + facet + "endsolid\nsolid\n" + facet + "endsolid second");
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_EQ(PlacedTriangleCount(mesh.value()), 3u);
  ExpectPoint(MeshBounds(mesh.value()).high, {1, 1, 0});
}

TEST(Stl, TextThatIsBrokenIsNamedWithItsLine) {
  const std::string start = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const auto message = [&](const std::string& end) { return Load(start + end).error().message; };
  EXPECT_THAT(message("vertex 0 one 0\n"), ::testing::HasSubstr("line 6: a number is expected, not 'one'"));
  EXPECT_THAT(message("endloop"),
              ::testing::HasSubstr("line 6: 'vertex', three in each facet, is expected, not 'endloop'"));
  EXPECT_THAT(message("vertex 0 1 0\nvertex 1 1 0\n"), ::testing::HasSubstr("line 7: 'endloop' is expected"));
  EXPECT_THAT(message("vertex 0 1 0\nendloop\nendfacet\n"), ::testing::HasSubstr("cut off; export it again"));
  EXPECT_EQ(Load(start + "vertex 0 1e99 0\nendloop\nendfacet\nendsolid").error().code, ErrorCode::kNotFinite);
}

TEST(Stl, BrokenFilesGiveErrors) {
  const std::string sound = BinaryStl({{0, 0, 0, 1, 0, 0, 0, 1, 0}});
  EXPECT_EQ(CodeOf(sound.substr(0, sound.size() - 1)), ErrorCode::kFormatUnknown);
  EXPECT_EQ(CodeOf(BinaryStl({})), ErrorCode::kNothingUsable);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(CodeOf(BinaryStl({{nan, 0, 0, 1, 0, 0, 0, 1, 0}})), ErrorCode::kNotFinite);
  EXPECT_FALSE(Load("solid x\nfacet normal 0 0").ok());
  EXPECT_FALSE(Load("solid x\nendsolid x\n").ok());
}

TEST(Stl, AnyChangedTextGivesAMeshOrAnError) {
  std::string text = "solid one\n";
  for (int i = 0; i < 3; ++i)
    text += "facet normal 0 0 1\n outer loop\n  vertex 0 0 " + std::to_string(i) +
            "\n  vertex 1e0 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
  text += "endsolid one\n";
  EXPECT_TRUE(rc::check("changed text", [&] {
    std::string changed = text.substr(0, *rc::gen::inRange<std::size_t>(10, text.size()));
    const int changes = *rc::gen::inRange(0, 6);
    for (int i = 0; i < changes; ++i)
      changed[*rc::gen::inRange<std::size_t>(0, changed.size())] =
          static_cast<char>(*rc::gen::inRange(0, 256));
    const Result<Mesh> mesh = Load(changed);
    if (!mesh.ok()) {
      RC_ASSERT(!mesh.error().message.empty());
    } else {
      RC_ASSERT(PlacedTriangleCount(mesh.value()) > 0u);
    }
  }));
}

TEST(CheckMeshSize, NamesTheUnitThatWouldFit) {
  Box3 model;
  model.Add({0, 0, 0});
  model.Add({100, 50, 20});
  const auto scaled = [&](double s) {
    Box3 box;
    box.Add({0, 0, 0});
    box.Add(s * model.high);
    return box;
  };
  const auto hint = [&](double ratio, double unit_mm) {
    const Result<void> size = CheckMeshSize(scaled(ratio), unit_mm, model);
    return size.ok() ? std::string("fits") : size.error().message;
  };
  EXPECT_EQ(hint(1, 1), "fits");
  EXPECT_EQ(hint(1.3, 1), "fits");
  EXPECT_EQ(hint(3, 1), "fits");
  EXPECT_NE(hint(1000, 1000).find("--mesh-unit mm"), std::string::npos);
  EXPECT_NE(hint(1.02e-3, 1).find("--mesh-unit m"), std::string::npos);
  EXPECT_NE(hint(1 / 25.4, 1).find("--mesh-unit in"), std::string::npos);
  EXPECT_NE(hint(1000 / 25.4, 1000).find("--mesh-unit in"), std::string::npos);
  EXPECT_NE(hint(0.1, 1).find("--mesh-unit cm"), std::string::npos);
  EXPECT_EQ(CheckMeshSize(scaled(1000), 1000, model).error().code, ErrorCode::kUnitMismatch);
  EXPECT_EQ(CheckMeshSize(Box3{}, 1, model).ok(), true);
}

TEST(CheckMeshSize, SeesExchangedAxes) {
  Box3 model, turned;
  model.Add({0, 0, 0});
  model.Add({100, 50, 20});
  turned.Add({0, -20, 0});
  turned.Add({100, 0, 50});
  const Result<void> size = CheckMeshSize(turned, 1, model);
  ASSERT_FALSE(size.ok());
  EXPECT_EQ(size.error().code, ErrorCode::kUnitMismatch);
  EXPECT_NE(size.error().message.find("--mesh-up"), std::string::npos);
}

TEST(PositionNoise, BoundsTheRoundingOfPositions) {
  EXPECT_TRUE(rc::check("rounding to float32", [] {
    const double size = *rc::gen::inRange(1, 1000000) / 7.0;
    MeshPart part;
    Vec3 exact;
    double worst = 0;
    for (int i = 0; i < 10; ++i) {
      exact = {size * *rc::gen::inRange(-1000, 1001) / 1000.0, size * *rc::gen::inRange(-1000, 1001) / 1000.0,
               size};
      const std::array<float, 3> stored = {static_cast<float>(exact.x), static_cast<float>(exact.y),
                                           static_cast<float>(exact.z)};
      part.positions.push_back(stored);
      worst = std::max(worst, Length(Vec3{stored[0], stored[1], stored[2]} - exact));
    }
    Mesh mesh = testing::OneNode(part);
    RC_ASSERT(PositionNoise(mesh) >= worst);
    RC_ASSERT(PositionNoise(mesh) <= 1.3e-7 * size);
  }));
}

TEST(RealMesh, TeapotAndCarAreRead) {
  if (CadFile("parts/utah_teapot.stl").empty() || CadFile("parts/car.glb").empty())
    GTEST_SKIP() << "FACETLESS_CAD names no folder with utah_teapot.stl and car.glb, which are not tested";
  const Result<Mesh> teapot = LoadMesh(CadFile("parts/utah_teapot.stl"), {}, nullptr);
  ASSERT_TRUE(teapot.ok()) << teapot.error().message;
  EXPECT_EQ(PlacedTriangleCount(teapot.value()), 9438u);
  const Result<Mesh> car = LoadMesh(CadFile("parts/car.glb"), {}, nullptr);
  ASSERT_TRUE(car.ok()) << car.error().message;
  EXPECT_EQ(PlacedTriangleCount(car.value()), 1828u);
  // The car is in glTF metres and stands on its wheels: it is longer than it is high, and higher than a
  // metre.
  const Vec3 size = MeshBounds(car.value()).high - MeshBounds(car.value()).low;
  EXPECT_GT(std::max(size.x, size.y), size.z);
  EXPECT_GT(size.z, 1000);
}

}  // namespace
}  // namespace facetless
