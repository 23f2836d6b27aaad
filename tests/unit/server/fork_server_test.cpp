// The loaded importer and its children, with the fake importer (tests/support/fake_importer).
#include "server/importer/fork_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/support/sanitized.h"
#include "tests/unit/server/fake_import.h"

namespace facetless {
namespace {

using testing::HasSubstr;

class ForkServerTest : public testing::Test {
 protected:
  ImportRequest Request(const std::string& mode) {
    ImportRequest request;
    request.input = WriteText(inputs_.File("part" + std::to_string(++requests_) + ".step"), mode);
    request.limits.timeout_s = 30;
    request.fork_server = &server_;
    request.ended = [this](bool forked) { ++(forked ? forked_ : executed_); };
    return request;
  }
  // The memory of the loaded importer that no other process shares, in bytes.
  static std::uint64_t PrivateBytes(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/smaps_rollup");
    std::uint64_t bytes = 0;
    for (std::string line; std::getline(file, line);)
      if (line.starts_with("Private_Dirty:")) bytes = std::strtoull(line.c_str() + 14, nullptr, 10) * 1024;
    return bytes;
  }
  static std::size_t OpenFiles(pid_t process) {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry :
         std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/fd"))
      ++count;
    return count;
  }

  ScopedEnvironment importer_{"FACETLESS_IMPORTER", Program("facetless-fake-importer")};
  TempDir inputs_ = TempDir::Create().value();
  ForkServer server_{ImporterForkServer()};
  std::atomic<int> requests_{0}, forked_{0}, executed_{0};
};

TEST_F(ForkServerTest, OutlivesChildrenThatCrash) {
  const pid_t process = server_.WaitForProcess(30);
  ASSERT_GT(process, 0);
  for (int i = 0; i < 20; ++i) {
    const auto files = RunImporter(Request(i % 2 == 0 ? "crash" : "ok"));
    EXPECT_EQ(files.ok(), i % 2 == 1);
    if (files.ok()) continue;
    EXPECT_THAT(files.error().message, HasSubstr("killed by SIGSEGV"));
  }
  EXPECT_EQ(server_.WaitForProcess(0), process);
  EXPECT_EQ(forked_, 20);
}

TEST_F(ForkServerTest, KeepsNoMemoryAndNoFilesOfItsChildren) {
  const pid_t process = server_.WaitForProcess(30);
  ASSERT_GT(process, 0);
  ASSERT_TRUE(RunImporter(Request("ok")).ok());
  const std::uint64_t before = PrivateBytes(process);
  const std::size_t files_before = OpenFiles(process);
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(RunImporter(Request("ok")).ok());
  EXPECT_EQ(forked_, 201);
  EXPECT_LE(PrivateBytes(process), before + (std::uint64_t{64} << 10));
  EXPECT_EQ(OpenFiles(process), files_before);
}

TEST_F(ForkServerTest, IsReplacedWhenItIsKilledAndItsChildrenGoOn) {
  const pid_t first = server_.WaitForProcess(30);
  ASSERT_GT(first, 0);
  // Kill it while its child works: the child's answer comes all the same.
  std::thread killer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    kill(first, SIGKILL);
  });
  const auto slow = RunImporter(Request("slow 800"));
  killer.join();
  EXPECT_TRUE(slow.ok()) << slow.error().message;
  EXPECT_EQ(forked_, 1);
  // Until there is another, the importer is executed.
  ASSERT_TRUE(RunImporter(Request("ok")).ok());
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  pid_t second = 0;
  while ((second = server_.WaitForProcess(1)) == 0 && std::chrono::steady_clock::now() < deadline) {
  }
  ASSERT_GT(second, 0);
  EXPECT_NE(second, first);
  const int before = forked_;
  ASSERT_TRUE(RunImporter(Request("ok")).ok());
  EXPECT_EQ(forked_, before + 1);
}

TEST_F(ForkServerTest, IsReplacedWhenItDoesNotAnswer) {
  ForkServerSettings settings = ImporterForkServer();
  settings.answer_seconds = 0.2;
  ForkServer server(std::move(settings));
  const pid_t first = server.WaitForProcess(30);
  ASSERT_GT(first, 0);
  kill(first, SIGSTOP);
  ImportRequest request = Request("ok");
  request.fork_server = &server;
  ASSERT_TRUE(RunImporter(request).ok());
  EXPECT_EQ(executed_, 1);
  pid_t second = first;
  for (int i = 0; i < 30 && (second == first || second == 0); ++i) second = server.WaitForProcess(1);
  EXPECT_NE(second, first);
  ASSERT_TRUE(RunImporter(request).ok());
  EXPECT_EQ(forked_, 1);
}

TEST_F(ForkServerTest, ForksManyChildrenAtOnce) {
  ASSERT_GT(server_.WaitForProcess(30), 0);
  std::vector<std::thread> threads;
  std::atomic<int> answered{0}, crashed{0}, timed_out{0};
  for (int i = 0; i < 24; ++i)
    threads.emplace_back([&, i] {
      ImportRequest request = Request(i % 3 == 0 ? "slow 100" : i % 3 == 1 ? "crash" : "hang");
      if (i % 3 == 2) request.limits.timeout_s = 0.3;
      const auto files = RunImporter(request);
      ++(files.ok() ? answered : files.error().code == ErrorCode::kImporterCrashed ? crashed : timed_out);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(answered, 8);
  EXPECT_EQ(crashed, 8);
  EXPECT_EQ(timed_out, 8);
  EXPECT_EQ(forked_, 24);
}

// True once the process is gone, or is dead and not yet reaped.
bool Ends(pid_t process) {
  for (int i = 0; i < 500; ++i) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    std::string text;
    if (!std::getline(file, text) || text.find(") Z ") != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

// The caller is a process of its own, forked while this one has no other thread.
TEST(ForkServerAlone, DoesNotOutliveTheCallerAndNorDoItsChildren) {
  const ScopedEnvironment importer("FACETLESS_IMPORTER", Program("facetless-fake-importer"));
  const TempDir inputs = TempDir::Create().value();
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t caller = fork();
  if (caller == 0) {
    ForkServer server(ImporterForkServer());
    const pid_t process = server.WaitForProcess(30);
    ImportRequest request;
    request.input = WriteText(inputs.File("part.step"), "hang");
    request.fork_server = &server;
    const std::thread import([&] { (void)RunImporter(request); });
    // Its child is the one that hangs.
    pid_t child = 0;
    while (child == 0) {
      for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
        std::ifstream list(task.path() / "children");
        for (pid_t id = 0; list >> id;)
          if (id != process) child = id;
      }
    }
    const pid_t told[2] = {process, child};
    (void)!write(ends[1], told, sizeof told);
    for (;;) pause();
  }
  pid_t told[2] = {};
  ASSERT_EQ(read(ends[0], told, sizeof told), static_cast<ssize_t>(sizeof told));
  close(ends[0]);
  close(ends[1]);
  kill(caller, SIGKILL);
  waitpid(caller, nullptr, 0);
  EXPECT_TRUE(Ends(told[0])) << "the loaded importer lives on";
  EXPECT_TRUE(Ends(told[1])) << "its child lives on";
}

TEST(ForkServerWithoutAProgram, IsGivenUpAndTheCallerIsTold) {
  ForkServerSettings settings;
  settings.program = "/no/such/importer";
  std::string said;
  std::mutex mutex;
  settings.log = [&](const std::string& sentence) {
    const std::lock_guard lock(mutex);
    said = sentence;
  };
  ForkServer server(std::move(settings));
  for (int i = 0; i < 1000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const std::lock_guard lock(mutex);
    if (!said.empty()) break;
  }
  EXPECT_THAT(said, HasSubstr("/no/such/importer did not become ready"));
  EXPECT_EQ(server.WaitForProcess(0), 0);
}

}  // namespace
}  // namespace facetless
