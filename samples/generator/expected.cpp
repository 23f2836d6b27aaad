#include "samples/generator/expected.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <map>
#include <string>

namespace facetless::samples {
namespace {

// The keys of report.json.
const char* KindName(GeomAbs_SurfaceType type) {
  switch (type) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_SurfaceOfRevolution:
      return "revolution";
    case GeomAbs_SurfaceOfExtrusion:
      return "extrusion";
    case GeomAbs_BezierSurface:
      return "bezier";
    case GeomAbs_BSplineSurface:
      return "bspline";
    default:
      return "other";
  }
}

std::map<std::string, int> SurfaceKinds(const std::string& path) {
  STEPControl_Reader step;
  IGESControl_Reader iges;
  XSControl_Reader& reader = path.ends_with(".iges") ? static_cast<XSControl_Reader&>(iges) : step;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    throw Standard_Failure(("cannot read " + path).c_str());
  reader.TransferRoots();
  std::map<std::string, int> kinds;
  for (TopExp_Explorer face(reader.OneShape(), TopAbs_FACE); face.More(); face.Next()) {
    ++kinds[KindName(BRepAdaptor_Surface(TopoDS::Face(face.Current())).GetType())];
  }
  return kinds;
}

}  // namespace

nlohmann::ordered_json Measure(const TopoDS_Shape& shape, const std::string& path) {
  if (!BRepCheck_Analyzer(shape).IsValid()) throw Standard_Failure("not a valid shape");
  // The largest tolerance of a sample's edges, in mm. Edges with a larger tolerance would show as cracks.
  constexpr double kLoosest = 1e-4;
  if (ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1) > kLoosest)
    throw Standard_Failure("edges are too loose");

  int faces = 0, solids = 0, closed = 0;
  double volume = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) ++faces;
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    ++solids;
    bool all_shells_closed = true;
    for (TopExp_Explorer shell(solid.Current(), TopAbs_SHELL); shell.More(); shell.Next()) {
      all_shells_closed = all_shells_closed && BRep_Tool::IsClosed(shell.Current());
    }
    closed += all_shells_closed ? 1 : 0;
    GProp_GProps properties;
    BRepGProp::VolumeProperties(solid.Current(), properties, 1e-9, false, true);
    volume += properties.Mass();
  }
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-9, true);
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, false, false);
  box.SetGap(0);
  const gp_Pnt low = box.CornerMin(), high = box.CornerMax();

  nlohmann::ordered_json expected;
  expected["exit"] = 0;
  expected["faces"] = faces;
  expected["solids"] = solids;
  expected["closed_solids"] = closed;
  expected["surfaces"] = SurfaceKinds(path);
  expected["area_mm2"] = properties.Mass();
  expected["volume_mm3"] = volume;
  expected["bounds_mm"] = {{low.X(), low.Y(), low.Z()}, {high.X(), high.Y(), high.Z()}};
  return expected;
}

}  // namespace facetless::samples
