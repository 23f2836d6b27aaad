// The tessellation as glTF binary: structure, units, identities, normals.
#include "import/mesh_file.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>

#include <cmath>
#include <cstring>

#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

tinygltf::Model Load(const std::string& path) {
  tinygltf::Model gltf;
  std::string error, warning;
  EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&gltf, &error, &warning, path)) << error;
  return gltf;
}

std::vector<Vec3> Vectors(const tinygltf::Model& gltf, int accessor_index) {
  const tinygltf::Accessor& accessor = gltf.accessors[static_cast<std::size_t>(accessor_index)];
  const tinygltf::BufferView& view = gltf.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < accessor.count; ++i) {
    float p[3];
    std::memcpy(p, &gltf.buffers[0].data[view.byteOffset + accessor.byteOffset + i * sizeof(p)], sizeof(p));
    out.push_back({p[0], p[1], p[2]});
  }
  return out;
}

TopoDS_Compound BoxesAndSphere() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  gp_Trsf shift;
  shift.SetTranslation(gp_Vec(1000, 0, 0));
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  builder.Add(compound, box);
  builder.Add(compound, box.Moved(TopLoc_Location(shift)));
  builder.Add(compound, BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 50), 10).Shape());
  return compound;
}

TEST(MeshFile, OneMeshPerPartOnePrimitivePerFaceOneNodePerInstance) {
  const TemporaryFolder folder;
  Result<Conversion> conversion = ConvertShape(BoxesAndSphere());
  ASSERT_TRUE(conversion.ok());
  const std::string path = folder.File("a.glb");
  const Result<MeshReport> report = WriteMesh(conversion.value(), {0.1, 20}, path, [](double) {});
  ASSERT_TRUE(report.ok()) << report.error().message;
  EXPECT_TRUE(report.value().faces_unmeshed.empty());
  const tinygltf::Model gltf = Load(path);
  const Model& model = conversion.value().model;
  ASSERT_EQ(gltf.meshes.size(), model.parts.size());
  ASSERT_EQ(gltf.nodes.size(), 1 + model.instances.size());
  EXPECT_EQ(gltf.nodes[0].children.size(), model.instances.size());
  std::uint64_t triangles = 0;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    ASSERT_EQ(gltf.meshes[p].primitives.size(), model.parts[p].faces.count);
    for (std::size_t f = 0; f < gltf.meshes[p].primitives.size(); ++f) {
      const tinygltf::Primitive& primitive = gltf.meshes[p].primitives[f];
      EXPECT_EQ(primitive.extras.Get("face").GetNumberAsInt(), static_cast<int>(f));
      triangles += gltf.accessors[static_cast<std::size_t>(primitive.indices)].count / 3;
    }
  }
  EXPECT_EQ(triangles, report.value().triangles);
  for (std::size_t i = 0; i < model.instances.size(); ++i)
    EXPECT_EQ(gltf.nodes[i + 1].extras.Get("first_placed_face").GetNumberAsInt(),
              static_cast<int>(model.instances[i].first_placed_face));
  EXPECT_TRUE(gltf.asset.extras.Get("from_model").Get<bool>());
  EXPECT_EQ(gltf.asset.extras.Get("deflection_mm").GetNumberAsDouble(), 0.1);
}

TEST(MeshFile, TellsWhatTheMesherNeedsWithoutWhatWasReadBefore) {
  const TemporaryFolder folder;
  Result<Conversion> conversion = ConvertShape(BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), 10).Shape());
  ASSERT_TRUE(conversion.ok());
  // Memory that does not belong to the mesher, and memory that was freed before it began, must not count.
  const std::vector<char> held(64 << 20, 'x');
  { const std::vector<char> freed(64 << 20, 'x'); }
  const Result<MeshReport> report =
      WriteMesh(conversion.value(), {1e-2, 20}, folder.File("a.glb"), [](double) {});
  ASSERT_TRUE(report.ok());
  // The peak must be at least the memory of its triangles, with three indices each, and less than the
  // process's other memory.
  EXPECT_GT(report.value().triangles, 5'000u);
  EXPECT_GT(report.value().peak_bytes, 12 * report.value().triangles);
  EXPECT_LT(report.value().peak_bytes, held.size());
}

TEST(MeshFile, SphereNodesLieOnTheSphereWithItsNormals) {
  const TemporaryFolder folder;
  Result<Conversion> conversion = ConvertShape(BRepPrimAPI_MakeSphere(gp_Pnt(100, 200, 300), 10).Shape());
  ASSERT_TRUE(conversion.ok());
  ASSERT_TRUE(WriteMesh(conversion.value(), {0.01, 20}, folder.File("a.glb"), [](double) {}).ok());
  const tinygltf::Model gltf = Load(folder.File("a.glb"));
  const std::vector<double>& node = gltf.nodes[1].matrix;
  const tinygltf::Primitive& primitive = gltf.meshes[0].primitives[0];
  const std::vector<Vec3> positions = Vectors(gltf, primitive.attributes.at("POSITION"));
  const std::vector<Vec3> normals = Vectors(gltf, primitive.attributes.at("NORMAL"));
  ASSERT_EQ(positions.size(), normals.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    // The node's translation moves the part back to its place, in millimetres, Z up.
    const Vec3 p = positions[i] + Vec3{node[12], node[13], node[14]} - Vec3{100, 200, 300};
    EXPECT_NEAR(Length(p), 10, 1e-5);
    EXPECT_NEAR(Dot(normals[i], Normalized(p)), 1, 1e-5);
  }
  // The root node transforms millimetres, Z up, into metres, Y up.
  const std::vector<double>& root = gltf.nodes[0].matrix;
  EXPECT_EQ(root[9], 1e-3);
  EXPECT_EQ(root[6], -1e-3);
}

TEST(MeshFile, ACoarserRequestAfterAFinerOneIsHonoured) {
  const TemporaryFolder folder;
  Result<Conversion> conversion = ConvertShape(BRepPrimAPI_MakeSphere(10).Shape());
  ASSERT_TRUE(conversion.ok());
  const auto triangles = [&](double deflection) {
    return WriteMesh(conversion.value(), {deflection, 90}, folder.File("a.glb"), [](double) {})
        .value()
        .triangles;
  };
  const std::uint64_t coarse = triangles(1), fine = triangles(0.01);
  EXPECT_GT(fine, 4 * coarse);
  EXPECT_EQ(triangles(1), coarse);
}

TEST(MeshFile, OptionsOutOfRangeAndFoldersThatAreNot) {
  const TemporaryFolder folder;
  Result<Conversion> conversion = ConvertShape(BRepPrimAPI_MakeBox(1, 1, 1).Shape());
  ASSERT_TRUE(conversion.ok());
  for (const MeshOptions& options : {MeshOptions{0, 20}, MeshOptions{-1, 20}, MeshOptions{NAN, 20},
                                     MeshOptions{1, 0}, MeshOptions{1, 181}})
    EXPECT_EQ(WriteMesh(conversion.value(), options, folder.File("a.glb"), [](double) {}).error().code,
              ErrorCode::kBadUsage);
  EXPECT_EQ(WriteMesh(conversion.value(), {1, 20}, folder.File("no/a.glb"), [](double) {}).error().code,
            ErrorCode::kWriteFailed);
}

}  // namespace
}  // namespace facetless
