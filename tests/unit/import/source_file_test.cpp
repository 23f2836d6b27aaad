// Formats are recognised by content; files are repaired, or refused with one sentence.
#include "import/source_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

const std::string kStep =
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));\nENDSEC;\nDATA;\n#1=X();\nENDSEC;\nEND-"
    "ISO-10303-21;\n";

std::string Record(std::string text, char section, int number) {
  text.resize(72, ' ');
  std::string digits = std::to_string(number);
  return text + section + std::string(7 - digits.size(), ' ') + digits + "\n";
}

// A point of type 116 and a bilinear B-spline surface, whose reals are written as integers.
std::string Iges() {
  std::string text =
      Record("start", 'S', 1) +
      Record("1H,,1H;,4HTEST,4HTEST,4HTEST,4HTEST,16,6,15,13,15,4HTEST,1.,2,2HMM,1,0.1,", 'G', 1) +
      Record("15H20260101.000000,0.001,100.,4HTEST,4HTEST,11,0,15H20260101.000000;", 'G', 2);
  text += Record("     128       1       0       0       0       0       0       000000000", 'D', 1);
  text += Record("     128       0       0       1       0                               0", 'D', 2);
  text += Record("128,1,1,1,1,0,0,1,0,0,0,0,1,1,0,0,1,1,1,1,1,1,0,0,0,2,0,0,            1", 'P', 1)
              .replace(64, 8, "       1");
  text += Record("0,3,0,2,3,1,0,1,0,1;", 'P', 2).replace(64, 8, "       1");
  text += Record("S      1G      2D      2P      2", 'T', 1);
  return text;
}

Result<SourceFile> Open(const TemporaryFolder& folder, const std::string& name, const std::string& bytes) {
  return OpenSource(folder.Write(name, bytes), folder.path());
}

std::string Content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

TEST(SourceFile, TheContentTellsTheFormatAndTheExtensionDoesNot) {
  const TemporaryFolder folder;
  EXPECT_EQ(Open(folder, "a.igs", kStep).value().format, CadFormat::kStep);
  EXPECT_EQ(Open(folder, "a.step", Iges()).value().format, CadFormat::kIges);
  EXPECT_EQ(Open(folder, "a.txt", "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n")
                .value()
                .format,
            CadFormat::kBrep);
}

TEST(SourceFile, ASoundFileIsReadWhereItLies) {
  const TemporaryFolder folder;
  const Result<SourceFile> source = Open(folder, "a.step", kStep);
  ASSERT_TRUE(source.ok());
  EXPECT_EQ(source.value().path, folder.File("a.step"));
  EXPECT_TRUE(source.value().repairs.empty());
  EXPECT_EQ(source.value().sha256.size(), 64u);
}

TEST(SourceFile, TheHashIsSha256OfTheUsersBytes) {
  const TemporaryFolder folder;
  // The values come from sha256sum.
  EXPECT_EQ(Open(folder, "x.step", kStep).value().sha256, Open(folder, "y.step", kStep).value().sha256);
  EXPECT_NE(Open(folder, "x.step", kStep).value().sha256,
            Open(folder, "y.step", "\xef\xbb\xbf" + kStep).value().sha256);
}

TEST(SourceFile, MarksAndLineEndsAreRemovedInACopy) {
  const TemporaryFolder folder;
  std::string crlf, cr;
  for (char c : kStep) {
    crlf += c == '\n' ? "\r\n" : std::string(1, c);
    cr += c == '\n' ? '\r' : c;
  }
  for (const std::string& bytes : {"\xef\xbb\xbf" + crlf, cr}) {
    const Result<SourceFile> source = Open(folder, "a.step", bytes);
    ASSERT_TRUE(source.ok()) << source.error().message;
    EXPECT_NE(source.value().path, folder.File("a.step"));
    EXPECT_EQ(Content(source.value().path), kStep);
    EXPECT_EQ(source.value().repairs.size(), 1u);
    EXPECT_EQ(Content(folder.File("a.step")), bytes);  // the user's file must not change
  }
}

TEST(SourceFile, IgesIntegersBecomeReals) {
  const TemporaryFolder folder;
  const Result<SourceFile> source = Open(folder, "a.igs", Iges());
  ASSERT_TRUE(source.ok()) << source.error().message;
  ASSERT_EQ(source.value().repairs.size(), 1u);
  EXPECT_EQ(source.value().repairs[0].substr(0, 3),
            "28 ");  // 4 + 4 knots, 4 weights, 12 coordinates, 4 limits
  // The counts must stay integers, and every record must be 80 columns wide.
  const std::string text = Content(source.value().path);
  EXPECT_NE(text.find("128,1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,"), std::string::npos);
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = text.find('\n', begin);
    EXPECT_EQ(end - begin, 80u);
    begin = end + 1;
  }
  // OpenCASCADE must read the correct face: a rectangle of 2 by 3.
  const Result<Conversion> conversion = ConvertFile(folder.File("a.igs"));
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  ASSERT_EQ(conversion.value().model.faces.size(), 1u);
  EXPECT_EQ(conversion.value().model.info.faces_declared, 1u);
}

TEST(SourceFile, IgesEntitiesWhoseDataAreCutOffAreNamed) {
  const TemporaryFolder folder;
  const std::string whole = Iges();
  EXPECT_TRUE(Open(folder, "a.igs", whole).value().iges.without_data.empty());
  const std::string cut = whole.substr(0, whole.find("0,3,0,2,3,1") + 5);
  const IgesFacts facts = Open(folder, "b.igs", cut).value().iges;
  EXPECT_TRUE(facts.cut_off);
  ASSERT_EQ(facts.without_data.size(), 1u);
  EXPECT_EQ(facts.without_data[0].directory, 1);
  EXPECT_EQ(facts.without_data[0].type, 128);
}

TEST(SourceFile, ClaimsOfMorePointsThanTheFileHoldsAreRefused) {
  const TemporaryFolder folder;
  std::string bytes = Iges();
  bytes.replace(bytes.find("128,1,1,1,1"), 11, "128,2147483647,1,1,1");
  const Result<SourceFile> source = Open(folder, "a.igs", bytes);
  ASSERT_FALSE(source.ok());
  EXPECT_EQ(source.error().code, ErrorCode::kFormatBroken);
  EXPECT_NE(source.error().message.find("D1"), std::string::npos);
}

// Opens Iges() with another entity instead of its surface.
Result<SourceFile> OpenEntity(const TemporaryFolder& folder, const std::string& type,
                              const std::string& parameters) {
  std::string bytes = Iges();
  for (std::size_t at = 0; (at = bytes.find("     128", at)) != std::string::npos;)
    bytes.replace(at + 5, 3, type);
  const std::size_t first = bytes.find("128,1,1,1"), second = bytes.find("0,3,0,2,3,1");
  std::string text = parameters;
  text.resize(64, ' ');
  bytes.replace(first, 64, text);
  bytes.replace(second, 64, std::string(64, ' '));
  return Open(folder, "a.igs", bytes);
}

TEST(SourceFile, OtherClaimsOfMoreThanTheFileHoldsAreRefusedToo) {
  const TemporaryFolder folder;
  for (const auto& [type, parameters] :
       std::vector<std::pair<std::string, std::string>>{{"102", "102,2147483647,1;"},
                                                        {"106", "106,2,1000000000,0.,0.,0.;"},
                                                        {"114", "114,3,0,100000,100000,0.,1.;"},
                                                        {"141", "141,0,1,1,2147483647,1,1,0;"},
                                                        {"502", "502,2147483647,0.,0.,0.;"},
                                                        {"504", "504,-1,1,1,1,1,1;"},
                                                        {"508", "508,2147483647,0,1,1,1,0;"},
                                                        {"514", "514,2147483647,1,1;"}}) {
    const Result<SourceFile> source = OpenEntity(folder, type, parameters);
    ASSERT_FALSE(source.ok()) << parameters;
    EXPECT_EQ(source.error().code, ErrorCode::kFormatBroken) << parameters;
    EXPECT_NE(source.error().message.find("D1 (type " + type + ") claims more"), std::string::npos);
  }
  EXPECT_TRUE(OpenEntity(folder, "106", "106,2,3,0.,0.,0.,1.,0.,0.,1.,1.,0.;").ok());
}

TEST(SourceFile, IgesNumbersThatAreNoneNameTheirEntity) {
  const TemporaryFolder folder;
  for (const std::string token : {"1.E400", "1.D+151", "-2.E99999999999", "nan", "-INF"}) {
    const Result<SourceFile> source = OpenEntity(folder, "110", "110,0.,0.,0.,1.,1.," + token + ";");
    ASSERT_FALSE(source.ok()) << token;
    EXPECT_EQ(source.error().code, ErrorCode::kNotFinite);
    EXPECT_NE(source.error().message.find("D1 (type 110) holds \"" + token), std::string::npos);
  }
  EXPECT_TRUE(OpenEntity(folder, "110", "110,0.,0.,0.,1.E-400,1.D100,3HNAN;").ok());
}

TEST(SourceFile, WordsThatBeginLikeNanOrInfinityAreNoIgesCounts) {
  const TemporaryFolder folder;
  for (const std::string word : {"nano", "NANA", "nan(1)", "INFIN", "-infix"}) {
    EXPECT_TRUE(OpenEntity(folder, "102", "102," + word + ",1;").ok()) << word;
    EXPECT_TRUE(OpenEntity(folder, "130", "130," + word + ",1;").ok()) << word;
  }
}

TEST(SourceFile, AnIgesEntityThatIsMadeOfItselfIsRefused) {
  const TemporaryFolder folder;
  for (const auto& [type, parameters] :
       std::vector<std::pair<std::string, std::string>>{{"140", "140,0.,0.,1.,1.,1;"},
                                                        {"102", "102,1,1;"},
                                                        {"122", "122,1,0.,0.,1.;"},
                                                        {"130", "130,1,1;"}}) {
    const Result<SourceFile> source = OpenEntity(folder, type, parameters);
    ASSERT_FALSE(source.ok()) << parameters;
    EXPECT_EQ(source.error().code, ErrorCode::kFormatBroken);
    EXPECT_NE(source.error().message.find("D1 contains itself"), std::string::npos);
  }
}

struct Refusal {
  const char* what;
  std::string bytes;
  const char* sentence;
};

void PrintTo(const Refusal& r, std::ostream* out) {
  *out << r.what;
}

class Refusals : public ::testing::TestWithParam<Refusal> {};

TEST_P(Refusals, SayWhatItIsAndWhatToDo) {
  const TemporaryFolder folder;
  const Result<SourceFile> source = Open(folder, "a.step", GetParam().bytes);
  ASSERT_FALSE(source.ok());
  EXPECT_EQ(source.error().code, ErrorCode::kFormatUnknown);
  EXPECT_NE(source.error().message.find(GetParam().sentence), std::string::npos) << source.error().message;
}

std::string BinaryStl() {
  std::string bytes(84 + 50, '\0');
  bytes[80] = 1;
  return bytes;
}

INSTANTIATE_TEST_SUITE_P(Formats, Refusals,
                         ::testing::Values(Refusal{"empty", "", "empty"},
                                           Refusal{"html", "<!DOCTYPE HTML><html></html>", "web page"},
                                           Refusal{"glb", "glTF\x02", "--mesh"},
                                           Refusal{"gltf", " { \"asset\": {} }", "--mesh"},
                                           Refusal{"stl", "solid x\n facet normal 0 0 1", "--mesh"},
                                           Refusal{"binary_stl", BinaryStl(), "--mesh"},
                                           Refusal{"obj", "# cube\nv 0 0 0\nv 1 0 0\n", "--mesh"},
                                           Refusal{"ply", "ply\nformat ascii 1.0\n", "--mesh"},
                                           Refusal{"zip", "PK\x03\x04", "unpack"},
                                           Refusal{"gzip", "\x1f\x8b\x08", "unpack"},
                                           Refusal{"noise", "hello", "is not a STEP, IGES or BREP file"}),
                         [](const auto& info) { return info.param.what; });

TEST(SourceFile, WhatCannotBeReadIsSaid) {
  const TemporaryFolder folder;
  EXPECT_EQ(OpenSource(folder.File("absent"), folder.path()).error().code, ErrorCode::kFileUnreadable);
  EXPECT_EQ(OpenSource(folder.path(), folder.path()).error().code, ErrorCode::kFileUnreadable);
}

}  // namespace
}  // namespace facetless
