// Repairs of STEP text: what is removed, what is replaced, what is listed as lost. In addition, the same
// fault in every list of whole files, one by one.
#include "import/step_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "import/step_entities.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

std::string File(const std::string& data) {
  return "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n" + data +
         "ENDSEC;\nEND-ISO-10303-21;\n";
}

std::string ReadAll(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

bool Has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool Warns(const StepRepair& repair, const std::string& part) {
  return std::any_of(repair.warnings.begin(), repair.warnings.end(),
                     [&](const std::string& w) { return Has(w, part); });
}

TEST(StepEntities, KnowTextsCommentsAndSeveralParts) {
  const std::string text = File(
      "#1=A('it''s #9=B(1)',(#2,.T.,$,*),-1.5E2,LENGTH_MEASURE(2.));/* #8=C(); */\n"
      "#2 = ( NAMED_UNIT(*) LENGTH_UNIT() );\n");
  const StepEntities entities(text);
  ASSERT_EQ(entities.all().size(), 2u);
  const auto first = entities.Record(1), second = entities.Record(2);
  ASSERT_TRUE(first && second);
  const std::vector<StepValue>& values = first->parts.front().values;
  ASSERT_EQ(values.size(), 4u);
  EXPECT_EQ(values[0].text, "it''s #9=B(1)");
  ASSERT_EQ(values[1].items.size(), 4u);
  EXPECT_EQ(values[1].items[0].reference, 2u);
  EXPECT_EQ(values[2].Number(0), -150);
  EXPECT_EQ(values[3].Number(0), 2);
  EXPECT_TRUE(second->complex);
  EXPECT_NE(second->Find("LENGTH_UNIT"), nullptr);
  EXPECT_EQ(ToText(*first), "A('it''s #9=B(1)',(#2,.T.,$,*),-1.5E2,LENGTH_MEASURE(2.))");
}

TEST(StepRepair, LeavesASoundFileAlone) {
  for (const char* name : {"bracket.step", "assembly.step", "freeform.step", "torus.step"}) {
    const StepRepair repair = RepairStep(ReadAll(Sample(name)));
    EXPECT_FALSE(repair.changed) << name;
    EXPECT_TRUE(repair.warnings.empty()) << name << ": " << repair.warnings.front();
    EXPECT_TRUE(repair.lost.empty()) << name;
    EXPECT_FALSE(repair.unit_missing) << name;
  }
}

TEST(StepRepair, TakesOutWhatIsEmptyAndAllThatNeedsIt) {
  const StepRepair repair = RepairStep(
      File("#1=EDGE_LOOP('',());\n#2=FACE_OUTER_BOUND('',#1,.T.);\n#3=ADVANCED_FACE('lid',(#2),#9,.T.);\n"
           "#4=ADVANCED_FACE('rest',(#8),#9,.T.);\n#5=CLOSED_SHELL('',(#3,#4));\n#6=OPEN_SHELL('',(#3));\n"
           "#7=SHELL_BASED_SURFACE_MODEL('',(#6));\n"));
  EXPECT_TRUE(repair.changed);
  EXPECT_TRUE(Has(repair.bytes, "#5=CLOSED_SHELL('',(#4));"));
  for (const char* gone : {"#1=", "#2=", "#3=", "#6=", "#7="}) EXPECT_FALSE(Has(repair.bytes, gone)) << gone;
  ASSERT_TRUE(repair.faces_out.contains(3));
  EXPECT_EQ(repair.faces_out.at(3), "its edge loop #1 has no edges");
  EXPECT_FALSE(repair.faces_out.contains(4));
  EXPECT_TRUE(Warns(repair, "#1"));
}

TEST(StepRepair, PutsTheCurveInThePlaceOfWhatIsAboutIt) {
  const StepRepair repair =
      RepairStep(File("#1=EDGE_CURVE('',#8,#9,#2,.T.);\n#2=TRIMMED_CURVE('',#3,(),(),.T.,.PARAMETER.);\n"
                      "#3=SURFACE_CURVE('',#4,(),.CURVE_3D.);\n#4=LINE('',#5,#6);\n"));
  EXPECT_TRUE(Has(repair.bytes, "#1=EDGE_CURVE('',#8,#9,#4,.T.);"));
  EXPECT_TRUE(Warns(repair, "trimmed curve #2"));
  EXPECT_TRUE(Warns(repair, "surface curve #3"));
}

TEST(StepRepair, SortsPartsAndSettlesSenses) {
  const StepRepair repair =
      RepairStep(File("#1=(LENGTH_UNIT()NAMED_UNIT(*)CONVERSION_BASED_UNIT('INCH',#2));\n#3=ORIENTED_EDGE('',"
                      "*,*,#4,.U.);\n"));
  EXPECT_TRUE(Has(repair.bytes, "#1=(CONVERSION_BASED_UNIT('INCH',#2)LENGTH_UNIT()NAMED_UNIT(*));"));
  EXPECT_TRUE(Has(repair.bytes, "#3=ORIENTED_EDGE('',*,*,#4,.T.);"));
  EXPECT_TRUE(Warns(repair, "#1"));
  EXPECT_TRUE(Warns(repair, ".U. for the orientation of oriented edge #3"));
}

TEST(StepRepair, CutsTextsThatAreTooLongForTheReader) {
  for (const std::string& letter : {std::string("A"), std::string("''"), std::string("\xc3\xa4")}) {
    std::string text;
    while (text.size() < 32768) text += letter;
    const StepRepair repair = RepairStep(File("#1=PRODUCT('a','" + text + "',$,());\n"));
    ASSERT_TRUE(repair.changed);
    EXPECT_TRUE(Warns(repair, "in entity #1"));
    const StepEntities entities(repair.bytes);
    const auto record = entities.Record(1);
    ASSERT_TRUE(record) << letter;
    ASSERT_EQ(record->parts.front().values.size(), 4u);
    const std::string_view kept = record->parts.front().values[1].text;
    EXPECT_LT(kept.size(), 16384u);
    EXPECT_GT(kept.size(), 16300u);
    EXPECT_EQ(kept.size() % letter.size(), 0u);
  }
  // Short texts with many apostrophes must stay.
  std::string quoted;
  for (int i = 0; i < 4000; ++i) quoted += "''";
  EXPECT_FALSE(RepairStep(File("#1=PRODUCT('a','" + quoted + "',$,());\n")).changed);
}

TEST(StepRepair, NamesNumbersThatAreUsedTwice) {
  const StepRepair repair =
      RepairStep(File("#1=ADVANCED_FACE('a',(#2),#3,.T.);\n#1=ADVANCED_FACE('b',(#2),#3,.T.);\n#4=LINE('',#5,"
                      "#6);\n#4=LINE('',#5,#6);\n"));
  ASSERT_EQ(repair.lost.size(), 1u);
  EXPECT_EQ(repair.lost[0].name, "b");
  EXPECT_TRUE(Warns(repair, "#1 is defined twice"));
  EXPECT_TRUE(Warns(repair, "#4 is written twice"));
  EXPECT_FALSE(Has(repair.bytes, "'b'"));
}

TEST(StepRepair, OpensScopes) {
  std::string text = File("#5=&SCOPE #6=P(1.); ENDSCOPE /#6/ Q(#6);\n#7=R('&SCOPE');\n");
  EXPECT_EQ(FlattenScopes(text), 1u);
  const StepEntities entities(text);
  ASSERT_EQ(entities.all().size(), 3u);
  EXPECT_EQ(entities.Find(5)->keyword, "Q");
  EXPECT_EQ(entities.Find(6)->keyword, "P");
}

TEST(StepRepair, RefusesDecimalCommas) {
  EXPECT_TRUE(Has(RepairStep(File("#1=CARTESIAN_POINT('',(0,5,1,25,3,0));\n")).refusal, "#1"));
  const StepRepair four = RepairStep(File("#1=CARTESIAN_POINT('',(0.,5.,1.,25.));\n"));
  EXPECT_TRUE(four.refusal.empty());
  EXPECT_TRUE(Warns(four, "#1 has 4 coordinates"));
}

TEST(StepRepair, KnowsUnitsThatCanBeRead) {
  const auto missing = [](const std::string& units) {
    return RepairStep(File("#1=CLOSED_SHELL('',(#9));\n#2=SHAPE_REPRESENTATION('',(#1),#3);\n"
                           "#3=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#4,#5))"
                           "REPRESENTATION_CONTEXT('',''));\n#4=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,."
                           "RADIAN.));\n" +
                           units))
        .unit_missing;
  };
  const std::string inch = "#5=(CONVERSION_BASED_UNIT('INCH',#6)LENGTH_UNIT()NAMED_UNIT(*));\n";
  const std::string base = "#7=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n";
  EXPECT_FALSE(missing("#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"));
  EXPECT_FALSE(missing("#5=(NAMED_UNIT(*)SI_UNIT($,.METRE.)LENGTH_UNIT());\n"));
  EXPECT_FALSE(missing(inch + "#6=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#7);\n" + base));
  EXPECT_TRUE(missing("")) << "a reference to nothing";
  EXPECT_TRUE(missing("#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.FURLONG.,.METRE.));\n"));
  EXPECT_TRUE(missing("#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,$));\n"));
  EXPECT_TRUE(missing(inch)) << "no factor";
  EXPECT_TRUE(missing(inch + "#6=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE($),#7);\n" + base));
  EXPECT_TRUE(missing(inch + "#6=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#5);\n")) << "made of itself";
}

TEST(StepRepair, LeavesOutSpursButNoSeam) {
  const auto loop = [](const std::string& surface, const std::string& uses, const std::string& end) {
    const StepRepair repair =
        RepairStep(File("#1=ADVANCED_FACE('',(#2),#3,.T.);\n#2=FACE_OUTER_BOUND('',#4,.T.);\n#3=" + surface +
                        ";\n#4=EDGE_LOOP('',(" + uses +
                        "));\n#5=AXIS2_PLACEMENT_3D('',#6,$,$);\n#6=CARTESIAN_POINT('',(0.,0.,0.));\n"
                        "#10=ORIENTED_EDGE('',*,*,#20,.T.);\n#11=ORIENTED_EDGE('',*,*,#21,.T.);\n#12="
                        "ORIENTED_EDGE('',*,*,#21,.F.);\n"
                        "#13=ORIENTED_EDGE('',*,*,#22,.F.);\n#20=EDGE_CURVE('',#30,#30,#40,.T.);\n#21=EDGE_"
                        "CURVE('',#30,#31,#41,.T.);\n"
                        "#22=EDGE_CURVE('',#31,#31,#42,.T.);\n#30=VERTEX_POINT('',#32);\n#32=CARTESIAN_POINT("
                        "'',(5.,0.,0.));\n"
                        "#31=VERTEX_POINT('',#33);\n#33=CARTESIAN_POINT(''," +
                        end + ");\n"));
    return Has(repair.bytes, "#4=EDGE_LOOP('',(#10));");
  };
  const std::string beside = "(5.,0.,3.)", on_axis = "(0.,0.,3.)";
  EXPECT_TRUE(loop("CYLINDRICAL_SURFACE('',#5,5.)", "#10,#11,#12", beside));
  EXPECT_TRUE(loop("CYLINDRICAL_SURFACE('',#5,5.)", "#12,#10,#11", beside));
  EXPECT_TRUE(loop("CONICAL_SURFACE('',#5,5.,0.5)", "#10,#11,#12", beside));
  EXPECT_FALSE(loop("CONICAL_SURFACE('',#5,5.,0.5)", "#10,#11,#12", on_axis))
      << "the seam turns back at the apex";
  EXPECT_FALSE(loop("CYLINDRICAL_SURFACE('',#5,5.)", "#10,#11,#13,#12", beside))
      << "a seam between two circles";
  EXPECT_FALSE(loop("B_SPLINE_SURFACE('',#5,5.)", "#10,#11,#12", beside)) << "nobody knows";
}

TEST(StepDeclaredFaces, HaveAnyNameOrNone) {
  const auto faces = DeclaredFaces(File(
      "#1=ADVANCED_FACE($,(#2),#3,.T.);\n#4=FACE_SURFACE('x',(#2),#3,.T.);\n#5=GEOMETRIC_SET('',(#6,#7));\n"
      "#6=PLANE('p',#8);\n#7=LINE('',#8,#9);\n#10=(ADVANCED_FACE()FACE(())FACE_SURFACE(#3,.T.)REPRESENTATION_"
      "ITEM('y'));\n"));
  ASSERT_EQ(faces.size(), 4u);
  EXPECT_EQ(faces[0].name, "");
  EXPECT_EQ(faces[1].name, "x");
  EXPECT_EQ(faces[2].id, 6u);
  EXPECT_TRUE(faces[2].bare);
  EXPECT_EQ(faces[3].name, "y");
}

// Every list of every kind of entity is emptied, one by one. The file must be readable, and everything that
// it declares must be shown or listed as lost.
class EmptyLists : public ::testing::TestWithParam<const char*> {};

// Returns where lists of attributes begin and end, below the entity's own parentheses.
std::vector<std::pair<std::size_t, std::size_t>> ListsIn(std::string_view body) {
  std::vector<std::pair<std::size_t, std::size_t>> lists;
  std::vector<std::size_t> open;
  const std::size_t own = body.starts_with('(') ? 2 : 1;
  bool text = false;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] == '\'') text = !text;
    if (text) continue;
    if (body[i] == '(') open.push_back(i);
    if (body[i] == ')' && !open.empty()) {
      const std::size_t begin = open.back();
      open.pop_back();
      if (open.size() >= own && i > begin + 1) lists.emplace_back(begin, i);
    }
  }
  return lists;
}

TEST_P(EmptyLists, CostWhatDependsOnThem) {
  const std::string whole = ReadAll(Sample(GetParam()));
  const StepEntities entities(whole);
  const TemporaryFolder folder;
  std::unordered_map<std::string, int> seen;
  int tried = 0;
  for (const StepEntity& entity : entities.all()) {
    const std::string_view body = entity.Body(whole);
    int which = 0;
    for (const auto& [begin, end] : ListsIn(body)) {
      std::string kind =
          entity.keyword.empty() ? std::string(body.substr(0, 30)) : std::string(entity.keyword);
      kind += " " + std::to_string(std::min(which++, 12));
      if (++seen[kind] > 1) continue;
      std::string broken = whole;
      broken.erase(entity.body_begin + begin + 1, end - begin - 1);
      const std::string path = folder.File("broken.step");
      std::ofstream(path, std::ios::binary) << broken;
      ++tried;
      const Result<Conversion> conversion = ConvertFile(path);
      if (!conversion.ok()) {
        // If the removed entity contains all faces, all faces may be lost, but they must be named.
        EXPECT_EQ(conversion.error().code, ErrorCode::kNothingUsable)
            << kind << ": " << conversion.error().message;
        continue;
      }
      const ImportInfo& info = conversion.value().model.info;
      EXPECT_EQ(info.faces_declared, info.faces_imported + info.faces_lost.size()) << kind;
      EXPECT_GE(info.faces_declared, entities.all().empty() ? 0 : DeclaredFaces(broken).size()) << kind;
    }
  }
  EXPECT_GT(tried, 10);
}

INSTANTIATE_TEST_SUITE_P(Samples, EmptyLists,
                         ::testing::Values("bracket.step", "cone.step", "freeform.step", "assembly.step"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

}  // namespace
}  // namespace facetless
