// Parts, solids, edges, instances and bounds of shapes with known answers.
#include "import/convert.h"

#include <gtest/gtest.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Plane.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Pln.hxx>

#include <cmath>
#include <numbers>

#include "import/bounds.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;

Conversion Converted(const TopoDS_Shape& shape) {
  Result<Conversion> result = ConvertShape(shape);
  EXPECT_TRUE(result.ok()) << result.error().message;
  if (!result.ok()) return {};
  const Result<void> valid = Validate(result.value().model);
  EXPECT_TRUE(valid.ok()) << valid.error().message;
  return std::move(result.value());
}

double Area(const Model& model) {
  double area = 0;
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) area += TrimmedArea(model, f);
  return area;
}

TEST(Convert, ABoxHasTwelveEdgesUsedTwice) {
  const Model model = Converted(BRepPrimAPI_MakeBox(1, 2, 3).Shape()).model;
  ASSERT_EQ(model.faces.size(), 6u);
  ASSERT_EQ(model.edges.size(), 12u);
  EXPECT_EQ(model.vertices.size(), 8u);
  for (const Edge& edge : model.edges) EXPECT_EQ(edge.coedge_count, 2u);
  ASSERT_EQ(model.solids.size(), 1u);
  EXPECT_TRUE(model.solids[0].closed);
  for (const Face& face : model.faces) EXPECT_EQ(face.solid, 0u);
  EXPECT_NEAR(Area(model), 22, 1e-9);
  EXPECT_NEAR(model.Diagonal(), std::sqrt(14.0), 1e-12);
  EXPECT_LE(model.info.max_edge_gap_mm, 1e-15);
}

TEST(Convert, CurvedSolidsAreClosedToo) {
  struct Case {
    TopoDS_Shape shape;
    double area;
  };
  const double slant = std::hypot(3, 5);
  const Case cases[] = {{BRepPrimAPI_MakeCylinder(2, 5).Shape(), 2 * kPi * 2 * 5 + 2 * kPi * 4},
                        {BRepPrimAPI_MakeSphere(3).Shape(), 4 * kPi * 9},
                        {BRepPrimAPI_MakeTorus(5, 1).Shape(), 4 * kPi * kPi * 5},
                        {BRepPrimAPI_MakeCone(3, 0, 5).Shape(), kPi * 3 * slant + kPi * 9},
                        {BRepPrimAPI_MakeSphere(3, 1.0).Shape(), 4 * kPi * 9 / (2 * kPi) + kPi * 9}};
  for (const Case& c : cases) {
    for (const bool nurbs : {false, true}) {
      const Model model =
          Converted(nurbs ? BRepBuilderAPI_NurbsConvert(c.shape, true).Shape() : c.shape).model;
      ASSERT_EQ(model.solids.size(), 1u);
      EXPECT_TRUE(model.solids[0].closed);
      EXPECT_NEAR(Area(model), c.area, 1e-3 * c.area);
      EXPECT_TRUE(model.info.approximated.empty());
      EXPECT_LE(model.info.max_edge_gap_mm, 1e-7);
    }
  }
}

TEST(Convert, ABlockWithASlantedHoleLosesNothing) {
  const TopoDS_Shape drill =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(10, 7, -5), gp_Dir(0.3, 0.1, 1)), 3, 30).Shape();
  const Model model =
      Converted(BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(20, 15, 10).Shape(), drill).Shape()).model;
  EXPECT_EQ(model.faces.size(), 7u);
  ASSERT_EQ(model.solids.size(), 1u);
  EXPECT_TRUE(model.solids[0].closed);
  EXPECT_TRUE(model.info.faces_lost.empty());
  EXPECT_TRUE(model.info.edges_lost.empty());
  EXPECT_LE(model.info.max_edge_gap_mm, 1e-6);
}

TEST(Convert, TheSameBodyPlacedTwiceIsOnePart) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  TopoDS_Compound pair;
  BRep_Builder builder;
  builder.MakeCompound(pair);
  for (int i = 0; i < 3; ++i) {
    gp_Trsf shift;
    shift.SetTranslation(gp_Vec(0, 10 * i, 0));
    builder.Add(pair, box.Moved(TopLoc_Location(shift)));
  }
  builder.Add(pair, BRepPrimAPI_MakeSphere(2).Shape());
  const Model model = Converted(pair).model;
  EXPECT_EQ(model.parts.size(), 2u);
  ASSERT_EQ(model.instances.size(), 4u);
  EXPECT_EQ(model.faces.size(), 7u);
  EXPECT_EQ(model.PlacedFaceCount(), 19u);
  EXPECT_NEAR(model.bounds.high.y, 21, 1e-9);
}

TEST(Convert, AnOpenShellIsNoSolidAndAClosedOneIs) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  BRep_Builder builder;
  TopoDS_Shell open, closed;
  builder.MakeShell(open);
  builder.MakeShell(closed);
  int count = 0;
  for (TopExp_Explorer face(box, TopAbs_FACE); face.More(); face.Next()) {
    builder.Add(closed, face.Current());
    if (++count < 6) builder.Add(open, face.Current());
  }
  const Model sheet = Converted(open).model;
  EXPECT_TRUE(sheet.solids.empty());
  for (const Face& face : sheet.faces) EXPECT_EQ(face.solid, kNoIndex);
  const Model body = Converted(closed).model;
  ASSERT_EQ(body.solids.size(), 1u);
  EXPECT_TRUE(body.solids[0].closed);
}

TEST(Convert, AFaceWithoutLoopsIsTheWholeGrid) {
  TColgp_Array2OfPnt poles(1, 3, 1, 3);
  for (int i = 1; i <= 3; ++i) {
    for (int j = 1; j <= 3; ++j) poles(i, j) = gp_Pnt(i, j, 0.1 * i * j);
  }
  BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_BezierSurface(poles), 1e-7);
  const Model model = Converted(face).model;
  ASSERT_EQ(model.faces.size(), 1u);
  EXPECT_EQ(model.faces[0].loops.count, 0u);
}

TEST(Convert, AnUnboundedSurfaceIsALossWithAReason) {
  BRep_Builder builder;
  TopoDS_Face plane;
  builder.MakeFace(plane, new Geom_Plane(gp_Pln()), 1e-7);
  TopoDS_Compound both;
  builder.MakeCompound(both);
  builder.Add(both, plane);
  builder.Add(both, BRepPrimAPI_MakeBox(1, 1, 1).Shape());
  const Model model = Converted(both).model;
  EXPECT_EQ(model.faces.size(), 6u);
  ASSERT_EQ(model.info.faces_lost.size(), 1u);
  EXPECT_NE(model.info.faces_lost[0].reason.find("unbounded"), std::string::npos);
  const Result<Conversion> alone = ConvertShape(plane);
  ASSERT_FALSE(alone.ok());
  EXPECT_EQ(alone.error().code, ErrorCode::kNothingUsable);
}

TEST(Convert, BoundsAreConservativeAndTight) {
  // The true extent of a turned torus along z is known.
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(), gp_Dir(1, 0, 0)), 0.6);
  const Model model =
      Converted(BRepBuilderAPI_Transform(BRepPrimAPI_MakeTorus(5, 1).Shape(), turn).Shape()).model;
  const double exact = 5 * std::sin(0.6) + 1;
  EXPECT_GE(model.bounds.high.z, exact - 1e-12);
  EXPECT_LE(model.bounds.high.z, exact * 1.01);
  EXPECT_GE(model.bounds.high.x, 6 - 1e-12);
  EXPECT_LE(model.bounds.high.x, 6.06);
}

TEST(Convert, TheNormalPointsOutOfEverySolid) {
  // The volume by the divergence theorem is positive only if Su × Sv points outwards, after it is reversed
  // for reversed faces.
  const TopoDS_Shape shapes[] = {BRepPrimAPI_MakeBox(1, 2, 3).Shape(),
                                 BRepPrimAPI_MakeCylinder(1, 2).Shape()};
  for (const TopoDS_Shape& shape : shapes) {
    const Model model = Converted(shape).model;
    const Vec3 center = model.bounds.center();
    for (const Face& face : model.faces) {
      const Surface& surface = model.surfaces[face.surface];
      const Vec4* p = &model.control_points[surface.first_control_point];
      const std::size_t row = surface.degree_v + 1u, last = surface.PointsPerPatch() - row;
      const Vec3 corner = Cartesian(p[0]);
      const Vec3 normal = Cross(Cartesian(p[row]) - corner, Cartesian(p[1]) - corner);
      const Vec3 middle =
          0.25 * (corner + Cartesian(p[row - 1]) + Cartesian(p[last]) + Cartesian(p[last + row - 1]));
      EXPECT_GT((face.reversed ? -1 : 1) * Dot(normal, middle - center), 0);
    }
  }
}

}  // namespace
}  // namespace facetless
