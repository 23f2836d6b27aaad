#include "bench/table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace facetless {
namespace {

TEST(Table, IsReadableAsTextAndAsMarkdown) {
  const Table table{"Title", {"file", "ratio"}, {{"a.step", "12.3×"}, {"long name", "1×"}}, {"A note."}};
  EXPECT_EQ(TableText(table, TableStyle::kText),
            "Title\n\n"
            "file       ratio\n"
            "a.step     12.3×\n"
            "long name     1×\n"
            "\nA note.\n\n");
  EXPECT_EQ(TableText(table, TableStyle::kMarkdown),
            "### Title\n\n"
            "| file | ratio |\n"
            "|---|--:|\n"
            "| a.step | 12.3× |\n"
            "| long name | 1× |\n"
            "\nA note.\n\n");
}

TEST(Table, NotesOfMarkdownAreWrappedAt120Columns) {
  std::string note;
  for (int i = 0; i < 60; ++i) note += (i == 0 ? "" : " ") + std::string("µ-word");
  const std::string wrapped = Wrapped(note);
  std::istringstream lines(wrapped);
  std::string joined;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 120u + 17) << "one byte more for each µ";
    joined += (joined.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(joined, note) << "nothing but line breaks was added";
  EXPECT_EQ(std::count(wrapped.begin(), wrapped.end(), '\n'), 3) << "17 words fit into a line";
  const Table table{"Title", {"file"}, {{"a.step"}}, {note}};
  EXPECT_NE(TableText(table, TableStyle::kMarkdown).find(wrapped), std::string::npos);
  EXPECT_NE(TableText(table, TableStyle::kText).find(note), std::string::npos);
}

TEST(Table, NumbersHaveThreeDigits) {
  EXPECT_EQ(ThreeDigits(0.012345), "0.0123");
  EXPECT_EQ(ThreeDigits(1.2345), "1.23");
  EXPECT_EQ(ThreeDigits(12345), "12345");
  EXPECT_EQ(ThreeDigits(0), "0");
  EXPECT_EQ(ThreeDigits(-0.5), "-0.500");
  EXPECT_EQ(BytesText(4.5e6), "4.50 MB");
  EXPECT_EQ(MillisecondsText(1500), "1.50 s");
  EXPECT_EQ(RateText(25e6), "25.0 M/s");
}

}  // namespace
}  // namespace facetless
