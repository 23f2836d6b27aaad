// Tests the launcher of the importer with a fake importer, whose behaviour the first word of its input
// selects (tests/support/fake_importer).
#include "server/importer/import_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "render/model/model_file.h"
#include "tests/support/sanitized.h"
#include "tests/unit/server/fake_import.h"

namespace facetless {
namespace {

using testing::HasSubstr;

using ImportProcess = FakeImportBothWays;

TEST_P(ImportProcess, GivesModelAndMeshesUntilTheyAreLetGo) {
  ImportRequest request = Request("ok");
  request.meshes = {{}, {.deflection_mm = 0.5}};
  std::vector<std::string> stages;
  request.progress = [&](const std::string& stage, double fraction) {
    stages.push_back(stage + " " + std::to_string(fraction));
  };
  {
    auto files = RunImporter(request);
    ASSERT_TRUE(files.ok()) << files.error().message;
    auto model = ReadModel(files.value().model_path);
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_EQ(model.value().faces.size(), 1u);
    ASSERT_EQ(files.value().mesh_paths.size(), 2u);
    for (const std::string& path : files.value().mesh_paths)
      EXPECT_TRUE(std::filesystem::exists(path)) << path;
    EXPECT_EQ(files.value().answer.at("faces"), 1);
    EXPECT_GT(files.value().wall_ms, 0);
    EXPECT_EQ(stages, (std::vector<std::string>{"read 0.500000", "transfer 1.000000"}));
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

TEST_P(ImportProcess, PassesTheImportersOwnErrorOn) {
  const Error error = ErrorOf(Request("unusable nothing-usable"));
  EXPECT_EQ(error.code, ErrorCode::kNothingUsable);
  EXPECT_EQ(error.message, "nothing in here");
}

TEST_P(ImportProcess, SurvivesACrashAndNamesTheSignal) {
  const Error error = ErrorOf(Request("crash"));
  EXPECT_EQ(error.code, ErrorCode::kImporterCrashed);
  EXPECT_THAT(error.message, HasSubstr("part.step: the importer was killed by SIGSEGV"));
}

TEST_P(ImportProcess, StopsOneThatHangsAndNamesTheOption) {
  ImportRequest request = Request("hang");
  request.limits.timeout_s = 0.3;
  const Error error = ErrorOf(request);
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("0.3 s; use --import-timeout to allow more"));
}

TEST_P(ImportProcess, StopsOneThatEatsMemoryAndNamesTheOption) {
  if (kSanitized) GTEST_SKIP() << "sanitizers need more address space than a limit allows";
  ImportRequest request = Request("memory");
  request.limits.memory_mb = 300;
  const Error error = ErrorOf(request);
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("300 MB of memory; use --import-memory to allow more"));
}

TEST_P(ImportProcess, KeepsTheModelOfAMesherThatFailsIfThatSuffices) {
  std::vector<std::pair<std::string, std::string>> ends = {{"mesh-hang", "timeout"},
                                                           {"mesh-crash", "crash"},
                                                           {"mesh-garbage", "crash"},
                                                           {"mesh-bigfile", "output"},
                                                           {"mesh-unusable write-failed", "failed"}};
  if (!kSanitized) ends.emplace_back("mesh-memory", "memory");
  for (const auto& [mode, reason] : ends) {
    ImportRequest request = Request(mode);
    request.meshes = {{}};
    request.limits.mesh_timeout_s = mode == "mesh-hang" ? 0.2 : 30;
    request.limits.file_mb = 2;
    request.limits.memory_mb = 300;
    EXPECT_NE(ErrorOf(request).message, "") << mode;
    request.model_suffices = true;
    std::string early;
    request.model_written = [&](const std::string& path) {
      EXPECT_TRUE(ReadModel(path).ok());
      early = path;
    };
    auto files = RunImporter(request);
    ASSERT_TRUE(files.ok()) << mode << ": " << files.error().message;
    ASSERT_TRUE(files.value().mesh_failure) << mode;
    EXPECT_EQ(files.value().mesh_failure->reason, reason) << mode;
    EXPECT_EQ(files.value().model_path, early) << mode;
    EXPECT_TRUE(ReadModel(files.value().model_path).ok()) << mode;
    EXPECT_TRUE(files.value().mesh_paths.empty()) << mode;
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

TEST_P(ImportProcess, StopsOneThatFillsTheDisk) {
  ImportRequest request = Request("bigfile");
  request.limits.file_mb = 2;
  const Error error = ErrorOf(request);
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("larger than 2 MB"));
}

TEST_P(ImportProcess, IsNotDrownedByAFlood) {
  ImportRequest request = Request("flood");
  request.limits.timeout_s = 0.5;
  EXPECT_EQ(ErrorOf(request).code, ErrorCode::kLimitExceeded);
}

TEST_P(ImportProcess, StopsWhenAsked) {
  std::atomic<bool> cancel{false};
  ImportRequest request = Request("hang");
  request.execution.cancel = &cancel;
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    cancel = true;
  });
  EXPECT_EQ(ErrorOf(request).code, ErrorCode::kCancelled);
  canceller.join();
}

TEST_P(ImportProcess, MistrustsAnAnswerThatIsNone) {
  const Error unknown = ErrorOf(Request("no such mode"));
  EXPECT_EQ(unknown.code, ErrorCode::kImporterCrashed);
  EXPECT_THAT(unknown.message, HasSubstr("exit code 70: unknown mode no"));
  const Error error = ErrorOf(Request("garbage"));
  EXPECT_EQ(error.code, ErrorCode::kImporterCrashed);
  EXPECT_THAT(error.message, HasSubstr("gave up with exit code 0"));
}

TEST_P(ImportProcess, AllowsNeitherSocketsNorProcesses) {
  for (const char* mode : {"socket", "fork"}) {
    auto files = RunImporter(Request(mode));
    ASSERT_TRUE(files.ok()) << files.error().message;
    EXPECT_TRUE(files.value().answer.at("denied").get<bool>()) << mode;
  }
}

TEST_P(ImportProcess, GivesOnlyWhatIsNeeded) {
  const ScopedEnvironment secret("FACETLESS_SECRET", "yes");
  const ScopedEnvironment resources("CSF_TestDefaults", "/somewhere");
  auto files = RunImporter(Request("env"));
  ASSERT_TRUE(files.ok()) << files.error().message;
  const std::string environment = files.value().answer.at("environment").dump();
  EXPECT_THAT(environment, HasSubstr("CSF_TestDefaults=/somewhere"));
  EXPECT_THAT(environment, HasSubstr("TMPDIR=" + files.value().directory.path()));
  EXPECT_THAT(environment, Not(HasSubstr("FACETLESS_SECRET")));
  EXPECT_THAT(environment, Not(HasSubstr("PATH=/usr")));
  EXPECT_EQ(files.value().answer.at("directory"), files.value().directory.path());
  // Only standard input, output and error of this process may be open.
  EXPECT_EQ(files.value().answer.at("files"), 3);
}

TEST_P(ImportProcess, RefusesWhatIsNoFile) {
  ImportRequest request = Request("ok");
  request.input = inputs_.File("absent.step");
  EXPECT_EQ(ErrorOf(request).code, ErrorCode::kFileUnreadable);
  request.input = inputs_.path();
  const Error error = ErrorOf(request);
  EXPECT_EQ(error.code, ErrorCode::kFileUnreadable);
  EXPECT_THAT(error.message, HasSubstr("not a regular file"));
}

INSTANTIATE_TEST_SUITE_P(Starts, ImportProcess,
                         testing::Values(ImporterStart::kExecuted, ImporterStart::kForked), NameOfStart);

TEST(ErrorCodes, ComeBackFromTheirNames) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code)
    EXPECT_EQ(ErrorCodeFromName(ErrorCodeName(static_cast<ErrorCode>(code))), static_cast<ErrorCode>(code));
  EXPECT_EQ(ErrorCodeFromName("no such code"), ErrorCode::kInternal);
}

}  // namespace
}  // namespace facetless
