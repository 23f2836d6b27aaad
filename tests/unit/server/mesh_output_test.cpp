// Tests what `facetless mesh` writes: hidden placements, rounding, and the same solid in every format.
#include "server/run/mesh_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/baseline/mesh_file.h"
#include "tests/support/files.h"
#include "tests/support/shapes.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using ::testing::HasSubstr;

// A triangle of 1 mm² at each of `placements`; the second one is hidden.
struct Triangles {
  Model model;
  Mesh mesh;

  Triangles() {
    MeshPart part;
    part.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};
    part.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    part.triangles = {{0, 1, 2}};
    part.face_of_triangle = {0};
    mesh.parts = {part};
    mesh.from_model = true;
    mesh.deflection_mm = 0.1;
    mesh.nodes = {{0, {}, 0}, {0, {}, 1}};
    ModelBuilder builder(testing::Squares(1));
    Instance hidden;
    hidden.hidden = true;
    builder.AddInstance(hidden);
    model = testing::Finished(std::move(builder));
  }
};

class MeshOutputFiles : public ::testing::Test {
 protected:
  // Reads a written mesh.
  Mesh Read(const std::string& name) {
    auto mesh = LoadMesh(directory_.File(name), {}, nullptr);
    EXPECT_TRUE(mesh.ok()) << mesh.error().message;
    return mesh.ok() ? std::move(mesh).value() : Mesh{};
  }
  TempDir directory_ = TempDir::Create().value();
};

TEST_F(MeshOutputFiles, HiddenPlacementsAreLeftOutUnlessAskedFor) {
  Triangles triangles;
  const auto said =
      WriteMeshFiles(triangles.model, triangles.mesh, MeshFormat::kStl, false, directory_.File("a.stl"));
  ASSERT_TRUE(said.ok()) << said.error().message;
  EXPECT_EQ(PlacedTriangleCount(Read("a.stl")), 1u);
  EXPECT_THAT(said.value(), ::testing::Contains(HasSubstr("leaves out 1 placement that the file hides")));

  const auto all =
      WriteMeshFiles(triangles.model, triangles.mesh, MeshFormat::kStl, true, directory_.File("b.stl"));
  ASSERT_TRUE(all.ok());
  EXPECT_EQ(PlacedTriangleCount(Read("b.stl")), 2u);
  EXPECT_THAT(all.value(), ::testing::ElementsAre("2 triangles; not watertight: 6 open edges"));

  triangles.model.instances[0].hidden = true;
  const auto none =
      WriteMeshFiles(triangles.model, triangles.mesh, MeshFormat::kGlb, false, directory_.File("c.glb"));
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(none.error().message, HasSubstr("--show-hidden"));
  EXPECT_FALSE(std::filesystem::exists(directory_.File("c.glb")));
}

TEST_F(MeshOutputFiles, AMeshWithoutItsHiddenPlacementsStillNamesTheModelsFaces) {
  Triangles triangles;
  triangles.model.instances[0].hidden = true;
  triangles.model.instances[1].hidden = false;
  ASSERT_TRUE(
      WriteMeshFiles(triangles.model, triangles.mesh, MeshFormat::kGlb, false, directory_.File("a.glb"))
          .ok());
  const Mesh read = Read("a.glb");
  ASSERT_EQ(read.nodes.size(), 1u);
  EXPECT_EQ(read.nodes[0].first_placed_face, 1u);
  EXPECT_TRUE(RefersToFacesOfModel(read, triangles.model));
}

TEST_F(MeshOutputFiles, StlThatRoundsTooMuchIsSaid) {
  Triangles triangles;
  for (Instance& instance : triangles.model.instances) instance.hidden = false;
  for (MeshNode& node : triangles.mesh.nodes) node.placement.m[0][3] = 1e7;
  const auto stl =
      WriteMeshFiles(triangles.model, triangles.mesh, MeshFormat::kStl, false, directory_.File("a.stl"));
  ASSERT_TRUE(stl.ok());
  EXPECT_THAT(stl.value().front(), HasSubstr("warning: STL rounds"));
  const auto obj =
      WriteMeshFiles(triangles.model, triangles.mesh, MeshFormat::kObj, false, directory_.File("a.obj"));
  ASSERT_TRUE(obj.ok());
  EXPECT_THAT(obj.value().front(), ::testing::Not(HasSubstr("warning")));
  EXPECT_THAT(ReadText(directory_.File("a.obj")), HasSubstr("v 10000002 0 0"));
}

// Returns the signed volume, so that a solid that is inside out has a negative one.
double VolumeOf(const Mesh& mesh) {
  double sum = 0;
  for (const MeshNode& node : mesh.nodes)
    for (const auto& triangle : mesh.parts[node.part].triangles) {
      Vec3 corners[3];
      for (int k = 0; k < 3; ++k) {
        const auto& p = mesh.parts[node.part].positions[triangle[k]];
        corners[k] = node.placement.Point({p[0], p[1], p[2]});
      }
      const double side = node.placement.Determinant() < 0 ? -1 : 1;
      sum += side * Dot(corners[0], Cross(corners[1], corners[2])) / 6;
    }
  return sum;
}

TEST_F(MeshOutputFiles, OfTheSamplesAreClosedAndHaveOneVolume) {
  for (const char* sample : {"bracket.step", "torus.step", "assembly.step"}) {
    double volumes[2] = {};
    std::uint64_t triangles[2] = {};
    for (int k = 0; k < 2; ++k) {
      const std::string name = k == 0 ? "part.glb" : "part.stl";
      const ChildOutcome outcome = RunProgram(
          Program("facetless"), {"mesh", Sample(sample), "--out", directory_.File(name)}, directory_.path());
      ASSERT_EQ(outcome.exit_code, 0) << sample << ": " << outcome.error_tail;
      EXPECT_THAT(outcome.error_tail, HasSubstr("; watertight\n")) << sample;
      const Mesh mesh = Read(name);
      volumes[k] = VolumeOf(mesh);
      triangles[k] = PlacedTriangleCount(mesh);
    }
    EXPECT_GT(volumes[0], 0) << sample;
    EXPECT_NEAR(volumes[1] / volumes[0], 1, 1e-5) << sample;
    EXPECT_EQ(triangles[0], triangles[1]) << sample;
  }
}

}  // namespace
}  // namespace facetless
