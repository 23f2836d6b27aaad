// Tests of the importer's process use a fake importer, whose behaviour the first word of its input selects
// (tests/support/fake_importer).
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "server/base/temp_dir.h"
#include "server/importer/import_process.h"
#include "tests/unit/server/support.h"

namespace facetless {

enum class ImporterStart { kExecuted, kForked };

class FakeImport : public ::testing::Test {
 protected:
  explicit FakeImport(ImporterStart start = ImporterStart::kExecuted) : start_(start) {
    if (start_ != ImporterStart::kForked) return;
    fork_server_ = std::make_unique<ForkServer>(ImporterForkServer());
    EXPECT_GT(fork_server_->WaitForProcess(30), 0);
  }
  ~FakeImport() override {
    // Every importer was started as the test says.
    EXPECT_EQ(start_ == ImporterStart::kForked ? executed_ : forked_, 0);
  }
  ImportRequest Request(const std::string& mode) {
    ImportRequest request;
    request.input = WriteText(inputs_.File("part.step"), mode);
    request.temp_parent = scratch_.path();
    request.limits.timeout_s = 30;
    request.fork_server = fork_server_.get();
    request.ended = [this](bool forked) { ++(forked ? forked_ : executed_); };
    return request;
  }
  Error ErrorOf(const ImportRequest& request) {
    auto files = RunImporter(request);
    EXPECT_FALSE(files.ok());
    EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "something was left behind";
    return files.ok() ? Error{} : files.error();
  }

  const ImporterStart start_;
  ScopedEnvironment importer_{"FACETLESS_IMPORTER", Program("facetless-fake-importer")};
  TempDir inputs_ = TempDir::Create().value();
  TempDir scratch_ = TempDir::Create().value();
  std::unique_ptr<ForkServer> fork_server_;  // null: importers are executed
  int forked_ = 0, executed_ = 0;
};

// For tests that run twice: the program is executed for the file, or forked by one that is loaded.
class FakeImportBothWays : public FakeImport, public ::testing::WithParamInterface<ImporterStart> {
 protected:
  FakeImportBothWays() : FakeImport(GetParam()) {}
};

inline std::string NameOfStart(const testing::TestParamInfo<ImporterStart>& info) {
  return info.param == ImporterStart::kForked ? "Forked" : "Executed";
}

}  // namespace facetless
