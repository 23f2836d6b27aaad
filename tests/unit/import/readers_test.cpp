// Tests the effect of a given unit, which replaces the file's own, on a document.

#include "import/readers.h"

#include <gtest/gtest.h>

#include "import/document.h"
#include "import/source_file.h"
#include "render/base/result.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

class GivenUnit : public testing::Test {
 protected:
  CadDocument Read(const std::string& sample, double unit_mm) {
    PrepareOpenCascade(scratch_.path());
    Result<SourceFile> source = OpenSource(Sample(sample), scratch_.path());
    if (!source.ok()) throw std::runtime_error(source.error().message);
    Result<CadDocument> document = ReadDocument(
        source.value(), [](const char*, double) {}, unit_mm);
    if (!document.ok()) throw std::runtime_error(document.error().message);
    return std::move(document.value());
  }

  const TemporaryFolder scratch_;
};

TEST_F(GivenUnit, ScalesThePrecisionOfTheFile) {
  const CadDocument own = Read("assembly.step", 0);
  ASSERT_TRUE(own.unhealed_mm.has_value());
  ASSERT_GT(*own.unhealed_mm, 0);
  for (const double unit_mm : {25.4, 1000.0, 1e-3}) {
    const CadDocument given = Read("assembly.step", unit_mm);
    ASSERT_TRUE(given.unhealed_mm.has_value()) << unit_mm;
    EXPECT_DOUBLE_EQ(*given.unhealed_mm / *own.unhealed_mm, unit_mm / own.info.unit_mm);
    EXPECT_EQ(given.info.unit_mm, unit_mm);
  }
}

TEST_F(GivenUnit, ThatIsTheFilesOwnLeavesThePrecision) {
  const CadDocument own = Read("assembly.step", 0);
  const CadDocument given = Read("assembly.step", own.info.unit_mm);
  EXPECT_EQ(given.unhealed_mm, own.unhealed_mm);
}

}  // namespace
}  // namespace facetless
