// Small files with one fault each: what they declare, what is shown, what is lost, and what is reported. The
// numbers must always add up.
#include <gtest/gtest.h>

#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "render/model/walk.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

using Bounds = std::array<double, 6>;  // low x, y, z, high x, y, z

struct Case {
  const char* file;
  std::size_t declared, shown;        // faces of the file; every other body counts as one
  std::size_t placed;                 // faces in all placements
  std::size_t defects = 0;            // lost loops and edges of faces that are shown
  const char* said = "";              // part of a warning, a reason or the error; "": nothing is reported
  std::optional<Bounds> bounds = {};  // only for files with plane faces; other patches extend further
  double area = 0;                    // area of all placed faces, mm²; 0: unknown
  std::optional<std::size_t> closed = {};  // solids in prototypes
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.file;
}

constexpr Bounds kWedge{0, 0, 0, 30, 20, 10};
constexpr Bounds kCube{0, 0, 0, 1, 1, 1};
constexpr double kPi = 3.14159265358979323846;
// The wedge's area: three right-angled triangles and the slope between them.
const double kWedgeArea = 0.5 * (30 * 20 + 30 * 10 + 20 * 10 + std::sqrt(90000.0 + 40000 + 360000));

std::string Words(const ImportInfo& info) {
  std::string words;
  for (const auto* losses : {&info.faces_lost, &info.loops_lost, &info.edges_lost}) {
    for (const Loss& loss : *losses) words += loss.entity + " " + loss.name + ": " + loss.reason + "\n";
  }
  for (const std::string& warning : info.warnings) words += warning + "\n";
  return words;
}

class Cases : public ::testing::TestWithParam<Case> {};

TEST_P(Cases, AreShownOrNamed) {
  const Case& expected = GetParam();
  const std::string path = CadFile(std::string("cases/") + expected.file);
  if (path.empty())
    GTEST_SKIP() << "FACETLESS_CAD names no folder with " << expected.file << ", which is not tested";
  Result<Conversion> conversion = ConvertFile(path);
  if (expected.shown == 0) {
    ASSERT_FALSE(conversion.ok());
    EXPECT_EQ(conversion.error().code, ErrorCode::kNothingUsable);
    EXPECT_NE(conversion.error().message.find(expected.said), std::string::npos)
        << conversion.error().message;
    return;
  }
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  const Model& model = conversion.value().model;
  const Result<void> valid = Validate(model);
  ASSERT_TRUE(valid.ok()) << valid.error().message;
  const ImportInfo& info = model.info;
  const std::string words = Words(info);
  EXPECT_EQ(info.faces_declared, expected.declared) << words;
  EXPECT_EQ(info.faces_imported, expected.shown) << words;
  EXPECT_EQ(info.faces_lost.size(), expected.declared - expected.shown) << words;
  EXPECT_EQ(info.loops_lost.size() + info.edges_lost.size(), expected.defects) << words;
  EXPECT_EQ(model.PlacedFaceCount(), expected.placed);
  for (const Loss& loss : info.faces_lost) {
    EXPECT_EQ(loss.entity[0], '#');
    EXPECT_FALSE(loss.reason.empty());
  }
  if (*expected.said == '\0') {
    EXPECT_TRUE(words.empty()) << words;
  } else {
    EXPECT_NE(words.find(expected.said), std::string::npos) << words;
  }
  if (expected.bounds) {
    const Bounds& b = *expected.bounds;
    EXPECT_LT(Length(model.bounds.low - Vec3{b[0], b[1], b[2]}), 1e-9);
    EXPECT_LT(Length(model.bounds.high - Vec3{b[3], b[4], b[5]}), 1e-9);
  }
  if (expected.area > 0) {
    double area = 0;
    for (const Instance& instance : model.instances)
      for (const std::uint32_t f : Indices(FacesOf(model, instance))) area += TrimmedArea(model, f);
    EXPECT_NEAR(area, expected.area, 1e-3 * expected.area);
  }
  if (expected.closed) {
    std::size_t closed = 0;
    for (const Solid& solid : model.solids) closed += solid.closed ? 1 : 0;
    EXPECT_EQ(closed, *expected.closed);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Ledger, Cases,
    ::testing::Values(
        Case{"base.stp", 6, 6, 6, 0, "", kCube, 6, 1},
        // Faces with any name; surfaces that represent themselves.
        Case{"dollar_cone_declared_rad_written_deg.step", 3, 2, 2, 0, "#40"},
        Case{"cone_declared_rad_written_deg.step", 3, 2, 2, 0, "#40"},
        Case{"cone_declared_deg_written_rad.step", 3, 2, 2, 0, "off its surface"},
        Case{"geometric_set_good.step", 2, 2, 2, 0, "", Bounds{0, 0, 0, 20, 20, 20}, 800},
        Case{"geometric_set_one_lost.step", 2, 1, 1, 0, "#32 S1", Bounds{0, 0, 0, 20, 20, 0}, 400},
        // Bodies that the importer does not read.
        Case{"brep_and_csg.step", 5, 4, 4, 0, "#102 csg: it is a CSG solid", kWedge, kWedgeArea, 1},
        Case{"brep_and_tessellated.step", 5, 4, 4, 0, "#106 : it is a tessellated solid", kWedge, kWedgeArea,
             1},
        // Placements that scale and mirror.
        Case{"brep_and_replica.step", 4, 4, 8, 0, "", Bounds{0, 0, 0, 110, 40, 20}, 5 * kWedgeArea, 2},
        Case{"replica_only.step", 4, 4, 4, 0, "", Bounds{50, 0, 0, 110, 40, 20}, 4 * kWedgeArea, 1},
        Case{"mapped_scale2.step", 4, 4, 8, 0, "", Bounds{0, 0, 0, 110, 40, 20}, 5 * kWedgeArea, 2},
        Case{"assembly_plain.step", 4, 4, 8, 0, "", Bounds{0, 0, 0, 80, 20, 10}, 2 * kWedgeArea, 1},
        Case{"assembly_mirror.step", 4, 4, 8, 0, "", Bounds{0, 0, 0, 50, 20, 10}, 2 * kWedgeArea, 2},
        // Occurrences; several files in one.
        Case{"asm_two.stp", 6, 6, 12, 0, "", Bounds{0, 0, 0, 6, 6, 1}, 12, 1},
        Case{"asm_second_no_transform.stp", 7, 6, 6, 0, "#9301 right", Bounds{5, 0, 0, 6, 1, 1}, 6, 1},
        Case{"concat.stp", 12, 6, 6, 0, "follow each other", kCube, 6, 1},
        // Edges that are followed forwards and backwards.
        Case{"sphere_great_circle_twice.step", 1, 1, 1, 0, "forwards and backwards", {}, 100 * kPi},
        Case{"sphere_offaxis_halfcircle_twice.step", 1, 1, 1, 0, "forwards and backwards", {}, 100 * kPi},
        Case{"cyl_plain.step", 3, 3, 3, 0, "", {}, 600 * kPi, 1},
        Case{"cyl_spur_one.step", 3, 3, 3, 0, "forwards and backwards", {}, 600 * kPi, 1},
        Case{"cyl_spur_both.step", 3, 3, 3, 0, "forwards and backwards", {}, 600 * kPi, 1},
        Case{"parabola_groove.step", 2, 2, 2, 0, "", {}, 0, 1},
        Case{"parabola_bowl_noseam.step", 2, 1, 1, 0, "#33"},
        Case{"degenerate_torus_T_vertex_loop.step", 1, 1, 1, 0, "", {}, 2404.23},
        // Malformed entities.
        Case{"loop_in_shell.stp", 7, 6, 6, 0, "#8003 emptyloop: its edge loop #8001 has no edges", kCube, 6},
        Case{"gp_sc_used.stp", 6, 6, 6, 0, "#8050", kCube, 6, 1},
        Case{"len_16300.stp", 6, 6, 6, 0, "", kCube, 6, 1},
        Case{"len_16384.stp", 6, 6, 6, 0, "16384 bytes in entity #300", kCube, 6, 1},
        Case{"noend.stp", 6, 6, 6, 0, "END-ISO-10303-21", kCube, 6, 1},
        Case{"noend2.stp", 6, 6, 6, 0, "cut off", kCube, 6, 1},
        Case{"bad_same_sense.stp", 6, 6, 6, 0, ".U. for the sense of edge curve #5760", kCube, 6, 1},
        // Units.
        Case{"u_inch.stp", 6, 6, 6, 0, "#10", Bounds{0, 0, 0, 25.4, 25.4, 25.4}, 6 * 645.16, 1},
        Case{"u_inch_canon.stp", 6, 6, 6, 0, "", Bounds{0, 0, 0, 25.4, 25.4, 25.4}, 6 * 645.16, 1},
        Case{"u_none.stp", 6, 6, 6, 0, "no length unit", kCube, 6, 1},
        // Loops.
        Case{"oneline.stp", 1, 0, 0, 0, "does not close: the ends of its edges are up to 6 mm apart"},
        Case{"oneline_bs.stp", 1, 0, 0, 0, "#32"},
        Case{"open3.stp", 1, 1, 1, 1, "a gap of 3 mm was bridged by a straight line",
             Bounds{0, 0, 0, 3, 3, 0}, 9},
        Case{"M023.stp", 1, 1, 1, 0, "loops 1 and 2 cross each other at (2, 1, 0) mm"}),
    [](const auto& info) {
      std::string name = info.param.file;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

// The same wedge with other operators: scale, mirror and unit combined.
struct Operated {
  const char* file;
  std::vector<std::pair<std::string, std::string>> changes;
  Bounds bounds;
};

TEST(ScaledPlacements, ScaleMirrorAndConvertTogether) {
  const std::string path = CadFile("cases/mapped_scale2.step");
  if (path.empty())
    GTEST_SKIP() << "FACETLESS_CAD names no folder with mapped_scale2.step, which is not tested";
  const std::pair<std::string, std::string> inches{
      "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));",
      "#1=(LENGTH_UNIT()NAMED_UNIT(*)CONVERSION_BASED_UNIT('INCH',#901));\n"
      "#901=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#902);\n"
      "#902=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));"};
  const std::string frames =
      "#904=CARTESIAN_POINT('',(30.,0.,0.));\n#905=DIRECTION('',(0.,1.,0.));\n"
      "#903=AXIS2_PLACEMENT_3D('',#904,#10,#905);\n#906=CARTESIAN_POINT('',(0.,50.,0.));\n"
      "#907=AXIS2_PLACEMENT_3D('',#906,#10,#11);\n";
  const Operated cases[] = {
      {"mapped_scale2.step",
       {{"#99=DIRECTION('',(1.0,", "#99=DIRECTION('',(-1.0,"}, {"#101,2.0,#102", "#101,0.5,#102"}},
       {0, 0, 0, 50, 20, 10}},
      {"mapped_scale2.step", {inches}, {0, 0, 0, 25.4 * 110, 25.4 * 40, 25.4 * 20}},
      {"assembly_mirror.step", {{"#124,1.0,#125", "#124,3.0,#125"}}, {-40, 0, 0, 50, 60, 30}},
      {"brep_and_replica.step",
       {{"#97=DIRECTION('',(1.0,", "#97=DIRECTION('',(-1.0,"}},
       {-10, 0, 0, 50, 40, 20}},
      // The map's origin is not where the operator begins.
      {"mapped_scale2.step",
       {{"REPRESENTATION_MAP(#12,#97)", "REPRESENTATION_MAP(#903,#97)"},
        {"#98=", "#904=CARTESIAN_POINT('',(30.,0.,0.));\n#903=AXIS2_PLACEMENT_3D('',#904,#10,#11);\n#98="}},
       {-30, 0, 0, 50, 40, 20}},
      // Two frames, neither of which is the origin: the wedge is turned by −90° about z, and moved.
      {"mapped_scale2.step",
       {{"REPRESENTATION_MAP(#12,#97)", "REPRESENTATION_MAP(#903,#97)"},
        {"#98=", frames + "#98="},
        {"(#12,#109,#104)", "(#12,#109)"},
        {"MAPPED_ITEM('',#98,#108)", "MAPPED_ITEM('',#98,#907)"}},
       {0, 50, 0, 20, 80, 10}},
      {"assembly_plain.step",
       {{"#117=ITEM_DEFINED_TRANSFORMATION('','',#12,#114)",
         frames + "#117=ITEM_DEFINED_TRANSFORMATION('','',#903,#907)"}},
       {0, 0, 0, 80, 80, 10}}};
  const TemporaryFolder folder;
  for (const Operated& operated : cases) {
    std::ifstream in(CadFile(std::string("cases/") + operated.file), std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    for (const auto& [from, to] : operated.changes) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    }
    std::ofstream(folder.File("changed.step"), std::ios::binary) << text;
    Result<Conversion> conversion = ConvertFile(folder.File("changed.step"));
    ASSERT_TRUE(conversion.ok()) << conversion.error().message;
    const Model& model = conversion.value().model;
    EXPECT_TRUE(Validate(model).ok());
    EXPECT_TRUE(model.info.faces_lost.empty()) << Words(model.info);
    const Bounds& b = operated.bounds;
    EXPECT_LT(Length(model.bounds.low - Vec3{b[0], b[1], b[2]}), 1e-7)
        << operated.file << " " << model.bounds.low.x;
    EXPECT_LT(Length(model.bounds.high - Vec3{b[3], b[4], b[5]}), 1e-7)
        << operated.file << " " << model.bounds.high.x;
    // All solids must look outwards: OpenCASCADE's volume of each face's solid must be positive.
    for (const Solid& solid : model.solids) EXPECT_TRUE(solid.closed);
    TopoDS_Compound all;
    BRep_Builder builder;
    builder.MakeCompound(all);
    for (const TopoDS_Face& face : PlacedFaces(conversion.value())) builder.Add(all, face);
    GProp_GProps volume;
    BRepGProp::VolumeProperties(all, volume);
    EXPECT_GT(volume.Mass(), 0) << operated.file;
  }
}

// The lemon is the inner part of a torus that meets its axis.
TEST(DegenerateTorus, IsAnAppleOrALemon) {
  const std::string path = CadFile("cases/degenerate_torus_T_vertex_loop.step");
  if (path.empty()) GTEST_SKIP() << "FACETLESS_CAD names no folder with the torus, which is not tested";
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.find("10.,.T.)"), 8, "10.,.F.)");
  const TemporaryFolder folder;
  std::ofstream(folder.File("lemon.step"), std::ios::binary) << text;
  Result<Conversion> conversion = ConvertFile(folder.File("lemon.step"));
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  ASSERT_EQ(conversion.value().model.faces.size(), 1u);
  EXPECT_NEAR(TrimmedArea(conversion.value().model, 0), 430.3, 0.5);
  EXPECT_NEAR(conversion.value().model.bounds.high.z, 8.66, 0.01);
}

}  // namespace
}  // namespace facetless
