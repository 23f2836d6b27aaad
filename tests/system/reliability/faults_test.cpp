// Tests how a running service handles faults of the machine: importers are killed, descriptors run out, the
// date is set.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "server/service/store/store_check.h"
#include "tests/support/sanitized.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

Reply PostRender(LiveServer& server, const std::string& text, const LiveServer::Headers& headers = {}) {
  return server.PostForm("/v1/renders",
                         {{"file", "square.step", text}, {"options", "", R"({"size":"32x32"})"}}, headers);
}

// Stops the service and checks the store that it leaves.
void ExpectSoundStore(LiveServer& server) {
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  EXPECT_TRUE(fs::is_empty(server.data() + "/tmp"));
  const auto checked = CheckStore(server.data());
  ASSERT_TRUE(checked.ok()) << checked.error().message;
  EXPECT_EQ(checked.value().at("faults"), Json::array());
  server.Start();
}

// ---- Importers that are killed ----

// Returns the child processes of `parent` that run the program now.
std::vector<pid_t> Children(pid_t parent, const std::string& program) {
  std::vector<pid_t> children;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    // The format is "pid (name) state parent …".
    const std::string stat = ReadText(entry.path() / "stat");
    const std::size_t close = stat.rfind(')');
    if (close == std::string::npos || std::atoi(stat.c_str() + close + 4) != parent) continue;
    if (stat.find("(" + program.substr(0, 15) + ")") != std::string::npos)
      children.push_back(std::atoi(name.c_str()));
  }
  return children;
}

TEST(Faults, ImportersKilledAtAnyMomentFailTheirOwnJobAlone) {
  const auto seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  LiveServer server;
  std::atomic<bool> stop{false};
  int kills = 0;
  std::thread killer([&] {
    while (!stop) {
      std::this_thread::sleep_for(
          std::chrono::milliseconds(std::uniform_int_distribution<int>(0, 600)(random)));
      for (const pid_t child : Children(server.pid(), "facetless-import"))
        kills += kill(child, SIGKILL) == 0 ? 1 : 0;
    }
  });
  const std::string sphere = ReadText(Sample("sphere.step"));
  constexpr int kPosts = 24;
  int failed = 0;
  for (int i = 0; i < kPosts; ++i) {
    const std::string text = sphere + "/* " + std::to_string(i) + " */\n";
    const Reply reply = PostRender(server, text);
    if (reply.status == 200) continue;
    EXPECT_EQ(reply.Problem(), "limit-exceeded") << reply.status << " " << reply.body;
    EXPECT_THAT(reply.body, testing::HasSubstr("killed from outside"));
    ++failed;
  }
  stop = true;
  killer.join();
  std::printf("%d importers killed, %d of %d posts failed for it\n", kills, failed, kPosts);
  EXPECT_GT(kills, 0);
  // A failure is not kept, so the same requests succeed now.
  for (int i = 0; i < kPosts; ++i)
    EXPECT_EQ(PostRender(server, sphere + "/* " + std::to_string(i) + " */\n").status, 200) << i;
  ExpectSoundStore(server);
}

// ---- Descriptors that run out ----

TEST(Faults, WithoutDescriptorsItSaysSoAndGoesOn) {
  LiveServer server({}, Program("facetless-fake-importer"));
  ASSERT_EQ(PostRender(server, "ok").status, 200);
  const auto open_files = [&] {
    const auto files = fs::directory_iterator("/proc/" + std::to_string(server.pid()) + "/fd");
    return static_cast<rlim_t>(std::distance(fs::begin(files), fs::end(files)));
  };
  const auto limit = [&](rlim_t files) {
    rlimit both = {};
    ASSERT_EQ(prlimit(server.pid(), RLIMIT_NOFILE, nullptr, &both), 0);
    both.rlim_cur = files;
    ASSERT_EQ(prlimit(server.pid(), RLIMIT_NOFILE, &both, nullptr), 0);
  };
  rlimit before = {};
  ASSERT_EQ(prlimit(server.pid(), RLIMIT_NOFILE, nullptr, &before), 0);
  const Reply slow = PostRender(server, "slow 1500", {{"Prefer", "wait=0"}});
  ASSERT_EQ(slow.status, 202) << slow.body;

  // There is a descriptor for the connection, and few or none for the request.
  int refused = 0;
  for (rlim_t more = 1; more <= 16; ++more) {
    limit(open_files() + more);
    const Reply reply = PostRender(server, "ok " + std::to_string(more));
    if (reply.status == 200) continue;
    ++refused;
    EXPECT_NE(reply.Problem(), "") << more << " more: " << reply.status << " " << reply.body;
    EXPECT_GE(reply.status, 500) << reply.body;
  }
  EXPECT_GT(refused, 0) << "descriptors never ran out";
  limit(before.rlim_cur);
  for (int more = 1; more <= 16; ++more)
    EXPECT_EQ(PostRender(server, "ok " + std::to_string(more)).status, 200) << more;
  const Json job = server.JobAtItsEnd(slow.Json().value("id", ""));
  ASSERT_TRUE(job.is_object()) << "the job that was accepted is lost";
  EXPECT_TRUE(job.value("state", "") == "done" || job.contains("problem")) << job;
  // Removing a directory needs a descriptor, too. Remaining directories are removed at the next start, as
  // after a crash.
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  server.Start();
  ExpectSoundStore(server);
}

// ---- A date that is set ----

// Sets the date for programs that are started while this object lives.
class SetDate {
 public:
  SetDate()
      : file_(folder_.File("shift")),
        preload_("LD_PRELOAD", Program("facetless_date_shift.so")),
        shift_("DATE_SHIFT", file_) {
    WriteText(file_, std::string(sizeof(std::int64_t), '\0'));
  }
  void Later(std::int64_t seconds) {
    std::fstream file(file_, std::ios::binary | std::ios::in | std::ios::out);
    file.write(reinterpret_cast<const char*>(&seconds), sizeof seconds);
  }

 private:
  const TempDir folder_ = TempDir::Create().value();
  const std::string file_;
  const ScopedEnvironment preload_, shift_;
};

double DaysFromNow(const std::string& date) {
  std::tm time = {};
  if (strptime(date.c_str(), "%Y-%m-%dT%H:%M:%S", &time) == nullptr) return -1e9;
  return std::difftime(timegm(&time), std::time(nullptr)) / 86400;
}

TEST(Faults, ADateThatIsSetLosesNoJobAndRunsNoneTwice) {
  if (kSanitized)
    GTEST_SKIP() << "a sanitizer must be the first library, and so must the library that sets the date";
  SetDate date;
  LiveServer server({"--jobs", "2", "--max-age", "36500"}, Program("facetless-fake-importer"));

  std::vector<std::string> jobs;
  const std::vector<std::int64_t> days = {1, 3650, -3650, 0, -1, 90, 0};
  for (std::size_t i = 0; i < days.size(); ++i) {
    const std::string n = std::to_string(i);
    const LiveServer::Headers retry = {{"Prefer", "wait=0"}, {"Idempotency-Key", "key " + n}};
    const Reply slow = PostRender(server, "slow 800 " + n, retry);
    ASSERT_EQ(slow.status, 202) << slow.body;
    const std::string id = slow.Json().value("id", "");
    for (int k = 0; k < 100 && server.Get("/v1/jobs/" + id).Json().value("state", "") != "running"; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    date.Later(days[i] * 86400);
    // The other thread must not take this thread's work when it looks for work.
    EXPECT_EQ(PostRender(server, "ok " + n).status, 200);
    EXPECT_EQ(PostRender(server, "slow 800 " + n, retry).Json().value("id", ""), id);
    const Json job = server.JobAtItsEnd(id);
    ASSERT_TRUE(job.is_object()) << days[i];
    EXPECT_EQ(job.value("state", ""), "done") << days[i] << job;
    EXPECT_EQ(job.value("attempts", 0), 1) << days[i];
    EXPECT_NEAR(DaysFromNow(job.at("finished")), static_cast<double>(days[i]), 0.1) << "the date was not set";
    jobs.push_back(id);
  }
  for (const std::string& id : jobs)
    EXPECT_EQ(server.Get("/v1/jobs/" + id).Json().value("state", ""), "done");

  // Durations must not be differences of dates.
  const std::string metrics = server.Get("/metrics").body;
  const std::string sum = "facetless_job_duration_seconds_sum{kind=\"render\"} ";
  const std::size_t at = metrics.find(sum);
  ASSERT_NE(at, std::string::npos);
  const double seconds = std::atof(metrics.c_str() + at + sum.size());
  EXPECT_GE(seconds, 0.8 * static_cast<double>(days.size()));
  EXPECT_LT(seconds, 600);
  ExpectSoundStore(server);
}

}  // namespace
}  // namespace facetless
