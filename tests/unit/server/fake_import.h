// Tests of the importer's process use a fake importer, whose behaviour the first word of its input selects
// (tests/support/fake_importer).
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "server/base/temp_dir.h"
#include "server/importer/import_process.h"
#include "tests/unit/server/support.h"

namespace facetless {

class FakeImport : public ::testing::Test {
 protected:
  ImportRequest Request(const std::string& mode) {
    ImportRequest request;
    request.input = WriteText(inputs_.File("part.step"), mode);
    request.temp_parent = scratch_.path();
    request.limits.timeout_s = 30;
    return request;
  }
  Error ErrorOf(const ImportRequest& request) {
    auto files = RunImporter(request);
    EXPECT_FALSE(files.ok());
    EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "something was left behind";
    return files.ok() ? Error{} : files.error();
  }

  ScopedEnvironment importer_{"FACETLESS_IMPORTER", Program("facetless-fake-importer")};
  TempDir inputs_ = TempDir::Create().value();
  TempDir scratch_ = TempDir::Create().value();
};

}  // namespace facetless
