// Tests that the importer and OpenCASCADE's own reader are measured on the same file.
#include "server/run/bench_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/importer/plain_read.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;

class BenchImport : public testing::Test {
 protected:
  ImportRequest Request(const std::string& input) const {
    ImportRequest request;
    request.input = input;
    request.temp_parent = scratch_.path();
    return request;
  }
  TempDir directory_ = TempDir::Create().value(), scratch_ = TempDir::Create().value();
};

TEST_F(BenchImport, MeasuresBothConfigurationsOfStepAndIges) {
  for (const char* sample : {"bracket.step", "trimmed.iges"}) {
    const auto values = MeasureImport(sample, Request(Sample(sample)), 2);
    ASSERT_TRUE(values.ok()) << values.error().message;
    ASSERT_EQ(values.value().size(), 2u);
    for (const BenchValue& value : values.value()) {
      EXPECT_EQ(value.skipped, "") << sample;
      EXPECT_EQ(value.file, sample);
      EXPECT_GT(value.direct, 0);
      EXPECT_GT(value.other, 0);
      EXPECT_GT(value.ratio, 0);
      EXPECT_EQ(value.repetitions, 2);
    }
    EXPECT_EQ(values.value()[0].aim, "import");
    EXPECT_EQ(values.value()[1].aim, "import_unhealed");
    EXPECT_EQ(values.value()[0].direct, values.value()[1].direct);
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "temporary files were left behind";
}

TEST_F(BenchImport, SaysWhyOpenCascadeCannotBeMeasured) {
  const auto absent = ReadPlainly(Request(directory_.File("absent.step")), PlainHealing::kDefault);
  ASSERT_FALSE(absent.ok());
  EXPECT_EQ(absent.error().code, ErrorCode::kFileUnreadable);
  const std::string text = WriteText(directory_.File("text.step"), "no part\n");
  const auto unread = ReadPlainly(Request(text), PlainHealing::kNone);
  ASSERT_FALSE(unread.ok());
  EXPECT_EQ(unread.error().code, ErrorCode::kNothingUsable);
  EXPECT_THAT(unread.error().message, HasSubstr("OpenCASCADE's reader fails"));
}

}  // namespace
}  // namespace facetless
