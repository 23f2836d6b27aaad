// Writing meshes: the file that is read back has the triangles, the volume, the orientation and the colours
// of the mesh that was written.
#include "render/baseline/mesh_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zip.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "render/baseline/mesh_file.h"
#include "render/baseline/mesh_topology.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/baseline/meshes.h"

namespace facetless {
namespace {

using nlohmann::json;
using testing::BoxMesh;

// A box of 1 × 2 × 3 mm with a red face, placed twice: unchanged, and mirrored at twice the size. In the
// second placement, faces without a colour are green.
struct Boxes {
  Model model;
  Mesh mesh;

  // Returns a model with the given number of faces in one solid, placed twice.
  Model Placed(int faces) const {
    ModelBuilder builder;
    builder.info().file = "boxes.step";
    builder.AddPart(mesh.parts[0].name);
    builder.AddSolid(false);
    for (int f = 0; f < faces; ++f) {
      Face face;
      face.solid = 0;
      face.has_color = f == 2;
      if (face.has_color) face.color = {1, 0, 0};
      builder.AddFace(testing::Rectangle({double(f), 0, 0}, {1, 0, 0}, {0, 1, 0}), face);
    }
    Instance instance;
    instance.name = "first box";
    builder.AddInstance(instance);
    instance.name = "mirrored";
    instance.placement = {{{-2, 0, 0, 100}, {0, 2, 0, 0.1}, {0, 0, 2, -7}}};
    instance.has_color = true;
    instance.color = {0, 0.5f, 0};
    builder.AddInstance(instance);
    return testing::Finished(std::move(builder));
  }

  Boxes() {
    mesh.parts.push_back(BoxMesh({1, 2, 3}));
    mesh.parts[0].name = "box <\"&\"> \x1b";
    mesh.from_model = true;
    mesh.deflection_mm = 0.5;
    for (std::uint32_t& face : mesh.parts[0].face_of_triangle) face = std::min(face, 5u);
    model = Placed(6);
    mesh.nodes = {{0, model.instances[0].placement, 0}, {0, model.instances[1].placement, 6}};
    model.bounds = MeshBounds(mesh);
  }

  std::string Encode(MeshFormat format) const {
    auto files = EncodeMesh(mesh, model, format, "boxes");
    EXPECT_TRUE(files.ok()) << files.error().message;
    return files.ok() ? files.value().back().bytes : "";
  }
};
constexpr double kVolume = 6 * (1 + 8), kArea = 22 * (1 + 4);

struct Triangle {
  Vec3 corners[3];
  std::string color;
};

// Returns the signed volume; it is positive if the normals point outwards.
double VolumeOf(const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles) sum += Dot(t.corners[0], Cross(t.corners[1], t.corners[2])) / 6;
  return sum;
}

double AreaOf(const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles)
    sum += Length(Cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) / 2;
  return sum;
}

std::map<std::string, int> PlacedFaceColors(const std::vector<Triangle>& triangles) {
  std::map<std::string, int> counts;
  for (const Triangle& t : triangles) ++counts[t.color];
  return counts;
}
// 0.7, 0.7, 0.72 is the default colour.
const std::map<std::string, int> kColors = {{"ff0000", 4}, {"b3b3b8", 10}, {"008000", 10}};

std::vector<Triangle> Placed(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const MeshNode& node : mesh.nodes)
    for (const auto& t : mesh.parts[node.part].triangles) {
      Triangle triangle;
      for (int k = 0; k < 3; ++k) {
        const auto& p = mesh.parts[node.part].positions[t[k]];
        triangle.corners[node.placement.Determinant() < 0 ? 2 - k : k] =
            node.placement.Point({p[0], p[1], p[2]});
      }
      triangles.push_back(triangle);
    }
  return triangles;
}

void ExpectBoxes(const std::vector<Triangle>& triangles) {
  EXPECT_EQ(triangles.size(), 24u);
  EXPECT_NEAR(VolumeOf(triangles), kVolume, 1e-3);
  EXPECT_NEAR(AreaOf(triangles), kArea, 1e-3);
}

TEST(MeshWriter, TheSuffixSaysTheFormatAndAnyOtherIsRefusedWithTheList) {
  EXPECT_EQ(MeshFormatFromPath("a/b.glb").value(), MeshFormat::kGlb);
  EXPECT_EQ(MeshFormatFromPath("b.STL").value(), MeshFormat::kStl);
  EXPECT_EQ(MeshFormatFromPath("b.x.obj").value(), MeshFormat::kObj);
  EXPECT_EQ(MeshFormatFromPath("b.3mf").value(), MeshFormat::k3mf);
  for (const char* wrong : {"b.ply", "b.gltf", "b", ".glb", "glb", "b.glb/"}) {
    const auto format = MeshFormatFromPath(wrong);
    ASSERT_FALSE(format.ok()) << wrong;
    EXPECT_EQ(format.error().code, ErrorCode::kBadUsage);
    EXPECT_THAT(format.error().message, ::testing::HasSubstr(".glb, .stl, .obj, .3mf"));
  }
}

TEST(MeshWriter, GlbComesBackBitForBitWithItsFaces) {
  Boxes boxes;
  const TemporaryFolder folder;
  const std::string bytes = boxes.Encode(MeshFormat::kGlb);
  const Result<Mesh> read = LoadMesh(folder.Write("boxes.glb", bytes), {}, &boxes.model);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(read.value().from_model);
  EXPECT_EQ(read.value().deflection_mm, 0.5);
  ExpectBoxes(Placed(read.value()));
  ASSERT_EQ(read.value().nodes.size(), 2u);
  for (int node = 0; node < 2; ++node) {
    EXPECT_EQ(read.value().nodes[node].first_placed_face, 6u * node);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        EXPECT_EQ(read.value().nodes[node].placement.m[row][column],
                  boxes.mesh.nodes[node].placement.m[row][column]);
    const MeshPart& part = read.value().parts[read.value().nodes[node].part];
    EXPECT_EQ(part.face_of_triangle, boxes.mesh.parts[0].face_of_triangle);
    for (std::size_t t = 0; t < part.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(part.positions[part.triangles[t][k]],
                  boxes.mesh.parts[0].positions[boxes.mesh.parts[0].triangles[t][k]]);
        EXPECT_EQ(part.normals[part.triangles[t][k]],
                  boxes.mesh.parts[0].normals[boxes.mesh.parts[0].triangles[t][k]]);
      }
  }

  // Colours are linear in the file. A face without a colour has that of the occurrence.
  std::uint32_t length = 0;
  std::copy_n(bytes.data() + 12, 4, reinterpret_cast<char*>(&length));
  const json gltf = json::parse(bytes.substr(20, length));
  std::map<std::string, int> faces;
  for (const json& mesh : gltf.at("meshes"))
    for (const json& primitive : mesh.at("primitives"))
      ++faces[gltf.at("materials").at(primitive.at("material").get<int>()).at("name").get<std::string>()];
  EXPECT_EQ(faces,
            (std::map<std::string, int>{{"color_ff0000", 2}, {"color_b3b3b8", 5}, {"color_008000", 5}}));
  for (const json& material : gltf.at("materials")) {
    if (material.at("name") != "color_008000") continue;
    const json& factor = material.at("pbrMetallicRoughness").at("baseColorFactor");
    EXPECT_NEAR(factor.at(1).get<double>(), 0.21586, 1e-5) << "128 of 255 in sRGB";
    EXPECT_EQ(factor.at(0).get<double>(), 0);
  }
  EXPECT_EQ(bytes.find('\x1b'), std::string::npos);
}

TEST(MeshWriter, StlIsBinaryAndKeepsTheOutsideOfMirroredPlacements) {
  Boxes boxes;
  const TemporaryFolder folder;
  const std::string bytes = boxes.Encode(MeshFormat::kStl);
  EXPECT_EQ(bytes.size(), 84u + 24 * 50);
  EXPECT_NE(bytes.substr(0, 5), "solid");
  const Result<Mesh> read = LoadMesh(folder.Write("boxes.stl", bytes), {}, &boxes.model);
  ASSERT_TRUE(read.ok()) << read.error().message;
  ExpectBoxes(Placed(read.value()));
  // The normals in the records must be those of the triangles.
  for (std::size_t record = 84; record < bytes.size(); record += 50) {
    float v[12];
    std::copy_n(bytes.data() + record, sizeof v, reinterpret_cast<char*>(v));
    const Vec3 a{v[3], v[4], v[5]}, b{v[6], v[7], v[8]}, c{v[9], v[10], v[11]};
    EXPECT_NEAR(Dot(Normalized(Cross(b - a, c - a)), {v[0], v[1], v[2]}), 1, 1e-6);
  }
}

TEST(MeshWriter, ObjHasColoursInASecondFileAndExactNormals) {
  Boxes boxes;
  auto files = EncodeMesh(boxes.mesh, boxes.model, MeshFormat::kObj, "two boxes");
  ASSERT_TRUE(files.ok());
  ASSERT_EQ(files.value().size(), 2u);
  EXPECT_EQ(files.value()[0].suffix, ".mtl");
  std::map<std::string, std::string> materials;
  std::istringstream mtl(files.value()[0].bytes);
  std::string word, name;
  while (mtl >> word) {
    if (word == "newmtl") mtl >> name;
    if (word != "Kd") continue;
    double rgb[3];
    mtl >> rgb[0] >> rgb[1] >> rgb[2];
    char hex[8];
    std::snprintf(hex, sizeof hex, "%02lx%02lx%02lx", std::lround(255 * rgb[0]), std::lround(255 * rgb[1]),
                  std::lround(255 * rgb[2]));
    materials[name] = hex;
  }

  std::vector<Vec3> positions, normals;
  std::vector<Triangle> triangles;
  std::string material, library;
  std::istringstream obj(files.value()[1].bytes);
  for (std::string line; std::getline(obj, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "mtllib") library = line.substr(7);
    if (word == "usemtl") words >> material;
    if (word == "v" || word == "vn") {
      Vec3 v;
      words >> v.x >> v.y >> v.z;
      (word == "v" ? positions : normals).push_back(v);
    }
    if (word != "f") continue;
    Triangle triangle;
    triangle.color = materials.at(material);
    std::size_t normal = 0;
    for (Vec3& corner : triangle.corners) {
      std::size_t index = 0;
      words >> index;
      words.ignore(2);
      words >> normal;
      corner = positions.at(index - 1);
    }
    const Vec3 own = Normalized(
        Cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]));
    EXPECT_NEAR(Dot(own, normals.at(normal - 1)), 1, 1e-6);
    triangles.push_back(triangle);
  }
  EXPECT_EQ(library, "two boxes.mtl");
  EXPECT_EQ(positions.size(), 16u) << "corners are shared by the faces";
  ExpectBoxes(triangles);
  EXPECT_EQ(PlacedFaceColors(triangles), kColors);
}

// Returns the content of the archive's entry `name`.
std::string Unzipped(const std::string& path, const char* name) {
  zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
  if (archive == nullptr) return "no archive";
  zip_stat_t stat;
  std::string text;
  if (zip_stat(archive, name, 0, &stat) == 0) {
    text.resize(stat.size);
    zip_file_t* file = zip_fopen(archive, name, 0);
    EXPECT_EQ(zip_fread(file, text.data(), text.size()), static_cast<zip_int64_t>(text.size()));
    zip_fclose(file);
  }
  zip_discard(archive);
  return text;
}

std::vector<double> NumbersOf(const std::string& text) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double number; words >> number;) numbers.push_back(number);
  return numbers;
}

TEST(MeshWriter, ThreeMfHasObjectsItemsAndColours) {
  Boxes boxes;
  const TemporaryFolder folder;
  const std::string bytes = boxes.Encode(MeshFormat::k3mf);
  EXPECT_EQ(bytes, boxes.Encode(MeshFormat::k3mf)) << "the same mesh gives the same bytes";
  const std::string path = folder.Write("boxes.3mf", bytes);
  EXPECT_THAT(Unzipped(path, "[Content_Types].xml"), ::testing::HasSubstr("3dmanufacturing-3dmodel+xml"));
  EXPECT_THAT(Unzipped(path, "_rels/.rels"), ::testing::HasSubstr("/3D/3dmodel.model"));
  const std::string text = Unzipped(path, "3D/3dmodel.model");
  EXPECT_THAT(text, ::testing::HasSubstr("unit=\"millimeter\""));
  EXPECT_THAT(text, ::testing::HasSubstr("name=\"box &lt;&quot;&amp;&quot;> \xef\xbf\xbd\""));

  // Read the elements in order: colours, objects, items.
  static const std::regex element(R"re(<(base|object|vertex|triangle|item) ([^>]*)>)re");
  static const std::regex attribute(R"re((\w+)="([^"]*)")re");
  std::vector<std::string> palette;
  struct Object {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::size_t, 4>> triangles;
  };
  std::map<std::string, Object> objects;
  Object* object = nullptr;
  std::vector<Triangle> placed;
  for (std::sregex_iterator i(text.begin(), text.end(), element), end; i != end; ++i) {
    const std::string kind = (*i)[1], rest = (*i)[2];
    std::map<std::string, std::string> values;
    for (std::sregex_iterator a(rest.begin(), rest.end(), attribute); a != end; ++a)
      values[(*a)[1]] = (*a)[2];
    if (kind == "base") palette.push_back(values.at("displaycolor").substr(1));
    if (kind == "object") object = &objects[values.at("id")];
    if (kind == "vertex")
      object->vertices.push_back(
          {std::stod(values.at("x")), std::stod(values.at("y")), std::stod(values.at("z"))});
    if (kind == "triangle")
      object->triangles.push_back({std::stoul(values.at("v1")), std::stoul(values.at("v2")),
                                   std::stoul(values.at("v3")), std::stoul(values.at("p1"))});
    if (kind != "item") continue;
    const std::vector<double> m = NumbersOf(values.at("transform"));
    ASSERT_EQ(m.size(), 12u);
    Placement placement;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) placement.m[row][column] = m[3 * column + row];
    EXPECT_GT(placement.Determinant(), 0) << "3MF wants no mirrors";
    const Object& shown = objects.at(values.at("objectid"));
    for (const auto& t : shown.triangles) {
      Triangle triangle;
      for (int k = 0; k < 3; ++k) triangle.corners[k] = placement.Point(shown.vertices.at(t[k]));
      triangle.color = palette.at(t[3]);
      placed.push_back(triangle);
    }
  }
  EXPECT_EQ(objects.begin()->second.vertices.size(), 8u) << "corners are shared by the faces";
  ExpectBoxes(placed);
  EXPECT_EQ(PlacedFaceColors(placed), kColors);
}

TEST(MeshWriter, OpacityIsCarried) {
  Boxes boxes;
  boxes.model.faces[2].color.a = 0.5f;
  const std::string glb = boxes.Encode(MeshFormat::kGlb);
  EXPECT_THAT(glb, ::testing::HasSubstr("\"alphaMode\":\"BLEND\""));
  EXPECT_THAT(glb, ::testing::HasSubstr("color_ff000080"));
  const auto obj = EncodeMesh(boxes.mesh, boxes.model, MeshFormat::kObj, "x");
  ASSERT_TRUE(obj.ok());
  EXPECT_THAT(obj.value()[0].bytes, ::testing::HasSubstr("newmtl color_ff000080\nKd 1 0 0\nd 0.5019608\n"));
  const TemporaryFolder folder;
  EXPECT_THAT(Unzipped(folder.Write("x.3mf", boxes.Encode(MeshFormat::k3mf)), "3D/3dmodel.model"),
              ::testing::HasSubstr("displaycolor=\"#ff000080\""));
}

TEST(MeshWriter, PlacementsThatLookAlikeShareAPart) {
  Boxes boxes;
  boxes.model.instances[1].has_color = false;
  boxes.model.instances[1].placement.m[0][0] = 2;
  boxes.mesh.nodes[1].placement = boxes.model.instances[1].placement;
  const TemporaryFolder folder;
  const Result<Mesh> read = LoadMesh(folder.Write("boxes.glb", boxes.Encode(MeshFormat::kGlb)), {}, nullptr);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read.value().parts.size(), 1u);
  const std::string text =
      Unzipped(folder.Write("boxes.3mf", boxes.Encode(MeshFormat::k3mf)), "3D/3dmodel.model");
  EXPECT_EQ(text.find("<object", text.find("<object") + 1), std::string::npos);
}

TEST(MeshWriter, AMeshOfAnotherModelIsRefused) {
  Boxes boxes;
  boxes.mesh.nodes[1].first_placed_face = 5;
  for (const MeshFormat format : {MeshFormat::kGlb, MeshFormat::kStl, MeshFormat::kObj, MeshFormat::k3mf})
    EXPECT_FALSE(EncodeMesh(boxes.mesh, boxes.model, format, "x").ok());
}

TEST(MeshTopology, ABoxIsWatertightInEveryPlacement) {
  Boxes boxes;
  const MeshTopology topology = MeasureTopology(boxes.mesh, boxes.model);
  EXPECT_EQ(topology.triangles, 24u);
  EXPECT_TRUE(topology.IsWatertight());
  EXPECT_EQ(TopologySentence(topology), "24 triangles; watertight");
}

TEST(MeshTopology, CountsOpenFlippedAndNonManifoldEdgesInEachPlacement) {
  Boxes open;
  open.mesh.parts[0].triangles.pop_back();
  open.mesh.parts[0].face_of_triangle.pop_back();
  EXPECT_EQ(MeasureTopology(open.mesh, open.model).open_edges, 6u);
  EXPECT_EQ(TopologySentence(MeasureTopology(open.mesh, open.model)),
            "22 triangles; not watertight: 6 open edges");

  Boxes flipped;
  std::swap(flipped.mesh.parts[0].triangles[0][0], flipped.mesh.parts[0].triangles[0][1]);
  EXPECT_EQ(MeasureTopology(flipped.mesh, flipped.model).flipped_edges, 6u);
  EXPECT_TRUE(MeasureTopology(flipped.mesh, flipped.model).IsWatertight());

  // Add a fin: one more triangle at an edge of the box, with a new corner.
  Boxes fin;
  MeshPart& part = fin.mesh.parts[0];
  part.positions.push_back({5, 5, 5});
  part.normals.push_back({0, 0, 1});
  part.triangles.push_back({part.triangles[0][0], part.triangles[0][1], 24});
  part.face_of_triangle.push_back(5);
  const MeshTopology topology = MeasureTopology(fin.mesh, fin.model);
  EXPECT_EQ(topology.non_manifold_edges, 2u);
  EXPECT_EQ(topology.open_edges, 4u);
}

TEST(MeshTopology, TriangleWithoutAreaLeavesNoHole) {
  Boxes boxes;
  MeshPart& part = boxes.mesh.parts[0];
  part.positions.push_back(part.positions[part.triangles[0][1]]);
  part.normals.push_back({0, 0, 1});
  part.triangles.push_back({part.triangles[0][1], part.triangles[0][0], 24});
  part.face_of_triangle.push_back(5);
  const MeshTopology topology = MeasureTopology(boxes.mesh, boxes.model);
  EXPECT_EQ(topology.collapsed, 2u);
  EXPECT_TRUE(topology.IsWatertight());
  EXPECT_THAT(TopologySentence(topology), ::testing::HasSubstr("and 2 without any area"));
}

TEST(MeshTopology, SolidsThatTouchStayTwo) {
  // Two boxes share a side: eight faces meet along its edges, and four triangles along its diagonal.
  Boxes boxes;
  MeshPart second = BoxMesh({1, 2, 3});
  MeshPart& part = boxes.mesh.parts[0];
  const auto base = static_cast<std::uint32_t>(part.positions.size());
  for (auto& p : second.positions) p[0] += 1;
  part.positions.insert(part.positions.end(), second.positions.begin(), second.positions.end());
  part.normals.insert(part.normals.end(), second.normals.begin(), second.normals.end());
  for (std::size_t t = 0; t < second.triangles.size(); ++t) {
    const auto& triangle = second.triangles[t];
    part.triangles.push_back({triangle[0] + base, triangle[1] + base, triangle[2] + base});
    part.face_of_triangle.push_back(6 + second.face_of_triangle[t]);
  }
  ModelBuilder builder(boxes.Placed(12));
  const std::uint32_t other = builder.AddSolid(false);
  for (std::uint32_t f = 6; f < 12; ++f) builder.SetSolid(f, other);
  boxes.model = testing::Finished(std::move(builder));
  boxes.mesh.nodes[1].first_placed_face = 12;
  EXPECT_TRUE(MeasureTopology(boxes.mesh, boxes.model).IsWatertight());
  for (Face& face : boxes.model.faces) face.solid = 0;
  EXPECT_GT(MeasureTopology(boxes.mesh, boxes.model).non_manifold_edges, 0u);
}

}  // namespace
}  // namespace facetless
