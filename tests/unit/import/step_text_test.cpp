// STEP as text: declared faces, tokens that are not finite numbers, texts, files that are cut off.
#include "import/step_text.h"

#include <gtest/gtest.h>

namespace facetless {
namespace {

std::string File(const std::string& data) {
  return "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 3 1 1 "
         "}'));\nENDSEC;\nDATA;\n" +
         data + "ENDSEC;\nEND-ISO-10303-21;\n";
}

StepFacts Scan(const std::string& text) {
  Result<StepFacts> facts = ScanStep("a.step", text);
  EXPECT_TRUE(facts.ok()) << facts.error().message;
  return facts.ok() ? std::move(facts.value()) : StepFacts{};
}

TEST(StepText, CountsTheFacesThatAreDeclared) {
  const StepFacts facts =
      Scan(File("#1=ADVANCED_FACE('top',(#2),#3,.T.);\n"
                "/* #9=ADVANCED_FACE('in a comment',(#2),#3,.T.); */\n"
                "#4 = FACE_SURFACE('it''s',(#2),#3,.F.);\n#5=PRODUCT('ADVANCED_FACE(','',$,());\n"));
  ASSERT_EQ(facts.faces.size(), 2u);
  EXPECT_EQ(facts.faces[0].id, 1u);
  EXPECT_EQ(facts.faces[0].name, "top");
  EXPECT_EQ(facts.faces[1].id, 4u);
  EXPECT_EQ(facts.faces[1].name, "it's");
  EXPECT_EQ(facts.entities, 3u);
  EXPECT_EQ(facts.schema, "AUTOMOTIVE_DESIGN");
  EXPECT_EQ(StepFormatName(facts.schema), "STEP AP214");
  EXPECT_FALSE(facts.cut_off);
}

TEST(StepText, ANumberThatIsNoneNamesItsEntity) {
  for (const std::string token :
       {"NAN", "nan", "-inf", "Infinity", "1.#IND", "1.#QNAN", "1.E300", "-2.5e+151", "1.E99999999999"}) {
    const Result<StepFacts> facts = ScanStep(
        "a.step", File("#1=DIRECTION('',(1.,0.,0.));\n#77=CARTESIAN_POINT('',(0.," + token + ",1.E-3));\n"));
    ASSERT_FALSE(facts.ok()) << token;
    EXPECT_EQ(facts.error().code, ErrorCode::kNotFinite);
    EXPECT_NE(facts.error().message.find("#77"), std::string::npos);
  }
  // These are names, enumerators and exponents, which are allowed.
  Scan(File("#1=CARTESIAN_POINT('NAN',(1.E5,2.E+100,INFO(2.)));\n#2=X(.NAN.,.INF.,1.E-400);\n"));
}

TEST(StepText, ListsInTooManyListsNameTheirEntity) {
  const auto nested = [](int depth) {
    return File("#77=X(" + std::string(depth, '(') + "1." + std::string(depth, ')') + ");\n");
  };
  Scan(nested(100));
  const Result<StepFacts> facts = ScanStep("a.step", nested(1'000'000));
  ASSERT_FALSE(facts.ok());
  EXPECT_EQ(facts.error().code, ErrorCode::kFormatBroken);
  EXPECT_NE(facts.error().message.find("#77"), std::string::npos);
  // Parentheses in texts do not count.
  Scan(File("#77=X('" + std::string(1000, '(') + "');\n"));
}

TEST(StepText, AnOrientedEdgeOfItselfIsRefused) {
  const auto edges = [](const std::string& last) {
    return File("#1=ORIENTED_EDGE('',*,*,#2,.T.);\n#2=ORIENTED_EDGE('',*,*," + last +
                ",.F.);\n#3=EDGE_CURVE('',#4,#4,#5,.T.);\n");
  };
  Scan(edges("#3"));
  for (const char* last : {"#1", "#2"}) {
    const Result<StepFacts> facts = ScanStep("a.step", edges(last));
    ASSERT_FALSE(facts.ok());
    EXPECT_EQ(facts.error().code, ErrorCode::kFormatBroken);
    EXPECT_NE(facts.error().message.find("oriented edge #"), std::string::npos);
  }
}

TEST(StepText, ACutOffFileEndsAfterItsLastWholeEntity) {
  const std::string whole = File("#1=A('x');\n#2=B('y');\n");
  const std::size_t half = whole.find("'y'");
  const StepFacts facts = Scan(whole.substr(0, half + 2));
  EXPECT_TRUE(facts.cut_off);
  EXPECT_EQ(facts.last_entity, 1u);
  EXPECT_TRUE(whole.substr(0, facts.complete_bytes).ends_with("#1=A('x');"));
}

TEST(StepText, AStrayApostropheSpoilsOneEntityOnly) {
  const StepFacts facts = Scan(File("#1=A('x);\n#2=ADVANCED_FACE('b',(#3),#4,.T.);\n"));
  EXPECT_EQ(facts.open_strings, 1u);
  ASSERT_EQ(facts.faces.size(), 1u);
  EXPECT_EQ(facts.faces[0].id, 2u);
}

TEST(StepText, WithoutDataThereIsNothingToRead) {
  const Result<StepFacts> facts = ScanStep("a.step", "ISO-10303-21;\nHEADER;\n");
  ASSERT_FALSE(facts.ok());
  EXPECT_EQ(facts.error().code, ErrorCode::kFormatBroken);
}

TEST(StepText, TextsAreDecoded) {
  EXPECT_EQ(DecodeStepText("plain"), "plain");
  EXPECT_EQ(DecodeStepText("\\X2\\00DC\\X0\\ber"), "Über");
  EXPECT_EQ(DecodeStepText("\\X2\\7D447ACB\\X0\\!"), "組立!");
  EXPECT_EQ(DecodeStepText("\\X2\\D83DDE00\\X0\\"), "😀");
  EXPECT_EQ(DecodeStepText("\\X4\\0001F600\\X0\\"), "😀");
  EXPECT_EQ(DecodeStepText("\\X\\DCber"), "Über");
  EXPECT_EQ(DecodeStepText("\\S\\\\ber"), "Über");
  EXPECT_EQ(DecodeStepText("a\\\\b"), "a\\b");
  EXPECT_EQ(DecodeStepText("Über"), "Über");
  EXPECT_EQ(DecodeStepText("\xdc"
                           "ber"),
            "Über");
  EXPECT_EQ(DecodeStepText("  NONE "), "");
  EXPECT_EQ(DecodeStepText("\\X2\\00"), "\\X2\\00") << "what is broken stays";
}

}  // namespace
}  // namespace facetless
