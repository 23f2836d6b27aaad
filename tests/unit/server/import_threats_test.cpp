// Tests what a file could try if it had taken over the importer: one test per threat, with a fake importer
// that tries it (tests/support/fake_importer). Each must end in one clear error or in a refusal, and must not
// affect the caller.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "render/model/model_file.h"
#include "sandbox/file_access.h"
#include "server/importer/import_process.h"
#include "tests/support/sanitized.h"
#include "tests/unit/server/fake_import.h"

namespace facetless {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

// The resources that this process holds.
struct Holdings {
  std::size_t open_files = 0, threads = 0, resident = 0;
  static std::size_t Entries(const char* directory) {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(directory)) ++count;
    return count;
  }
  static Holdings Now() {
    Holdings now;
    now.open_files = Entries("/proc/self/fd");
    now.threads = Entries("/proc/self/task");
    std::ifstream("/proc/self/statm") >> now.resident >> now.resident;
    now.resident *= static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    return now;
  }
};

// The memory that may stay allocated: an output of one megabyte, its reports, and the allocator's copies of
// both. A sanitizer's allocator also keeps freed memory and its shadow.
constexpr std::size_t kKeptBytes = std::size_t{kSanitized ? 128 : 16} << 20;

class ImportThreats : public FakeImportBothWays {
 protected:
  void SetUp() override {
    // The first run allocates what stays allocated: locale, allocator.
    (void)RunImporter(Request("ok"));
    before_ = Holdings::Now();
  }
  void TearDown() override {
    const Holdings after = Holdings::Now();
    EXPECT_EQ(after.open_files, before_.open_files);
    EXPECT_EQ(after.threads, before_.threads);
    EXPECT_LE(after.resident, before_.resident + kKeptBytes);
    fork_server_.reset();
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a child process still runs";
    EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "something was left behind";
  }
  void ExpectDenied(const std::string& mode) {
    auto files = RunImporter(Request(mode));
    ASSERT_TRUE(files.ok()) << mode << ": " << files.error().message;
    EXPECT_EQ(files.value().answer.value("denied", false), true) << mode;
  }

  Holdings before_;
};

TEST_P(ImportThreats, ManyOutputsEndAtTheirTotal) {
  ImportRequest request = Request("outputs");
  request.limits.file_mb = 8;
  const Error error = ErrorOf(request);
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("larger than 8 MB"));
}

TEST_P(ImportThreats, OutputsWithoutANameCountToo) {
  ImportRequest request = Request("nameless");
  request.limits.file_mb = 8;
  const Error error = ErrorOf(request);
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("larger than 8 MB"));
}

TEST_P(ImportThreats, ManyFilesEndAtTheirNumber) {
  const Error error = ErrorOf(Request("manyfiles"));
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("more than 256 files"));
}

TEST_P(ImportThreats, DirectoriesDeeperThanAPathAreStoppedAndRemoved) {
  const Error error = ErrorOf(Request("deep"));
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("more than 256 files"));
}

TEST_P(ImportThreats, ManyThreadsEndAtTheirNumber) {
  const Error error = ErrorOf(Request("threads"));
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(error.message, HasSubstr("threads"));
}

TEST_P(ImportThreats, NoMoreFilesCanBeOpenedThanAllowed) {
  auto files = RunImporter(Request("open"));
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_GT(files.value().answer.at("opened"), 0);
  EXPECT_LT(files.value().answer.at("opened"), 256);
}

TEST_P(ImportThreats, NoProcessCanBeStarted) {
  ExpectDenied("fork");
  ExpectDenied("vfork");
}

TEST_P(ImportThreats, NoSocketOfAnyFamilyCanBeMade) {
  ExpectDenied("socket");
}

TEST_P(ImportThreats, NoMemoryBesideItsAddressSpaceCanBeHad) {
  ExpectDenied("memfd");
}

TEST_P(ImportThreats, NoSignalReachesItsParent) {
  ExpectDenied("signal");
}

TEST_P(ImportThreats, ItsParentCanNeitherBeReadNorChanged) {
  ExpectDenied("ptrace");
}

TEST_P(ImportThreats, LeavingItsGroupDoesNotSaveItFromTheClock) {
  ImportRequest request = Request("leave");
  request.limits.timeout_s = 0.3;
  EXPECT_EQ(ErrorOf(request).code, ErrorCode::kLimitExceeded);
}

TEST_P(ImportThreats, FilesOfOthersCanBeNeitherReadNorListedNorRun) {
  if (LandlockVersion() == 0)
    GTEST_SKIP() << "this kernel has no Landlock, so files of the same user remain readable";
  const TempDir others = TempDir::Create().value();
  const std::string secret = WriteText(others.File("secret"), "nobody's business");
  const std::string parent = "/proc/" + std::to_string(getpid());
  ExpectDenied("read " + secret);
  ExpectDenied("read /etc/passwd");
  ExpectDenied("read " + parent + "/environ");
  ExpectDenied("read " + parent + "/root" + secret);
  ExpectDenied("read /proc/self/root" + secret);
  ExpectDenied("list " + others.path());
  ExpectDenied("list " + inputs_.path());
  ExpectDenied("list " + scratch_.path());
  ExpectDenied("list /");
  ExpectDenied("list /proc");
  ExpectDenied("list " + parent + "/fd");
  ExpectDenied("write " + secret);
  ExpectDenied("write " + others.File("new"));
  ExpectDenied("write " + inputs_.File("part.step"));
  ExpectDenied("write /dev/shm/facetless-test");
  ExpectDenied("run /bin/sh");
  EXPECT_EQ(ReadText(secret), "nobody's business");
}

TEST_P(ImportThreats, WhatLibrariesNeedStaysReadable) {
  for (const char* mode : {"read /proc/self/status", "read /dev/null", "read /etc/ld.so.cache",
                           "list /usr/share", "list .", "write own"}) {
    auto files = RunImporter(Request(mode));
    ASSERT_TRUE(files.ok()) << mode << ": " << files.error().message;
    EXPECT_EQ(files.value().answer.value("denied", true), false) << mode;
  }
}

TEST_P(ImportThreats, NeitherLinksNorPipesArePassedOffAsItsFiles) {
  for (const char* mode : {"link /etc/passwd", "pipe"}) {
    const Error error = ErrorOf(Request(mode));
    EXPECT_EQ(error.code, ErrorCode::kImporterCrashed) << mode;
    EXPECT_THAT(error.message, HasSubstr("the importer's answer is incomplete")) << mode;
  }
}

TEST_P(ImportThreats, AnAnswerWithoutFilesIsNone) {
  const Error error = ErrorOf(Request("nothing"));
  EXPECT_EQ(error.code, ErrorCode::kImporterCrashed);
  EXPECT_THAT(error.message, HasSubstr("a file is missing"));
}

TEST_P(ImportThreats, LastWordsAreMadePrintable) {
  const Error error = ErrorOf(Request("words"));
  EXPECT_EQ(error.code, ErrorCode::kImporterCrashed);
  EXPECT_THAT(error.message, HasSubstr("exit code 70: ?[2Jbell? and ?? bytes"));
}

TEST_P(ImportThreats, AnErrorThatIsNoneIsStillAnError) {
  for (const char* answer : {R"({"error":5})", R"({"error":{"code":7,"message":[]}})", R"({"error":null})"}) {
    const Error error = ErrorOf(Request("lies " + std::string(answer)));
    EXPECT_EQ(error.code, ErrorCode::kInternal) << answer;
    EXPECT_THAT(error.message, HasSubstr("the importer gave no reason")) << answer;
  }
  EXPECT_EQ(ErrorOf(Request("lies " + std::string(100'000, '['))).code, ErrorCode::kImporterCrashed);
}

TEST_P(ImportThreats, TheOthersThatImportProcessTestNames) {
  // Other tests check the answers to a crash, a process that ignores SIGTERM, memory, one large file and
  // floods. This test checks that the caller is not affected.
  ImportRequest request = Request("crash");
  EXPECT_EQ(ErrorOf(request).code, ErrorCode::kImporterCrashed);
  for (const char* mode : {"hang", "spin", "flood"}) {
    request = Request(mode);
    request.limits.timeout_s = 0.3;
    EXPECT_EQ(ErrorOf(request).code, ErrorCode::kLimitExceeded) << mode;
  }
  request = Request("bigfile");
  request.limits.file_mb = 2;
  EXPECT_EQ(ErrorOf(request).code, ErrorCode::kLimitExceeded);
}

INSTANTIATE_TEST_SUITE_P(Starts, ImportThreats,
                         testing::Values(ImporterStart::kExecuted, ImporterStart::kForked), NameOfStart);

}  // namespace
}  // namespace facetless
