#include "samples/generator/assembly.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Quantity_Color.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>
#include <string>

namespace facetless::samples {
namespace {

// The plate and the spacer are modelled about their centres, so that all components are moved: OpenCASCADE
// drops the name of a component that is not moved.
constexpr double kPlateX = 80, kPlateY = 60, kPlateZ = 8, kSpacerZ = 25;
constexpr double kHoleX = 30, kHoleY = 20;  // of the bolts, from the middle

TopoDS_Shape OneSolid(const TopoDS_Shape& shape) {
  return TopExp_Explorer(shape, TopAbs_SOLID).Current();
}

gp_Ax2 Upward(double x, double y, double z) {
  return {gp_Pnt(x, y, z), gp_Dir(0, 0, 1)};
}

TopoDS_Shape Plate() {
  TopoDS_Shape plate =
      BRepPrimAPI_MakeBox(gp_Pnt(-kPlateX / 2, -kPlateY / 2, -kPlateZ / 2), kPlateX, kPlateY, kPlateZ)
          .Shape();
  for (const double x : {-kHoleX, kHoleX}) {
    for (const double y : {-kHoleY, kHoleY}) {
      plate =
          BRepAlgoAPI_Cut(plate, BRepPrimAPI_MakeCylinder(Upward(x, y, -kPlateZ), 4.5, 2 * kPlateZ).Shape())
              .Shape();
    }
  }
  return OneSolid(plate);
}

// An M8 bolt without its thread: the head's underside at z = 0, the shank below.
TopoDS_Shape Bolt() {
  constexpr double kAcrossFlats = 13, kHead = 5.3, kShank = 14;
  BRepBuilderAPI_MakePolygon hexagon;
  for (int corner = 0; corner < 6; ++corner) {
    const double angle = corner * M_PI / 3, radius = kAcrossFlats / std::sqrt(3.0);
    hexagon.Add(gp_Pnt(radius * std::cos(angle), radius * std::sin(angle), 0));
  }
  hexagon.Close();
  const TopoDS_Shape head =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(hexagon.Wire()).Face(), gp_Vec(0, 0, kHead)).Shape();
  const TopoDS_Shape shank = BRepPrimAPI_MakeCylinder(Upward(0, 0, -kShank), 4, kShank).Shape();
  return OneSolid(BRepAlgoAPI_Fuse(head, shank).Shape());
}

TopoDS_Shape Spacer() {
  const TopoDS_Shape outside = BRepPrimAPI_MakeCylinder(Upward(0, 0, -kSpacerZ / 2), 15, kSpacerZ).Shape();
  return OneSolid(
      BRepAlgoAPI_Cut(outside, BRepPrimAPI_MakeCylinder(Upward(0, 0, -kSpacerZ), 10, 2 * kSpacerZ).Shape())
          .Shape());
}

void SetName(const TDF_Label& label, const std::string& name) {
  TDataStd_Name::Set(label, TCollection_ExtendedString(name.c_str(), true));
}

Quantity_Color Srgb(double r, double g, double b) {
  return {r, g, b, Quantity_TOC_sRGB};
}

}  // namespace

Handle(TDocStd_Document) Assembly() {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(document->Main());

  const auto part = [&](const TopoDS_Shape& shape, const std::string& name, const Quantity_Color& color) {
    const TDF_Label label = shapes->AddShape(shape, false);
    SetName(label, name);
    colors->SetColor(label, color, XCAFDoc_ColorSurf);
    return label;
  };
  const auto place = [&](const TDF_Label& assembly, const TDF_Label& what, const gp_Trsf& where,
                         const std::string& name) {
    SetName(shapes->AddComponent(assembly, what, TopLoc_Location(where)), name);
  };
  const auto shifted = [](double x, double y, double z) {
    gp_Trsf shift;
    shift.SetTranslation(gp_Vec(x, y, z));
    return shift;
  };

  // Parts. The plate's upper face and the bolt's cylinder have colours of their own.
  const TopoDS_Shape plate_shape = Plate(), bolt_shape = Bolt();
  const TDF_Label plate = part(plate_shape, "plate", Srgb(0.55, 0.6, 0.65));
  for (TopExp_Explorer faces(plate_shape, TopAbs_FACE); faces.More(); faces.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(faces.Current()));
    if (surface.GetType() == GeomAbs_Plane && surface.Plane().Location().Z() == kPlateZ / 2) {
      colors->SetColor(shapes->AddSubShape(plate, faces.Current()), Srgb(0.85, 0.25, 0.2), XCAFDoc_ColorSurf);
    }
  }
  const TDF_Label bolt = part(bolt_shape, "bolt M8", Srgb(0.2, 0.22, 0.25));
  for (TopExp_Explorer faces(bolt_shape, TopAbs_FACE); faces.More(); faces.Next()) {
    if (BRepAdaptor_Surface(TopoDS::Face(faces.Current())).GetType() == GeomAbs_Cylinder) {
      colors->SetColor(shapes->AddSubShape(bolt, faces.Current()), Srgb(0.75, 0.65, 0.35), XCAFDoc_ColorSurf);
    }
  }
  const TDF_Label spacer = part(Spacer(), "spacer", Srgb(0.2, 0.45, 0.75));

  // The flange: a plate with its bolts.
  const TDF_Label flange = shapes->NewShape();
  SetName(flange, "flange");
  place(flange, plate, shifted(0, 0, kPlateZ / 2), "base plate");
  int number = 0;
  for (const double x : {-kHoleX, kHoleX}) {
    for (const double y : {-kHoleY, kHoleY}) {
      place(flange, bolt, shifted(x, y, kPlateZ), "bolt " + std::to_string(++number));
    }
  }

  // The stack: the lower flange upside down, the spacer, the upper flange.
  const TDF_Label stack = shapes->NewShape();
  SetName(stack, "stack");
  gp_Trsf upside_down;
  upside_down.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), M_PI);
  place(stack, flange, upside_down, "lower flange");
  place(stack, spacer, shifted(0, 0, kSpacerZ / 2), "middle spacer");
  place(stack, flange, shifted(0, 0, kSpacerZ), "upper flange");
  shapes->UpdateAssemblies();
  return document;
}

}  // namespace facetless::samples
