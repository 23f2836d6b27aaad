#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <array>
#include <cmath>
#include <gp_Pln.hxx>

#include "samples/generator/bspline.h"
#include "samples/generator/shapes.h"

namespace facetless::samples {
namespace {

constexpr int kSectionPoles = 6, kStations = 5, kDegree = 3;

struct SectionPoint {
  double x, y;  // in chords
};
// Both sides begin with a vertical tangent at the leading edge and meet in a wedge of about 9° at the
// trailing edge.
constexpr std::array<SectionPoint, kSectionPoles> kSuctionSide = {
    {{0, 0}, {0, 0.03}, {0.2, 0.085}, {0.5, 0.09}, {0.8, 0.045}, {1, 0}}};
constexpr std::array<SectionPoint, kSectionPoles> kPressureSide = {
    {{0, 0}, {0, -0.03}, {0.2, -0.02}, {0.5, 0.015}, {0.8, 0.015}, {1, 0}}};

struct Station {
  double z, chord, twist_deg, offset;
};
constexpr std::array<Station, kStations> kStation = {
    {{0, 60, 0, 0}, {30, 56, 6, 1}, {65, 46, 14, 2.5}, {100, 36, 24, 5}, {120, 30, 30, 8}}};

// u runs along the section from the leading to the trailing edge, v along the span. All control points of a
// station have the same z, so both ends are plane.
Handle(Geom_BSplineSurface) Side(const std::array<SectionPoint, kSectionPoles>& section) {
  TColgp_Array2OfPnt poles(1, kSectionPoles, 1, kStations);
  for (int j = 0; j < kStations; ++j) {
    const Station& station = kStation[j];
    const double twist = station.twist_deg * M_PI / 180;
    for (int i = 0; i < kSectionPoles; ++i) {
      const double x = station.chord * (section[i].x - 0.3),
                   y = station.chord * section[i].y + station.offset;
      poles(i + 1, j + 1) = gp_Pnt(Rounded(std::cos(twist) * x - std::sin(twist) * y),
                                   Rounded(std::sin(twist) * x + std::cos(twist) * y), station.z);
    }
  }
  return ClampedSurface(poles, kDegree, kDegree);
}

}  // namespace

TopoDS_Shape Blade() {
  const Handle(Geom_BSplineSurface) suction = Side(kSuctionSide), pressure = Side(kPressureSide);

  BRepBuilderAPI_Sewing sewing(1e-6);
  sewing.Add(BRepBuilderAPI_MakeFace(suction, Precision::Confusion()).Face());
  sewing.Add(BRepBuilderAPI_MakeFace(pressure, Precision::Confusion()).Face());
  for (const int end : {0, 1}) {
    BRepBuilderAPI_MakeWire border(BRepBuilderAPI_MakeEdge(suction->VIso(end)).Edge(),
                                   BRepBuilderAPI_MakeEdge(pressure->VIso(end)).Edge());
    const double z = kStation[end == 0 ? 0 : kStations - 1].z;
    sewing.Add(BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), border.Wire()).Face());
  }
  sewing.Perform();

  const TopoDS_Shell shell = TopoDS::Shell(TopExp_Explorer(sewing.SewedShape(), TopAbs_SHELL).Current());
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(shell).Solid();
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

}  // namespace facetless::samples
