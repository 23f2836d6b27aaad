// Loops: closed, unwrapped, with the material on the left; seams, poles, and bounds that wind around the
// surface.
#include "import/face_loops.h"

#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SphericalSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>

#include <cmath>
#include <numbers>

#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;

FaceLoops Loops(const TopoDS_Face& face) {
  Result<FaceLoops> loops = LoopsOf(face, false);
  EXPECT_TRUE(loops.ok()) << loops.error().message;
  return loops.ok() ? std::move(loops.value()) : FaceLoops{};
}

void ExpectClosed(const FaceLoops& loops) {
  for (const FaceLoop& loop : loops.loops) {
    Vec3 end = Cartesian(loop.coedges.back().segments.back().points.back());
    for (const LoopCoedge& coedge : loop.coedges) {
      for (const LoopSegment& segment : coedge.segments) {
        const Vec3 start = Cartesian(segment.points.front());
        EXPECT_NEAR(start.x, end.x, 1e-14);
        EXPECT_NEAR(start.y, end.y, 1e-14);
        end = Cartesian(segment.points.back());
      }
    }
  }
}

// The face of the shape whose surface is of type T.
template <typename T>
TopoDS_Face FaceOn(const TopoDS_Shape& shape) {
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    TopLoc_Location location;
    if (BRep_Tool::Surface(TopoDS::Face(face.Current()), location)->IsKind(STANDARD_TYPE(T)))
      return TopoDS::Face(face.Current());
  }
  return {};
}

TEST(FaceLoops, ACylinderWithItsSeamIsARectangle) {
  const FaceLoops loops = Loops(FaceOn<Geom_CylindricalSurface>(BRepPrimAPI_MakeCylinder(2, 5).Shape()));
  ASSERT_EQ(loops.loops.size(), 1u);
  EXPECT_EQ(loops.loops[0].coedges.size(), 4u);
  ExpectClosed(loops);
  EXPECT_NEAR(SignedArea(loops), 2 * 2 * kPi * 5, 1e-12);
  // The seam is used twice, by two p-curves that are one period apart and have opposite senses.
  int seams = 0, forward = 0;
  for (const LoopCoedge& coedge : loops.loops[0].coedges) {
    if (!BRep_Tool::IsClosed(coedge.edge,
                             FaceOn<Geom_CylindricalSurface>(BRepPrimAPI_MakeCylinder(2, 5).Shape())) &&
        std::fabs(Cartesian(coedge.segments[0].points[0]).x - Cartesian(coedge.segments[0].points[1]).x) >
            1e-9)
      continue;
    ++seams;
    forward += coedge.reversed ? 0 : 1;
  }
  EXPECT_EQ(seams, 2);
  EXPECT_EQ(forward, 1);
}

TEST(FaceLoops, PolesAreDegenerateCoedgesWithASegmentAlongThem) {
  const FaceLoops loops = Loops(FaceOn<Geom_SphericalSurface>(BRepPrimAPI_MakeSphere(3).Shape()));
  ASSERT_EQ(loops.loops.size(), 1u);
  ExpectClosed(loops);
  EXPECT_NEAR(SignedArea(loops), 2 * 2 * kPi * kPi, 1e-12);
  int degenerate = 0;
  for (const LoopCoedge& coedge : loops.loops[0].coedges) degenerate += coedge.degenerate ? 1 : 0;
  EXPECT_EQ(degenerate, 2);
}

TEST(FaceLoops, ATorusHasTwoSeams) {
  for (TopExp_Explorer face(BRepPrimAPI_MakeTorus(5, 1).Shape(), TopAbs_FACE); face.More(); face.Next()) {
    const FaceLoops loops = Loops(TopoDS::Face(face.Current()));
    ExpectClosed(loops);
    EXPECT_NEAR(SignedArea(loops), 2 * 4 * kPi * kPi, 1e-12);
  }
}

TEST(FaceLoops, MaterialIsOnTheLeftWhicheverWayTheFaceIsOriented) {
  for (TopExp_Explorer face(BRepPrimAPI_MakeBox(1, 2, 3).Shape(), TopAbs_FACE); face.More(); face.Next()) {
    EXPECT_GT(SignedArea(Loops(TopoDS::Face(face.Current()))), 0);
    EXPECT_GT(SignedArea(Loops(TopoDS::Face(face.Current().Reversed()))), 0);
  }
}

TEST(FaceLoops, AHoleRunsTheOtherWay) {
  const TopoDS_Wire outer = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(), 2)).Edge());
  const TopoDS_Wire inner = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(), 1)).Edge());
  BRepBuilderAPI_MakeFace face(gp_Pln(), outer);
  face.Add(TopoDS::Wire(inner.Reversed()));
  const FaceLoops loops = Loops(face.Face());
  ASSERT_EQ(loops.loops.size(), 2u);
  ExpectClosed(loops);
  EXPECT_NEAR(SignedArea(loops), 2 * 3 * kPi, 0.01);
  EXPECT_EQ(loops.repairs.size(), 0u);
}

// Returns a face on `surface` without a seam. Its wires are single circles at the given heights, each of
// which goes around once, in either direction.
TopoDS_Face WithoutSeam(const Handle(Geom_Surface) & surface,
                        const std::vector<std::pair<double, bool>>& circles) {
  BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, surface, 1e-7);
  for (const auto& [v, forward] : circles) {
    const Handle(Geom_Curve) circle = surface->VIso(v);
    TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(circle, 0, 2 * kPi).Edge();
    builder.UpdateEdge(edge, new Geom2d_Line(gp_Pnt2d(0, v), gp_Dir2d(1, 0)), face, 1e-7);
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    builder.Add(wire, forward ? edge : edge.Reversed());
    builder.Add(face, wire);
  }
  return face;
}

TEST(FaceLoops, TwoBoundsThatGoAroundAreJoinedByACut) {
  const Handle(Geom_Surface) cylinder = new Geom_CylindricalSurface(gp_Ax3(), 2);
  const FaceLoops loops = Loops(WithoutSeam(cylinder, {{0, true}, {3, false}}));
  ASSERT_EQ(loops.loops.size(), 1u);
  ExpectClosed(loops);
  EXPECT_NEAR(SignedArea(loops), 2 * 2 * kPi * 3, 1e-12);
  EXPECT_EQ(loops.joins.size(), 1u);
}

TEST(FaceLoops, OneBoundThatGoesAroundIsClosedThroughThePoleOnItsLeft) {
  const Handle(Geom_Surface) sphere = new Geom_SphericalSurface(gp_Ax3(), 2);
  const FaceLoops north = Loops(WithoutSeam(sphere, {{0.5, true}}));
  EXPECT_NEAR(SignedArea(north), 2 * 2 * kPi * (kPi / 2 - 0.5), 1e-12);
  const FaceLoops south = Loops(WithoutSeam(sphere, {{0.5, false}}));
  EXPECT_NEAR(SignedArea(south), 2 * 2 * kPi * (kPi / 2 + 0.5), 1e-12);
  EXPECT_EQ(south.joins.size(), 1u);
}

TEST(FaceLoops, OneBoundAroundACylinderEnclosesNothing) {
  const Handle(Geom_Surface) cylinder = new Geom_CylindricalSurface(gp_Ax3(), 2);
  const Result<FaceLoops> loops = LoopsOf(WithoutSeam(cylinder, {{0, true}}), false);
  ASSERT_FALSE(loops.ok());
  EXPECT_EQ(loops.error().code, ErrorCode::kFormatBroken);
}

TEST(FaceLoops, EdgesInAnyOrderAreChained) {
  // The edges of a square, in an order in which they do not form a chain.
  const gp_Pnt corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  TopoDS_Vertex vertices[4];
  BRep_Builder builder;
  for (int i = 0; i < 4; ++i) builder.MakeVertex(vertices[i], corners[i], 1e-7);
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  for (const int i : {0, 2, 3, 1})
    builder.Add(wire, BRepBuilderAPI_MakeEdge(vertices[i], vertices[(i + 1) % 4]).Edge());
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(gp_Pln()), 1e-7);
  builder.Add(face, wire);
  const FaceLoops loops = Loops(face);
  ASSERT_EQ(loops.loops.size(), 1u);
  ExpectClosed(loops);
  EXPECT_NEAR(SignedArea(loops), 2, 1e-14);
}

TEST(FaceLoops, AGapBecomesASegmentOfTheFollowingCoedge) {
  // The last edge of the triangle ends 1e-5 before the start of the first one.
  const gp_Pnt points[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-5, 0, 0}};
  BRep_Builder builder;
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  for (int i = 0; i < 3; ++i) builder.Add(wire, BRepBuilderAPI_MakeEdge(points[i], points[i + 1]).Edge());
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(gp_Pln()), 1e-7);
  builder.Add(face, wire);
  const FaceLoops loops = Loops(face);
  ASSERT_EQ(loops.loops.size(), 1u);
  ExpectClosed(loops);
  ASSERT_EQ(loops.loops[0].coedges[0].segments.size(), 2u);
  EXPECT_EQ(loops.loops[0].coedges[0].segments[0].edge_begin, loops.loops[0].coedges[0].segments[0].edge_end);
}

}  // namespace
}  // namespace facetless
