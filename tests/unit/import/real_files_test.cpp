// Real files: nothing is lost, only offset surfaces are approximated, gaps are no larger than the file's own,
// and areas agree with OpenCASCADE's. A broken file gives what can be saved, or an error sentence.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string_view>

#include "render/model/walk.h"
#include "render/nurbs/open_edges.h"
#include "tests/support/files.h"
#include "tests/support/sanitized.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

struct Part {
  const char* file;
  std::size_t faces, placed;
  double area;         // of all placed faces, mm²; 0: no reference value
  std::size_t closed;  // solids
  std::size_t approximated;
};

void PrintTo(const Part& p, std::ostream* out) {
  *out << p.file;
}

class Parts : public ::testing::TestWithParam<Part> {};

TEST_P(Parts, ArriveWhole) {
  const Part& part = GetParam();
  const std::string path = CadFile(std::string("parts/") + part.file);
  if (path.empty())
    GTEST_SKIP() << "FACETLESS_CAD names no folder with " << part.file << ", which is not tested";
  if (kSanitized && part.file == std::string_view("boxed_sphere.step"))
    GTEST_SKIP() << "a sanitizer takes more than ten minutes over " << part.file;
  const Result<Conversion> conversion = ConvertFile(path);
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  const Model& model = conversion.value().model;
  const Result<void> valid = Validate(model);
  ASSERT_TRUE(valid.ok()) << valid.error().message;
  EXPECT_EQ(model.faces.size(), part.faces);
  EXPECT_EQ(model.PlacedFaceCount(), part.placed);
  EXPECT_EQ(model.info.faces_declared, part.faces);
  EXPECT_TRUE(model.info.faces_lost.empty());
  EXPECT_TRUE(model.info.loops_lost.empty());
  EXPECT_TRUE(model.info.edges_lost.empty());
  EXPECT_EQ(model.info.approximated.size(), part.approximated);
  std::size_t closed = 0;
  for (const Solid& solid : model.solids) closed += solid.closed ? 1 : 0;
  EXPECT_EQ(closed, part.closed);
  // Faces must know their entity.
  for (const Face& face : model.faces) EXPECT_FALSE(face.entity.empty());
  // A p-curve must not be farther from its edge than the precision that the file states. Some of the files'
  // edges lie farther off their surfaces, by at most a thousandth of their length. Such an edge must be
  // listed as open.
  std::set<std::uint32_t> open;
  for (const OpenEdge& edge : FindOpenEdges(model)) open.insert(edge.edge);
  for (const Face& face : model.faces) {
    for (const Coedge& coedge : CoedgesOf(model, face)) {
      if (coedge.edge == kNoIndex || model.edges[coedge.edge].degenerate) continue;
      const Edge& edge = model.edges[coedge.edge];
      if (coedge.gap_mm <= edge.tolerance_mm) continue;
      EXPECT_TRUE(open.contains(coedge.edge)) << face.entity;
      EXPECT_LE(coedge.gap_mm, 1e-3 * PolygonLength(model, edge)) << face.entity;
    }
  }
  if (part.area == 0) return;
  std::vector<double> areas(model.faces.size());
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) areas[f] = TrimmedArea(model, f);
  double area = 0;
  for (const Instance& instance : model.instances)
    for (const std::uint32_t f : Indices(FacesOf(model, instance))) area += areas[f];
  EXPECT_NEAR(area, part.area, 1e-3 * part.area);
}

// The areas come from OpenCASCADE's own integration.
INSTANTIATE_TEST_SUITE_P(
    RealFiles, Parts,
    ::testing::Values(
        Part{"NIST_MBE_PMI_11.stp", 10, 10, 5474.4792, 1, 0},
        Part{"NIST_MBE_PMI_3.stp", 120, 120, 353029.15, 1, 0},
        Part{"nist_ctc_01_asme1_ap242-e1.stp", 117, 117, 807080.82, 1, 0},
        Part{"nist_stc_06_asme1_ap242-e3.stp", 144, 144, 283414.45, 1, 0},
        Part{"ExpansionCard_ThreadedInsert.stp", 259, 291, 4962.9055, 4, 0},
        Part{"propeller_and_shaft.iges", 22, 22, 283810.44, 0, 0}, Part{"tip.iges", 1, 1, 30.436424, 0, 0},
        Part{"c172.igs", 6, 6, 0, 0, 0}, Part{"geo_example_screwed.igs", 6, 6, 7991.2815, 0, 0},
        Part{"fuse.igs", 5, 5, 13048.099, 0, 0}, Part{"IEA_15MW_CFD.igs", 3, 3, 1.0997968e9, 0, 0},
        Part{"nacelle.stp", 6, 6, 10920037, 0, 0}, Part{"D150WithGuides_wing.igs", 8, 8, 1.3202799e8, 1, 0},
        Part{"boxed_sphere.step", 192, 192, 823.62601, 2, 0},
        Part{"revolved_sphere.step", 1, 1, 314.15927, 1, 0}, Part{"332_file.stp", 7, 7, 7077.9634, 3, 0},
        Part{"cube.iges", 6, 6, 600, 0, 0}, Part{"instances_4096_3level.step", 395, 404480, 0, 4, 0},
        Part{"Gs037.stp", 1, 1, 0, 0, 1}),
    [](const auto& info) {
      std::string name = info.param.file;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

struct Broken {
  const char* file;
  std::size_t faces, lost;  // 0 faces: refused
  ErrorCode code;
  const char* sentence;  // part of the error, or of the reason of the first loss
};

void PrintTo(const Broken& b, std::ostream* out) {
  *out << b.file;
}

class BrokenFiles : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenFiles, GiveWhatCanBeSavedOrASentence) {
  const Broken& broken = GetParam();
  const std::string path = CadFile(std::string("broken/") + broken.file);
  if (path.empty())
    GTEST_SKIP() << "FACETLESS_CAD names no folder with " << broken.file << ", which is not tested";
  const Result<Conversion> conversion = ConvertFile(path);
  if (broken.faces == 0) {
    ASSERT_FALSE(conversion.ok());
    EXPECT_EQ(conversion.error().code, broken.code);
    EXPECT_NE(conversion.error().message.find(broken.sentence), std::string::npos)
        << conversion.error().message;
    return;
  }
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  const Model& model = conversion.value().model;
  EXPECT_TRUE(Validate(model).ok());
  EXPECT_EQ(model.faces.size(), broken.faces);
  EXPECT_EQ(model.info.faces_lost.size(), broken.lost);
  for (const Loss& loss : model.info.faces_lost) {
    EXPECT_EQ(loss.entity[0], '#');
    EXPECT_FALSE(loss.reason.empty());
  }
  // A solid that has lost a face, a bound or an edge must not be closed.
  if (broken.lost + model.info.loops_lost.size() + model.info.edges_lost.size() > 0) {
    for (const Solid& solid : model.solids) EXPECT_FALSE(solid.closed);
  }
}

INSTANTIATE_TEST_SUITE_P(
    RealFiles, BrokenFiles,
    ::testing::Values(Broken{"Gn002.stp", 0, 0, ErrorCode::kNothingUsable, "no face"},
                      Broken{"M018.stp", 0, 0, ErrorCode::kNothingUsable, "no face"},
                      Broken{"Le015.stp", 0, 0, ErrorCode::kNothingUsable, "apostrophe"},
                      Broken{"U008.stp", 0, 0, ErrorCode::kNothingUsable, "no face"},
                      Broken{"Pmi049.stp", 0, 0, ErrorCode::kNothingUsable, "tessellat"},
                      Broken{"truncated_half.step", 0, 0, ErrorCode::kNothingUsable, "cut off"},
                      Broken{"truncated_mid_token.igs", 1, 0, {}, ""},
                      Broken{"empty.step", 0, 0, ErrorCode::kFormatUnknown, "empty"},
                      Broken{"bom_crlf.step", 10, 0, {}, ""}, Broken{"nul_bytes.step", 10, 0, {}, ""},
                      Broken{"weights_all_zero.step", 9, 1, {}, ""},
                      Broken{"knots_decreasing.step", 9, 1, {}, ""}, Broken{"degree_250.step", 9, 1, {}, ""},
                      Broken{"coords_nan_token.step", 0, 0, ErrorCode::kNotFinite, "#277"},
                      Broken{"dangling_refs.step", 1, 9, {}, ""}, Broken{"self_ref_cycle.step", 8, 2, {}, ""},
                      Broken{"assembly_self_cycle.step", 10, 0, {}, ""},
                      Broken{"fuzz_step_2.step", 5, 5, {}, ""},
                      Broken{"fuzz_iges_1.igs", 0, 0, ErrorCode::kNotFinite, "entity D3"},
                      Broken{"fuzz_iges_2.igs", 0, 0, ErrorCode::kNotFinite, "entity D3"},
                      Broken{"p128_count_2147483647.igs", 0, 0, ErrorCode::kFormatBroken, "D3"},
                      Broken{"html_named.step", 0, 0, ErrorCode::kFormatUnknown, "web page"}),
    [](const auto& info) {
      std::string name = info.param.file;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

}  // namespace
}  // namespace facetless
