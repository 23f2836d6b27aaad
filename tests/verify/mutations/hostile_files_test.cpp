// Files that are made by hand to do harm, which mutations would hardly produce. The real importer must give
// one clear answer to each, in bounded time and memory. Hostile meshes and model files are in
// tests/unit/baseline/mesh_file_test and tests/unit/model/model_file_test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "sandbox/file_access.h"
#include "server/importer/import_process.h"
#include "tests/unit/server/support.h"
#include "tests/verify/mutations/judge.h"

namespace facetless {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

const char* const kStepHead =
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
    "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n";
const char* const kStepTail = "ENDSEC;\nEND-ISO-10303-21;\n";

std::string Step(const std::string& data) {
  return kStepHead + data + kStepTail;
}

// Returns `text` with the first `from` after `after` replaced by `to`.
std::string Replaced(std::string text, const std::string& from, const std::string& to,
                     const std::string& after = "") {
  const std::size_t at = text.find(from, after.empty() ? 0 : text.find(after));
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

// An IGES file whose entities have one directory pair and one line of parameters each.
struct IgesRecord {
  int type;
  std::string parameters;
  int transformation = 0;
};
std::string Iges(const std::vector<IgesRecord>& records) {
  const auto line = [](std::string text, std::size_t width, char section, std::size_t number) {
    text.resize(width, ' ');
    const std::string digits = std::to_string(number);
    return text + section + std::string(7 - digits.size(), '0') + digits + "\n";
  };
  const auto field = [](std::int64_t value) {
    const std::string digits = std::to_string(value);
    return digits.size() < 8 ? std::string(8 - digits.size(), ' ') + digits : digits;
  };
  std::string start = line("", 72, 'S', 1);
  std::string global = line("1H,,1H;,1Ht,1Ht,1Ht,1Ht,32,308,15,308,15,1Ht,1.,2,2HMM,1,0.01,", 72, 'G', 1) +
                       line("15H20260101.000000,1E-07,100.,1Ha,1Hb,11,0,15H20260101.000000;", 72, 'G', 2);
  std::string directory, parameter;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto number = static_cast<std::int64_t>(i) + 1;
    directory += line(field(records[i].type) + field(number) + field(0) + field(0) + field(0) + field(0) +
                          field(records[i].transformation) + field(0) + "00000000",
                      72, 'D', 2 * i + 1);
    directory += line(field(records[i].type) + field(0) + field(0) + field(1) + field(0), 72, 'D', 2 * i + 2);
    std::string text = records[i].parameters;
    text.resize(64, ' ');
    parameter += line(text + field(2 * number - 1), 72, 'P', i + 1);
  }
  const auto count = [](std::size_t n) {
    const std::string digits = std::to_string(n);
    return std::string(7 - digits.size(), '0') + digits;
  };
  const std::string end =
      "S" + count(1) + "G" + count(2) + "D" + count(2 * records.size()) + "P" + count(records.size());
  return start + global + directory + parameter + line(end, 72, 'T', 1);
}

class HostileFiles : public testing::Test {
 protected:
  // Returns the answer, which must not be an offence.
  Verdict Answer(const std::string& name, const std::string& bytes) {
    const JudgeLimits limits{30, 4096};
    Verdict verdict = JudgeImport(WriteText(directory_.File(name), bytes), limits);
    EXPECT_EQ(verdict.offence, "") << name << ": " << verdict.message;
    return verdict;
  }
  // Checks that the answer is an error that says what is wrong with the file, and no crash.
  void ExpectRefused(const std::string& name, const std::string& bytes) {
    const Verdict verdict = Answer(name, bytes);
    EXPECT_THAT(verdict.status, AnyOf("format-broken", "nothing-usable", "not-finite", "limit-exceeded"))
        << name << ": " << verdict.message;
    EXPECT_THAT(verdict.message, HasSubstr(name));
    EXPECT_LT(verdict.message.size(), 600u);
  }
  TempDir directory_ = TempDir::Create().value();
};

TEST_F(HostileFiles, StepWithListsInAMillionLists) {
  constexpr std::size_t kDepth = 1'000'000;
  ExpectRefused("nested.step", Step("#1=CARTESIAN_POINT(''," + std::string(kDepth, '(') + "0." +
                                    std::string(kDepth, ')') + ");\n"));
  ExpectRefused("open.step", Step("#1=CARTESIAN_POINT(''," + std::string(kDepth, '(')));
}

TEST_F(HostileFiles, StepWithAChainOfReferences) {
  // A million was tried by hand, and takes a quarter of a minute.
  constexpr int kLength = 200'000;
  std::string data;
  for (int i = 1; i <= kLength; ++i)
    data += "#" + std::to_string(i) + "=ORIENTED_CLOSED_SHELL('',*,#" + std::to_string(i + 1) + ",.T.);\n";
  data += "#" + std::to_string(kLength + 1) + "=CLOSED_SHELL('',());\n#" + std::to_string(kLength + 2) +
          "=MANIFOLD_SOLID_BREP('',#1);\n";
  ExpectRefused("chain.step", Step(data));
}

TEST_F(HostileFiles, StepAssembliesThatHoldThemselves) {
  const std::string assembly = ReadText(Sample("assembly.step"));
  const std::size_t at = assembly.find("NEXT_ASSEMBLY_USAGE_OCCURRENCE");
  ASSERT_NE(at, std::string::npos);
  // Replace every usage's part by its assembly.
  std::string cycle = assembly;
  for (std::size_t usage = 0;
       (usage = cycle.find("NEXT_ASSEMBLY_USAGE_OCCURRENCE", usage)) != std::string::npos; ++usage) {
    const std::size_t first = cycle.find('#', usage), first_end = cycle.find(',', first);
    const std::size_t second = cycle.find('#', first_end), second_end = cycle.find_first_of(",)", second);
    cycle.replace(second, second_end - second, cycle.substr(first, first_end - first));
  }
  const Verdict verdict = Answer("cycle.step", cycle);
  EXPECT_THAT(verdict.status, Not("importer-crashed")) << verdict.message;
}

TEST_F(HostileFiles, StepThatClaimsABillion) {
  const std::string sheet = ReadText(Sample("wavy_sheet.step"));
  const std::string surface = "B_SPLINE_SURFACE_WITH_KNOTS";
  ASSERT_NE(sheet.find(surface), std::string::npos);
  const std::size_t at = sheet.find(surface);
  const std::size_t degree = sheet.find(',', at) + 1;
  for (const char* huge : {"1000000000", "2147483647", "-2147483648", "99999999999999999999", "250"}) {
    std::string text = sheet;
    text.replace(degree, text.find(',', degree) - degree, huge);
    const Verdict verdict = Answer("degree.step", text);
    EXPECT_THAT(verdict.status, AnyOf("ok", "format-broken", "nothing-usable", "limit-exceeded"))
        << huge << ": " << verdict.message;
  }
  ExpectRefused("numbers.step", Step("#99999999999999999999999=CARTESIAN_POINT('',(0.,0.,0.));\n"
                                     "#4294967297=CARTESIAN_POINT('',(0.,0.,0.));\n#0=X();\n#-1=X();\n"));
}

TEST_F(HostileFiles, StepWithTextsOfMegabytes) {
  const std::string sphere = ReadText(Sample("sphere.step"));
  const std::string name =
      Replaced(sphere, "PRODUCT('sphere'", "PRODUCT('" + std::string(32 << 20, 'x') + "'");
  EXPECT_THAT(Answer("name.step", name).status, AnyOf("ok", "format-broken", "limit-exceeded"));
  const std::string face =
      Replaced(sphere, "ADVANCED_FACE(''", "ADVANCED_FACE('" + std::string(4 << 20, '\\') + "'");
  EXPECT_THAT(Answer("face.step", face).status, AnyOf("ok", "format-broken", "limit-exceeded"));
  ExpectRefused("string.step", Step("#1=CARTESIAN_POINT('" + std::string(16 << 20, 'x')));
  ExpectRefused("comment.step", Step("/*" + std::string(16 << 20, '*')));
  ExpectRefused("word.step", Step("#1=" + std::string(16 << 20, 'A') + "();\n"));
  ExpectRefused("digits.step", Step("#1=CARTESIAN_POINT('',(" + std::string(16 << 20, '1') + ".,0.,0.));\n"));
}

TEST_F(HostileFiles, StepThatNamesOtherFilesReadsNone) {
  if (LandlockVersion() == 0)
    GTEST_SKIP() << "this kernel has no Landlock, so files of the same user remain readable";
  // The assembly refers to a part in a file that belongs to another user.
  const std::string other = WriteText(directory_.File("other.step"), ReadText(Sample("torus.step")));
  const std::string references =
      "#900=DOCUMENT_FILE('" + other +
      "','','',#901,'',$);\n#901=DOCUMENT_TYPE('geometry');\n"
      "#902=APPLIED_DOCUMENT_REFERENCE(#900,'',(#5));\n#903=DOCUMENT_REPRESENTATION_TYPE('digital',#900);\n"
      "#904=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('" +
      other +
      "',#905,#906,(#900));\n"
      "#905=IDENTIFICATION_ROLE('external document id and location','');\n#906=EXTERNAL_SOURCE(IDENTIFIER('" +
      other +
      "'));\n#907=PROPERTY_DEFINITION('external definition','',#900);\n"
      "#908=PROPERTY_DEFINITION_REPRESENTATION(#907,#909);\n#909=REPRESENTATION('document format',(),#27);\n";
  const std::string sphere = ReadText(Sample("sphere.step"));
  const std::string text = Replaced(sphere, "ENDSEC;\nEND-ISO", references + "ENDSEC;\nEND-ISO");
  ImportRequest request;
  request.input = WriteText(directory_.File("reference.step"), text);
  auto files = RunImporter(request);
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_EQ(files.value().answer.at("faces"), 1);
}

TEST_F(HostileFiles, IgesThatRefersToItself) {
  // A subfigure that contains an instance of itself.
  ExpectRefused("subfigure.igs", Iges({{308, "308,0,1Ha,1,3;"}, {408, "408,1,0.,0.,0.,1.;"}}));
  // Matrices that transform each other.
  ExpectRefused("matrix.igs", Iges({{124, "124,1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.;", 3},
                                    {124, "124,1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.;", 1},
                                    {110, "110,0.,0.,0.,1.,1.,1.;", 1}}));
  // A trimmed surface, groups and composite curves that contain themselves.
  ExpectRefused("trimmed.igs", Iges({{144, "144,1,1,0,1;"}}));
  ExpectRefused("group.igs", Iges({{402, "402,2,1,3;"}, {402, "402,1,1;"}}));
  ExpectRefused("composite.igs", Iges({{102, "102,2,1,3;"}, {102, "102,1,1;"}}));
  ExpectRefused("offset.igs", Iges({{140, "140,0.,0.,1.,1.,1;"}}));
  ExpectRefused(
      "shell.igs",
      Iges({{186, "186,3,1,0;"}, {514, "514,1,5,1;"}, {510, "510,5,1,1,7;"}, {508, "508,1,0,1,1,1,0;"}}));
}

TEST_F(HostileFiles, IgesThatClaimsABillion) {
  for (const char* count : {"2147483647", "-2147483648", "1000000000", "-1"}) {
    const std::string n = count;
    ExpectRefused("surface.igs", Iges({{128, "128," + n + "," + n + ",3,3,0,0,1,0,0,0.,1.;"}}));
    ExpectRefused("curve.igs", Iges({{126, "126," + n + ",3,0,0,1,0,0.,1.;"}}));
    ExpectRefused("group.igs", Iges({{402, "402," + n + ",1;"}}));
    ExpectRefused("copious.igs", Iges({{106, "106,2," + n + ",0.,0.,0.;"}}));
    ExpectRefused("spline.igs", Iges({{114, "114,3,0," + n + "," + n + ",0.,1.;"}}));
    ExpectRefused("composite.igs", Iges({{102, "102," + n + ",1;"}}));
    ExpectRefused("vertices.igs", Iges({{502, "502," + n + ",0.,0.,0.;"}}));
    ExpectRefused("edges.igs", Iges({{504, "504," + n + ",1,1,1,1,1;"}}));
    ExpectRefused("loop.igs", Iges({{508, "508," + n + ",0,1,1,1,0;"}}));
    ExpectRefused("boundary.igs", Iges({{141, "141,0,1,1," + n + ",1,1,0;"}}));
  }
}

TEST_F(HostileFiles, IgesWithTextsThatLie) {
  ExpectRefused("hollerith.igs", Iges({{406, "406,1,999999999Hx;"}}));
  ExpectRefused("negative.igs", Iges({{406, "406,1,-5Hx;"}}));
  std::string global = Iges({{110, "110,0.,0.,0.,1.,1.,1.;"}});
  ExpectRefused("delimiters.igs", Replaced(global, "1H,,1H;,", "1H;,1H;,"));
  ExpectRefused("global.igs", Replaced(global, "1Ht,", "99999999H,"));
}

}  // namespace
}  // namespace facetless
