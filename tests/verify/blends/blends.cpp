#include "tests/verify/blends/blends.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepFilletAPI_MakeChamfer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepOffsetAPI_MakeOffsetShape.hxx>
#include <BRepOffsetAPI_MakePipe.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepPrimAPI_MakeWedge.hxx>
#include <BRepTools.hxx>
#include <GC_MakeCircle.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <Geom_BSplineCurve.hxx>
#include <OSD.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <bit>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <numbers>
#include <vector>

#include "import/assembly.h"
#include "import/convert.h"
#include "render/trace/direct.h"
#include "tests/verify/oracle/aim.h"
#include "tests/verify/oracle/judge.h"

namespace facetless {
namespace {

using oracle::Random;

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// Returns a solid to blend, of about 10 mm.
TopoDS_Shape BaseSolid(Random& random, std::string* what) {
  const auto length = [&] { return random.Uniform(4, 16); };
  const auto turned = [&] {
    return gp_Ax2(gp_Pnt(random.Uniform(2, 8), random.Uniform(2, 8), random.Uniform(0, 4)),
                  gp_Dir(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(0.2, 1)));
  };
  switch (random.Below(7)) {
    case 0:
      *what += "a box";
      return BRepPrimAPI_MakeBox(length(), length(), length()).Shape();
    case 1:
      *what += "a cylinder";
      return BRepPrimAPI_MakeCylinder(length() / 2, length()).Shape();
    case 2:
      *what += "a truncated cone";
      return BRepPrimAPI_MakeCone(length(), length() / 3, length()).Shape();
    case 3:
      *what += "a wedge";
      return BRepPrimAPI_MakeWedge(length(), length(), length(), random.Uniform(1, 3)).Shape();
    case 4:
      *what += "a box with a cylinder on it";
      return BRepAlgoAPI_Fuse(BRepPrimAPI_MakeBox(length(), length(), length()).Shape(),
                              BRepPrimAPI_MakeCylinder(turned(), random.Uniform(1, 3), length() + 6).Shape())
          .Shape();
    case 5:
      *what += "a box with a hole";
      return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(length(), length(), length()).Shape(),
                             BRepPrimAPI_MakeCylinder(turned(), random.Uniform(0.5, 2), length() + 6).Shape())
          .Shape();
    default:
      *what += "a cylinder across a cylinder";
      return BRepAlgoAPI_Fuse(BRepPrimAPI_MakeCylinder(random.Uniform(2, 5), length()).Shape(),
                              BRepPrimAPI_MakeCylinder(turned(), random.Uniform(1, 3), length()).Shape())
          .Shape();
  }
}

// Returns one to four different edges of a shape, none of which is a seam or collapsed.
std::vector<TopoDS_Edge> SomeEdges(const TopoDS_Shape& shape, Random& random) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  std::vector<TopoDS_Edge> usable;
  for (int i = 1; i <= faces_of.Extent(); ++i) {
    const TopTools_ListOfShape& faces = faces_of(i);
    if (faces.Extent() == 2 && !faces.First().IsSame(faces.Last()))
      usable.push_back(TopoDS::Edge(faces_of.FindKey(i)));
  }
  std::vector<TopoDS_Edge> some;
  for (std::uint32_t count = 1 + random.Below(4); count > 0 && !usable.empty(); --count) {
    const std::uint32_t pick = random.Below(static_cast<std::uint32_t>(usable.size()));
    some.push_back(usable[pick]);
    usable.erase(usable.begin() + pick);
  }
  return some;
}

Blend Fillet(Random& random) {
  Blend blend{"fillet of ", {}};
  const TopoDS_Shape base = BaseSolid(random, &blend.what);
  constexpr std::pair<ChFi3d_FilletShape, const char*> kShapes[] = {{ChFi3d_Rational, "rational"},
                                                                    {ChFi3d_QuasiAngular, "quasi-angular"},
                                                                    {ChFi3d_Polynomial, "polynomial"}};
  const auto& [shape, name] = kShapes[random.Below(3)];
  BRepFilletAPI_MakeFillet fillet(base, shape);
  const std::vector<TopoDS_Edge> edges = SomeEdges(base, random);
  for (const TopoDS_Edge& edge : edges) {
    const double radius = std::exp(random.Uniform(std::log(0.02), std::log(2.0)));
    if (random.Below(3) == 0) {
      fillet.Add(radius, radius * random.Uniform(0.3, 3), edge);
    } else {
      fillet.Add(radius, edge);
    }
    blend.what += ", radius " + Number(radius);
  }
  blend.what += std::string(", ") + name;
  blend.shape = fillet.Shape();
  return blend;
}

Blend Chamfer(Random& random) {
  Blend blend{"chamfer of ", {}};
  const TopoDS_Shape base = BaseSolid(random, &blend.what);
  BRepFilletAPI_MakeChamfer chamfer(base);
  for (const TopoDS_Edge& edge : SomeEdges(base, random)) {
    const double width = std::exp(random.Uniform(std::log(0.02), std::log(2.0)));
    chamfer.Add(width, edge);
    blend.what += ", width " + Number(width);
  }
  blend.shape = chamfer.Shape();
  return blend;
}

// Returns a smooth curve of 3 to 7 points in space, of degree 3 to 8.
Handle(Geom_BSplineCurve) Spine(Random& random) {
  const int count = 3 + static_cast<int>(random.Below(5));
  TColgp_Array1OfPnt points(1, count);
  for (int i = 1; i <= count; ++i)
    points(i) = gp_Pnt(5.0 * i + random.Uniform(-1, 1), random.Uniform(-4, 4), random.Uniform(-4, 4));
  const int least = 3 + static_cast<int>(random.Below(3));
  return GeomAPI_PointsToBSpline(points, least, 8, GeomAbs_C2, 1e-3).Curve();
}

TopoDS_Wire Circle(const gp_Pnt& center, const gp_Dir& normal, double radius) {
  return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(center, normal), radius))).Wire();
}

Blend Sweep(Random& random) {
  const Handle(Geom_BSplineCurve) spine = Spine(random);
  gp_Pnt start;
  gp_Vec tangent;
  spine->D1(spine->FirstParameter(), start, tangent);
  const double radius = random.Uniform(0.1, 1.2);
  const TopoDS_Wire path = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(Handle(Geom_Curve)(spine))).Wire();
  const TopoDS_Face profile = BRepBuilderAPI_MakeFace(Circle(start, gp_Dir(tangent), radius)).Face();
  return {"pipe of radius " + Number(radius) + " along a spline of degree " + std::to_string(spine->Degree()),
          BRepOffsetAPI_MakePipe(path, profile).Shape()};
}

Blend Loft(Random& random) {
  BRepOffsetAPI_ThruSections loft(/*isSolid=*/true, /*ruled=*/random.Below(4) == 0);
  const int sections = 2 + static_cast<int>(random.Below(5));
  double height = 0;
  for (int i = 0; i < sections; ++i) {
    const gp_Dir up(random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3), 1);
    loft.AddWire(
        Circle(gp_Pnt(random.Uniform(-1, 1), random.Uniform(-1, 1), height), up, random.Uniform(1, 5)));
    height += random.Uniform(2, 6);
  }
  loft.Build();
  return {"loft through " + std::to_string(sections) + " circles", loft.Shape()};
}

Blend Revolution(Random& random) {
  const int count = 3 + static_cast<int>(random.Below(6));
  TColgp_Array1OfPnt points(1, count);
  for (int i = 1; i <= count; ++i) points(i) = gp_Pnt(random.Uniform(2, 7), 0, 4.0 * i);
  const int most = 3 + static_cast<int>(random.Below(6));
  const Handle(Geom_BSplineCurve) curve = GeomAPI_PointsToBSpline(points, 3, most, GeomAbs_C2, 1e-3).Curve();
  const gp_Pnt low = curve->StartPoint(), high = curve->EndPoint();
  const gp_Pnt axis_low(0, 0, low.Z()), axis_high(0, 0, high.Z());
  BRepBuilderAPI_MakeWire wire(
      BRepBuilderAPI_MakeEdge(axis_low, low), BRepBuilderAPI_MakeEdge(Handle(Geom_Curve)(curve)),
      BRepBuilderAPI_MakeEdge(high, axis_high), BRepBuilderAPI_MakeEdge(axis_high, axis_low));
  const double angle = random.Below(2) == 0 ? 2 * std::numbers::pi : random.Uniform(0.2, 6);
  return {"revolution by " + Number(angle) + " of a spline of degree " + std::to_string(curve->Degree()),
          BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire()).Face(),
                                gp_Ax1(gp_Pnt(), gp_Dir(0, 0, 1)), angle)
              .Shape()};
}

Blend Offset(Random& random) {
  Blend source = random.Below(2) == 0 ? Loft(random) : Sweep(random);
  const double distance = random.Uniform(-0.3, 0.6);
  BRepOffsetAPI_MakeOffsetShape offset;
  offset.PerformByJoin(source.shape, distance, 1e-4);
  return {"offset by " + Number(distance) + " of " + source.what, offset.Shape()};
}

Blend Make(Random& random) {
  switch (random.Below(10)) {
    case 0:
    case 1:
    case 2:
    case 3:
    case 4:
      return Fillet(random);
    case 5:
      return Chamfer(random);
    case 6:
      return Sweep(random);
    case 7:
      return Loft(random);
    case 8:
      return Revolution(random);
    default:
      return Offset(random);
  }
}

}  // namespace

std::optional<Blend> MakeBlend(std::uint64_t seed) {
  Random random(seed);
  try {
    OCC_CATCH_SIGNALS
    Blend blend = Make(random);
    if (blend.shape.IsNull() || !BRepCheck_Analyzer(blend.shape).IsValid()) return std::nullopt;
    return blend;
  } catch (const Standard_Failure&) {
    return std::nullopt;
  }
}

Result<Model> ModelOfBlend(const Blend& blend) {
  CadDocument document;
  document.info.file = blend.what;
  document.pcurves_in_file = true;
  try {
    OCC_CATCH_SIGNALS
    AddShape(blend.shape, "blend", document);
    Result<Conversion> conversion = Convert(std::move(document), [](double) {});
    if (!conversion.ok()) return conversion.error();
    return std::move(conversion.value().model);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::kImporterCrashed,
                 std::string("the conversion threw ") + failure.DynamicType()->Name()};
  }
}

Result<BlendReport> JudgeBlend(const Model& model, std::uint64_t seed, int size) {
  BlendReport report;
  report.faces = static_cast<std::uint32_t>(model.faces.size());
  for (const Surface& surface : model.surfaces)
    report.highest_degree = std::max({report.highest_degree, int{surface.degree_u}, int{surface.degree_v}});
  Random random(seed + 1);
  const Scene scene(model);
  const oracle::Oracle oracle(model);
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const std::string view = ViewNames()[random.Below(static_cast<std::uint32_t>(ViewNames().size()))];
    const Result<Camera> camera = NamedView(view, model.bounds, projection, size, size - 1);
    if (!camera.ok()) return camera.error();
    DirectOptions options;
    options.accuracy.precision = Precision::kCertified;
    options.audit = true;
    options.depth_error = true;
    const Result<DirectResult> direct = TraceDirect(scene, camera.value(), options);
    if (!direct.ok()) return direct.error();
    const DirectStats& stats = direct.value().stats;
    report.rays += stats.rays;
    report.certified += stats.certified;
    report.contradicted += stats.check.roots_contradicted + stats.check.rays_contradicted;
    report.limited += stats.doubts[static_cast<std::size_t>(std::countr_zero(std::uint8_t{kDoubtLimit}))];
    report.closed = stats.odd_rays.has_value();
    report.odd += stats.odd_rays.value_or(0);
    report.mismatched += stats.reverse_mismatches.value_or(0);

    constexpr std::size_t kSamples = 12;
    std::vector<std::uint32_t> pixels =
        HardPixels(direct.value(), oracle::Features(model, kSamples, random), kSamples, random);
    for (const std::uint32_t pixel : RandomPixels(direct.value().samples, kSamples, random))
      pixels.push_back(pixel);
    std::erase_if(pixels, [&](std::uint32_t pixel) {
      return direct.value().samples.certificate[pixel] != Certificate::kCertified;
    });
    const oracle::Tally tally =
        JudgePixels(oracle::Judge(oracle, camera.value()), direct.value().samples, pixels);
    report.judged += tally.samples;
    report.wrong += tally.CertifiedWrong();
  }
  return report;
}

}  // namespace facetless
