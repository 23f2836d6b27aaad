// Assemblies: placements, names by path, colours of faces, parts and occurrences, loose sheets; and the BREP
// reader.
#include "import/assembly.h"

#include <gtest/gtest.h>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepTools.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <filesystem>

#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

Quantity_Color Srgb(double r, double g, double b) {
  return Quantity_Color(r, g, b, Quantity_TOC_sRGB);
}

// A car with one body and two wheels. The body is red with one blue face. The first wheel is grey, the second
// green.
Handle(TDocStd_Document) Car(const char* wheels = "Räder") {
  Handle(TDocStd_Document) document = NewXcafDocument();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(4, 2, 1).Shape(), ball = BRepPrimAPI_MakeSphere(0.5).Shape();
  const TDF_Label body = shapes->AddShape(box, false), wheel = shapes->AddShape(ball, false);
  TDataStd_Name::Set(body, "body");
  TDataStd_Name::Set(wheel, TCollection_ExtendedString(wheels, true));
  colors->SetColor(body, Srgb(1, 0, 0), XCAFDoc_ColorSurf);
  colors->SetColor(wheel, Srgb(0.5, 0.5, 0.5), XCAFDoc_ColorSurf);
  const TDF_Label face = shapes->AddSubShape(body, TopExp_Explorer(box, TopAbs_FACE).Current());
  colors->SetColor(face, Srgb(0, 0.25, 1), XCAFDoc_ColorSurf);
  const TDF_Label car = shapes->NewShape();
  TDataStd_Name::Set(car, "car");
  TDataStd_Name::Set(shapes->AddComponent(car, body, TopLoc_Location()), "chassis");
  for (int i = 0; i < 2; ++i) {
    gp_Trsf shift;
    shift.SetTranslation(gp_Vec(3 * i, -1, 0));
    const TDF_Label use = shapes->AddComponent(car, wheel, TopLoc_Location(shift));
    TDataStd_Name::Set(use, i == 0 ? "wheel:1" : "wheel:2");
    if (i == 1) colors->SetColor(use, Srgb(0, 1, 0), XCAFDoc_ColorSurf);
  }
  shapes->UpdateAssemblies();
  return document;
}

TEST(Assembly, PartsAreSharedAndNamedByTheirPath) {
  CadDocument document;
  AddAssembly(Car(), "car.step", {}, document);
  ASSERT_EQ(document.prototypes.size(), 2u);
  EXPECT_EQ(document.prototypes[0].name, "body");
  EXPECT_EQ(document.prototypes[1].name, "Räder");
  ASSERT_EQ(document.occurrences.size(), 3u);
  EXPECT_EQ(document.occurrences[0].name, "car/chassis");
  EXPECT_EQ(document.occurrences[2].name, "car/wheel:2");
  EXPECT_EQ(document.occurrences[2].placement.TranslationPart().X(), 3);
}

TEST(Assembly, APartInAnotherFileIsLostByName) {
  // Write one file for the assembly, and one for each part.
  const TemporaryFolder folder;
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  // If a text had to be rewritten, the importer would read a copy, which is not in the folder of the other
  // files.
  ASSERT_TRUE(writer.Transfer(Car("wheels"), STEPControl_AsIs, "part-"));
  ASSERT_EQ(writer.Write(folder.File("car.step").c_str()), IFSelect_RetDone);
  const Result<Conversion> whole = ConvertFile(folder.File("car.step"));
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  EXPECT_EQ(whole.value().model.PlacedFaceCount(), 8u);
  EXPECT_TRUE(whole.value().model.info.faces_lost.empty());

  std::size_t removed = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (entry.path().filename().string().starts_with("part-") && removed++ == 0)
      std::filesystem::remove(entry.path());
  ASSERT_EQ(removed, 2u);
  const Result<Conversion> half = ConvertFile(folder.File("car.step"));
  ASSERT_TRUE(half.ok()) << half.error().message;
  const std::vector<Loss>& lost = half.value().model.info.faces_lost;
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_TRUE(lost[0].name.starts_with("part-")) << lost[0].name;
  EXPECT_EQ(lost[0].entity[0], '#');
  EXPECT_NE(lost[0].reason.find("export the assembly as one file"), std::string::npos) << lost[0].reason;

  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (entry.path().filename().string().starts_with("part-")) std::filesystem::remove(entry.path());
  const Result<Conversion> none = ConvertFile(folder.File("car.step"));
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, ErrorCode::kNothingUsable);
  EXPECT_NE(none.error().message.find("part-"), std::string::npos) << none.error().message;
}

TEST(Assembly, ColoursAreThoseOfTheFaceThenOfTheOccurrenceThenOfThePart) {
  CadDocument document;
  AddAssembly(Car(), "car.step", {}, document);
  const Result<Conversion> conversion = Convert(std::move(document), [](double) {});
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  const Model& model = conversion.value().model;
  ASSERT_EQ(model.PlacedFaceCount(), 8u);
  int blue = 0, red = 0;
  for (std::uint32_t f = 0; f < 6; ++f) {
    const Color color = model.PlacedFaceColor(f);
    blue += color.b == 1 ? 1 : 0;
    red += color.r == 1 ? 1 : 0;
    if (color.b == 1) {
      EXPECT_NEAR(color.g, 0.25, 1e-6);
    }
  }
  EXPECT_EQ(blue, 1);
  EXPECT_EQ(red, 5);
  EXPECT_NEAR(model.PlacedFaceColor(6).g, 0.5, 1e-6);
  EXPECT_NEAR(model.PlacedFaceColor(7).g, 1, 1e-6);
}

TEST(Assembly, LooseSheetsBecomeOnePart) {
  Handle(TDocStd_Document) xcaf = NewXcafDocument();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(xcaf->Main());
  for (TopExp_Explorer face(BRepPrimAPI_MakeBox(1, 1, 1).Shape(), TopAbs_FACE); face.More(); face.Next())
    shapes->AddShape(face.Current(), false);
  CadDocument document;
  AddAssembly(xcaf, "sheets.igs", {}, document);
  ASSERT_EQ(document.prototypes.size(), 1u);
  EXPECT_EQ(document.prototypes[0].name, "sheets.igs");
  EXPECT_EQ(document.occurrences.size(), 1u);
}

TEST(Assembly, ABrepFileIsReadWithItsSharedBodies) {
  const TemporaryFolder folder;
  const std::string path = folder.File("ball.txt");
  ASSERT_TRUE(BRepTools::Write(BRepPrimAPI_MakeSphere(2).Shape(), path.c_str()));
  const Result<Conversion> conversion = ConvertFile(path);
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  EXPECT_EQ(conversion.value().model.info.format, "BREP");
  EXPECT_EQ(conversion.value().model.info.faces_declared, 1u);
  ASSERT_EQ(conversion.value().model.solids.size(), 1u);
  EXPECT_TRUE(conversion.value().model.solids[0].closed);
  EXPECT_EQ(
      ConvertFile(
          folder.Write("bad.brep",
                       "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\nLocations 0\n"))
          .error()
          .code,
      ErrorCode::kFormatBroken);
}

}  // namespace
}  // namespace facetless
