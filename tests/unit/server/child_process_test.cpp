#include "server/importer/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/unit/server/support.h"

namespace facetless {
namespace {

ChildRequest Shell(const std::string& script, const TempDir& directory) {
  ChildRequest request;
  request.program = "/bin/sh";
  request.arguments = {"-c", script};
  request.working_directory = directory.path();
  return request;
}

class ChildProcess : public testing::Test {
 protected:
  ChildOutcome Run(const ChildRequest& request) {
    auto outcome = RunChild(request);
    EXPECT_TRUE(outcome.ok()) << (outcome.ok() ? "" : outcome.error().message);
    return outcome.ok() ? outcome.value() : ChildOutcome{};
  }
  TempDir directory_ = TempDir::Create().value();
};

TEST_F(ChildProcess, GivesOutputAndExitCode) {
  const ChildOutcome outcome = Run(Shell("echo out; echo err >&2; exit 7", directory_));
  EXPECT_EQ(outcome.end, ChildEnd::kExited);
  EXPECT_EQ(outcome.exit_code, 7);
  EXPECT_EQ(outcome.out, "out\n");
  EXPECT_EQ(outcome.error_tail, "err\n");
}

TEST_F(ChildProcess, SeesNoEnvironmentButItsOwn) {
  setenv("FACETLESS_SECRET", "yes", 1);
  ChildRequest request = Shell("echo \"$FACETLESS_SECRET|$GIVEN\"", directory_);
  request.environment = {"GIVEN=this"};
  EXPECT_EQ(Run(request).out, "|this\n");
  unsetenv("FACETLESS_SECRET");
}

TEST_F(ChildProcess, ReadsNothingAndRunsInItsDirectory) {
  EXPECT_EQ(Run(Shell("read line && echo got; pwd", directory_)).out, directory_.path() + "\n");
}

TEST_F(ChildProcess, GivesEachLineOfStandardError) {
  ChildRequest request = Shell("echo one >&2; echo two >&2; printf three >&2", directory_);
  std::vector<std::string> lines;
  request.on_stderr_line = [&](std::string_view line) { lines.emplace_back(line); };
  Run(request);
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two"}));
}

TEST_F(ChildProcess, KeepsOnlySoMuchOfAFlood) {
  ChildRequest request = Shell(
      "i=0; while [ $i -lt 20000 ]; do echo 0123456789; echo abcdefghij >&2; i=$((i+1)); done; echo end >&2",
      directory_);
  request.stdout_cap = 100;
  request.stderr_cap = 50;
  const ChildOutcome outcome = Run(request);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out.size(), 100u);
  EXPECT_EQ(outcome.error_tail.size(), 50u);
  EXPECT_TRUE(outcome.error_tail.ends_with("end\n"));
}

TEST_F(ChildProcess, IsKilledWithItsGroupWhenTheTimeIsOver) {
  // If the grandchild were alive, it would write the file after a second.
  const std::string file = directory_.File("alive");
  ChildRequest request = Shell("trap '' TERM; (sleep 1; echo yes > " + file + ") & wait", directory_);
  request.limits.wall_seconds = 0.2;
  const ChildOutcome outcome = Run(request);
  EXPECT_EQ(outcome.end, ChildEnd::kTimedOut);
  EXPECT_LT(outcome.wall_ms, 1000);
  std::this_thread::sleep_for(std::chrono::milliseconds(1300));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(ChildProcess, LeavesNoGrandchildBehindAfterItsOwnEnd) {
  const std::string file = directory_.File("alive");
  const ChildOutcome outcome = Run(Shell("(sleep 1; echo yes > " + file + ") & exit 0", directory_));
  EXPECT_EQ(outcome.end, ChildEnd::kExited);
  EXPECT_LT(outcome.wall_ms, 1000);
  std::this_thread::sleep_for(std::chrono::milliseconds(1300));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(ChildProcess, IsKilledWhenCancelled) {
  std::atomic<bool> cancel{false};
  ChildRequest request = Shell("sleep 10", directory_);
  request.cancel = &cancel;
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    cancel = true;
  });
  EXPECT_EQ(Run(request).end, ChildEnd::kCancelled);
  canceller.join();
}

TEST_F(ChildProcess, SaysWhichSignalItDiedOf) {
  const ChildOutcome outcome = Run(Shell("kill -ABRT $$", directory_));
  EXPECT_EQ(outcome.end, ChildEnd::kSignalled);
  EXPECT_EQ(outcome.signal, SIGABRT);
  EXPECT_EQ(SignalName(SIGSEGV), "SIGSEGV (segmentation fault)");
}

TEST_F(ChildProcess, CannotWriteLargerFilesThanAllowed) {
  ChildRequest request = Shell("exec head -c 1000000 /dev/zero > big", directory_);
  request.environment = {"PATH=/usr/bin:/bin"};
  request.limits.file_bytes = 1000;
  const ChildOutcome outcome = Run(request);
  EXPECT_EQ(outcome.end, ChildEnd::kSignalled);
  EXPECT_EQ(outcome.signal, SIGXFSZ);
  EXPECT_EQ(std::filesystem::file_size(directory_.File("big")), 1000u);
}

TEST_F(ChildProcess, UsesNoMoreProcessorTimeThanAllowed) {
  ChildRequest request = Shell("while :; do :; done", directory_);
  request.limits.cpu_seconds = 1;
  request.limits.wall_seconds = 60;
  const ChildOutcome outcome = Run(request);
  EXPECT_EQ(outcome.end, ChildEnd::kSignalled);
  EXPECT_EQ(outcome.signal, SIGXCPU);
}

TEST_F(ChildProcess, ThatCannotStartSaysWhy) {
  ChildRequest request = Shell("", directory_);
  request.program = "/no/such/program";
  auto outcome = RunChild(request);
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.error().code, ErrorCode::kInternal);
  EXPECT_EQ(outcome.error().message, "cannot start /no/such/program: No such file or directory");
}

TEST(TempDir, IsEmptyPrivateAndGoneAfterwards) {
  std::string path;
  {
    const TempDir directory = TempDir::Create().value();
    path = directory.path();
    EXPECT_TRUE(std::filesystem::is_empty(path));
    EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms::owner_all);
    WriteText(directory.File("file"), "text");
    std::filesystem::create_directory_symlink("/usr", directory.File("link"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_TRUE(std::filesystem::exists("/usr/bin"));
}

TEST(TempDir, RemovesWhatIsDeeperThanPathsAndOpenFiles) {
  std::string path;
  {
    const TempDir directory = TempDir::Create().value();
    path = directory.path();
    int at = open(path.c_str(), O_RDONLY | O_DIRECTORY);
    for (int depth = 0; depth < 3000; ++depth) {
      ASSERT_EQ(mkdirat(at, "directory", 0700), 0) << depth;
      const int next = openat(at, "directory", O_RDONLY | O_DIRECTORY);
      close(openat(next, "file", O_WRONLY | O_CREAT, 0600));
      close(at);
      at = next;
    }
    close(at);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace facetless
