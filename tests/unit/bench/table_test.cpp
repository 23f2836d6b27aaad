#include "bench/table.h"

#include <gtest/gtest.h>

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
