// Texts of STEP files: every spelling of a letter that programs write is decoded to that letter, by our
// reader and by OpenCASCADE.
#include "import/step_strings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace facetless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Spelling {
  const char* raw;
  const char* text;
};

TEST(DecodeStepText, KnowsEveryDirective) {
  for (const auto& [raw, text] : {
           Spelling{"plain", "plain"},
           {"Petit \\X\\E9tui", "Petit étui"},
           {"\\X2\\4F9B7ED97CFB7EDF\\X0\\", "供给系统"},
           {"\\X4\\0001F600\\X0\\", "😀"},
           {"\\X2\\D83DDE00\\X0\\", "😀"},  // a surrogate pair
           {"Geh\\S\\duse", "Gehäuse"},
           {"\\PE\\\\S\\2", "В"},  // ISO 8859-5
           {"\\PA\\Geh\\S\\duse", "Gehäuse"},
           {"a\\\\b", "a\\b"},
           {"Gehäuse", "Gehäuse"},
           {"Geh\xe4use", "Gehäuse"},  // ISO 8859-1
           {"two\nlines", "twolines"},
           {"  NONE ", ""},
           {"$", ""},
       })
    EXPECT_EQ(DecodeStepText(raw), text) << raw;
}

TEST(DecodeStepText, LeavesWhatIsBrokenAsItIsWritten) {
  for (const char* raw :
       {"\\X2\\4F9B", "\\X2\\4F9\\X0\\", "\\X4\\0001F6\\X0\\", "\\X\\G1", "\\Q", "\\S\\", "a\\"})
    EXPECT_EQ(DecodeStepText(raw), raw);
}

TEST(DecodeStepText, LetsNoControlCharacterThrough) {
  for (int code = 0; code < 0xa0; ++code) {
    if (code >= 0x20 && code < 0x7f) continue;
    char directive[16];
    std::snprintf(directive, sizeof directive, "a\\X2\\%04X\\X0\\b", static_cast<unsigned>(code));
    const std::string text = DecodeStepText(directive);
    for (const char c : text) EXPECT_GE(static_cast<unsigned char>(c), 0x20) << code;
    EXPECT_EQ(text.front(), 'a');
    EXPECT_EQ(text.back(), 'b');
  }
  EXPECT_EQ(DecodeStepText("a\x1b[31m"), "a\xef\xbf\xbd[31m");
  EXPECT_EQ(DecodeStepText("\\X2\\D83D\\X0\\"), "\xef\xbf\xbd");  // half of a surrogate pair
}

std::string Normalised(std::string bytes, std::vector<std::string>* warnings) {
  NormaliseStepTexts(bytes, warnings);
  return bytes;
}

TEST(NormaliseStepTexts, WritesInAsciiWhatAnotherReaderCouldMistake) {
  std::vector<std::string> warnings;
  EXPECT_EQ(Normalised("#1=PRODUCT('Gehäuse','it''s','');", &warnings),
            "#1=PRODUCT('Geh\\X2\\00E4\\X0\\use','it''s','');");
  EXPECT_EQ(Normalised("#1=A('\\S\\d''\\X\\E9');", &warnings), "#1=A('\\X2\\00E4\\X0\\''\\X2\\00E9\\X0\\');");
  EXPECT_EQ(Normalised("#1=A('😀ä');", &warnings), "#1=A('\\X4\\0001F600\\X0\\\\X2\\00E4\\X0\\');");
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(NormaliseStepTexts, LeavesTheRestOfTheFileAlone) {
  std::vector<std::string> warnings;
  for (const char* text : {"#1=PLAIN('text',$,(1.,2.));", "/* it's ä comment */#1=A('x');",
                           "#1=A('not ended ä", "#1=A('\\X2\\00E4\\X0\\ and \\\\');"}) {
    std::string bytes = text;
    EXPECT_FALSE(NormaliseStepTexts(bytes, &warnings)) << text;
    EXPECT_EQ(bytes, text);
  }
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(NormaliseStepTexts, SaysWhatItGuessedReplacedOrFoundBroken) {
  const auto warnings_of = [](const std::string& bytes) {
    std::vector<std::string> warnings;
    std::string copy = bytes;
    NormaliseStepTexts(copy, &warnings);
    return warnings;
  };
  EXPECT_THAT(warnings_of("#7=A('Geh\xe4use');"),
              ElementsAre("The text of #7 is not UTF-8, and was read as ISO 8859-1."));
  EXPECT_THAT(warnings_of("#7=A('\x95\\\x8e\xa6\x83\\\x83t\x83g');"), ElementsAre(HasSubstr("Shift-JIS")));
  EXPECT_THAT(warnings_of("#7=A('\xd7\xcb\xcc\xac\xbf\xd8\xd6\xc6');"), ElementsAre(HasSubstr("GBK")));
  EXPECT_THAT(warnings_of("#7=A('a\x1b');#8=B('\x07');"),
              ElementsAre(HasSubstr("2 texts (the first in #7) has control characters")));
  EXPECT_THAT(warnings_of("#7=A('\\X2\\00');"), ElementsAre(HasSubstr("#7 has a control directive")));
}

TEST(NormaliseStepTexts, ReadsDoubleByteTexts) {
  std::vector<std::string> warnings;
  std::string sjis = "#7=A('\x95\\\x8e\xa6\x83\\\x83t\x83g');";
  ASSERT_TRUE(NormaliseStepTexts(sjis, &warnings));
  EXPECT_EQ(DecodeStepText(sjis.substr(6, sjis.size() - 9)), "表示ソフト");
  std::string gbk = "#7=A('\xd7\xcb\xcc\xac\xbf\xd8\xd6\xc6');";
  ASSERT_TRUE(NormaliseStepTexts(gbk, &warnings));
  EXPECT_EQ(DecodeStepText(gbk.substr(6, gbk.size() - 9)), "姿态控制");
}

}  // namespace
}  // namespace facetless
