#include "import/heal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <gp_Pln.hxx>

#include "import/heal_changes.h"
#include "import/readers.h"
#include "import/scratch.h"

namespace facetless {
namespace {

CadDocument DocumentOf(const TopoDS_Shape& shape) {
  CadDocument document;
  document.unhealed_mm = 1e-7;
  document.prototypes.push_back({.name = "part", .shape = shape, .colors = {}});
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
    document.origins[face.Current().TShape().get()].entity =
        "#" + std::to_string(10 + document.origins.size());
  return document;
}

// The box with one of its faces turned round.
TopoDS_Solid BoxWithATurnedFace() {
  const BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  bool turned = false;
  for (TopExp_Explorer face(BRepPrimAPI_MakeBox(10, 20, 30).Shape(), TopAbs_FACE); face.More(); face.Next()) {
    builder.Add(shell, turned ? face.Current() : face.Current().Reversed());
    turned = true;
  }
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  return solid;
}

TEST(HealDocument, LeavesSoundBodiesAndListsNone) {
  const Scratch scratch;
  PrepareOpenCascade(scratch.path());
  for (const TopoDS_Shape& shape : {TopoDS_Shape(BRepPrimAPI_MakeBox(10, 20, 30).Shape()),
                                    TopoDS_Shape(BRepPrimAPI_MakeCylinder(5, 20).Shape())}) {
    CadDocument document = DocumentOf(shape);
    const Healing healing = HealDocument(document);
    EXPECT_EQ(healing.sound.size(), 1u);
    EXPECT_TRUE(healing.healed.empty());
    EXPECT_TRUE(document.prototypes[0].shape.IsSame(shape));
  }
}

TEST(HealDocument, NamesTheBodyThatItHealsAndSaysWhy) {
  const Scratch scratch;
  PrepareOpenCascade(scratch.path());
  CadDocument document = DocumentOf(BoxWithATurnedFace());
  const Healing healing = HealDocument(document);
  EXPECT_TRUE(healing.sound.empty());
  ASSERT_EQ(healing.healed.size(), 1u);
  const HealedBody& body = healing.healed[0];
  EXPECT_EQ(body.name, "part");
  EXPECT_EQ(body.entity, "#10");
  EXPECT_EQ(body.reason, "its faces do not meet properly at their edges");
  EXPECT_EQ(body.faces, 6u);
  EXPECT_EQ(body.moved_mm, 0) << "no edge of it is wrong";
}

// A square of 10 mm in the plane z = height.
TopoDS_Shape Square(double height) {
  return BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, height), gp_Dir(0, 0, 1)), 0, 10, 0, 10).Shape();
}

TEST(BodyBefore, MeasuresHowFarEdgesWereMoved) {
  const TopoDS_Shape square = Square(0), moved = Square(0.5);
  HealedBody entry;
  BodyBefore(square).Describe(
      moved, [&](const TopoDS_Shape&) { return moved; }, entry);
  EXPECT_EQ(entry.faces, 1u);
  EXPECT_EQ(entry.faces_changed, 1u);
  EXPECT_EQ(entry.edges_changed, 4u);
  EXPECT_DOUBLE_EQ(entry.moved_mm, 0.5);
}

TEST(BodyBefore, CountsNothingOfABodyThatStays) {
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(5, 20).Shape();
  HealedBody entry;
  BodyBefore(cylinder).Describe(
      cylinder, [](const TopoDS_Shape& face) { return face; }, entry);
  EXPECT_EQ(entry.faces, 3u);
  EXPECT_EQ(entry.faces_changed + entry.edges_changed + entry.pcurves_changed, 0u);
  EXPECT_EQ(entry.moved_mm, 0);
}

}  // namespace
}  // namespace facetless
