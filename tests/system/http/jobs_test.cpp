// Tests jobs over a real socket, with an importer whose behaviour the first word of the upload selects
// (tests/support/fake_importer), and with a server that is killed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <fstream>
#include <thread>

#include "server/base/sha256.h"
#include "server/service/jobs/sql_job_store.h"
#include "server/service/store/store_check.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

const LiveServer::Headers kAtOnce = {{"Prefer", "wait=0"}};

class HttpJobs : public testing::Test {
 protected:
  static std::string FakeImporter() { return Program("facetless-fake-importer"); }
  static Reply PostModel(LiveServer& server, const std::string& text,
                         const LiveServer::Headers& headers = kAtOnce) {
    return server.PostForm("/v1/models", {{"file", "square.step", text}}, headers);
  }
  static Reply PostRender(LiveServer& server, const std::string& text,
                          const LiveServer::Headers& headers = kAtOnce) {
    return server.PostForm("/v1/renders",
                           {{"file", "square.step", text}, {"options", "", R"({"size":"48x48"})"}}, headers);
  }
  static Json Job(LiveServer& server, const std::string& id) { return server.Get("/v1/jobs/" + id).Json(); }
  static void WaitUntilRunning(LiveServer& server, const std::string& id) {
    while (Job(server, id).at("state") == "queued")
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  static Reply Cancel(LiveServer& server, const std::string& id) {
    return server.Request("DELETE", "/v1/jobs/" + id, {}, "");
  }
  static int ChildrenLeft(const LiveServer& server) {
    int left = 0;
    std::error_code error;
    for (const auto& process : std::filesystem::directory_iterator("/proc")) {
      const std::filesystem::path where = std::filesystem::read_symlink(process.path() / "cwd", error);
      left += !error && where.string().starts_with(server.data());
    }
    return left;
  }
  static void ExpectSoundStore(LiveServer& server) {
    const auto checked = CheckStore(server.data());
    ASSERT_TRUE(checked.ok()) << checked.error().message;
    EXPECT_EQ(checked.value().at("faults"), Json::array());
  }
};

// Returns the JSON without the values that differ between runs: times, memory, and the addresses of the files
// that contain them.
Json WithoutMeasurements(Json json) {
  if (json.is_object()) {
    for (const char* name : {"timing_ms", "import_ms", "read_ms", "transfer_ms", "convert_ms",
                             "import_peak_bytes", "peak_bytes", "bytes", "report", "page"})
      json.erase(name);
  }
  if (json.is_structured()) {
    for (Json& child : json) child = WithoutMeasurements(child);
  }
  return json;
}

TEST_F(HttpJobs, AnswerLaterWhereTheCallerDoesNotWait) {
  LiveServer server({}, FakeImporter());
  const Reply accepted = PostRender(server, "slow 700");
  ASSERT_EQ(accepted.status, 202) << accepted.body;
  const std::string id = accepted.Json().at("id");
  EXPECT_EQ(accepted.headers.at("location"), "/v1/jobs/" + id);
  EXPECT_NE(accepted.headers.at("retry-after"), "");
  EXPECT_EQ(accepted.Json().at("kind"), "render");
  EXPECT_THAT(accepted.Json().at("state"), AnyOf("queued", "running"));
  EXPECT_TRUE(accepted.Json().at("finished").is_null());
  WaitUntilRunning(server, id);
  EXPECT_EQ(Job(server, id).at("attempts"), 1);

  const Json job = server.JobAtItsEnd(id);
  ASSERT_EQ(job.at("state"), "done") << job;
  EXPECT_EQ(job.at("fraction"), 1);
  EXPECT_THAT(job.at("finished").get<std::string>(), testing::MatchesRegex("20..-..-..T..:..:...*Z"));
  EXPECT_EQ(job.at("result").at("views").size(), 1u);
  EXPECT_EQ(server.Get(job.at("links").at("result")).Json(), job.at("result"));
  // The second request finds the known answer in the time of a look-up. The time of the original work is
  // reported separately.
  const Reply again = PostRender(server, "slow 700", {});
  EXPECT_THAT(again.headers.at("cache-status"), testing::HasSubstr("hit"));
  Json known = again.Json();
  EXPECT_EQ(known.at("kept").at("timing_ms"), job.at("result").at("timing_ms"));
  EXPECT_GT(known.at("kept").at("timing_ms").at("import").get<double>(), 600);
  EXPECT_LT(known.at("timing_ms").at("total").get<double>(), 500);
  known.erase("kept");
  EXPECT_EQ(WithoutMeasurements(known), WithoutMeasurements(job.at("result")));
  // Another picture of the same model does not include the time of its import.
  const Json other = server
                         .PostForm("/v1/renders", {{"file", "square.step", "slow 700"},
                                                   {"options", "", R"({"size":"16x16"})"}})
                         .Json();
  EXPECT_EQ(other.at("timing_ms").at("import"), 0);
  EXPECT_GT(other.at("timing_ms").at("import_kept").get<double>(), 600);
  EXPECT_LT(other.at("timing_ms").at("total").get<double>(), 600);
  EXPECT_EQ(server.Get("/v1/jobs/" + std::string(32, '0')).Problem(), "not-found");
  EXPECT_EQ(server.Get("/v1/jobs/" + id + "/nothing").Problem(), "not-found");
}

TEST_F(HttpJobs, ThatFailKeepTheirProblem) {
  LiveServer server({}, FakeImporter());
  const std::string id = PostModel(server, "unusable nothing-usable").Json().at("id");
  const Json job = server.JobAtItsEnd(id);
  EXPECT_EQ(job.at("state"), "failed");
  EXPECT_EQ(job.at("problem").at("type"), "urn:facetless:problem:nothing-usable");
  EXPECT_EQ(job.at("problem").at("status"), 422);
  EXPECT_FALSE(job.contains("result"));
  // A failure is not stored as an answer.
  EXPECT_NE(PostModel(server, "unusable nothing-usable").Json().at("id"), id);
}

TEST_F(HttpJobs, EndWithinASecondWhenCancelled) {
  LiveServer server({}, FakeImporter());
  const std::string id = PostModel(server, "hang").Json().at("id");
  WaitUntilRunning(server, id);
  while (ChildrenLeft(server) == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  // 200 means that the job ended within the second for which the service waits. If it ended later, the answer
  // would be 202.
  const Reply cancelled = Cancel(server, id);
  EXPECT_EQ(cancelled.status, 200) << cancelled.body;
  EXPECT_EQ(cancelled.Json().at("state"), "cancelled");
  EXPECT_EQ(ChildrenLeft(server), 0);
  EXPECT_TRUE(std::filesystem::is_empty(server.data() + "/tmp"));
  EXPECT_EQ(Cancel(server, id).Json(), cancelled.Json()) << "cancelling again must change nothing";
  EXPECT_EQ(Cancel(server, std::string(32, '0')).status, 404);
  EXPECT_EQ(server.Request("DELETE", "/v1/jobs/" + id, {{"Sec-Fetch-Site", "cross-site"}}, "").Problem(),
            "cross-site");
}

TEST_F(HttpJobs, TellWhoeverWaitsThatTheyWereCancelled) {
  LiveServer server({}, FakeImporter());
  // Both requests have one key, so that the waiting request waits for this job even if it arrives late.
  const std::string id =
      PostModel(server, "hang", {{"Prefer", "wait=0"}, {"Idempotency-Key", "one"}}).Json().at("id");
  Reply waiting;
  std::thread waiter([&] {
    waiting = PostModel(server, "hang", {{"Prefer", "wait=60"}, {"Idempotency-Key", "one"}});
  });
  WaitUntilRunning(server, id);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  Cancel(server, id);
  waiter.join();
  EXPECT_EQ(waiting.status, 409);
  EXPECT_EQ(waiting.Problem(), "cancelled");
}

TEST_F(HttpJobs, TellTheirProgressToTheEnd) {
  LiveServer server({}, FakeImporter());
  const std::string id = PostRender(server, "slow 300").Json().at("id");
  const Reply events = server.Get("/v1/jobs/" + id + "/events");
  EXPECT_EQ(events.status, 200);
  EXPECT_EQ(events.headers.at("content-type"), "text/event-stream");
  EXPECT_THAT(events.body, HasSubstr("event: progress\ndata: {\"fraction\":"));
  EXPECT_THAT(events.body, HasSubstr("\"stage\":\"render\""));
  const std::size_t end = events.body.find("event: end\ndata: {");
  ASSERT_NE(end, std::string::npos) << events.body;
  EXPECT_THAT(events.body.substr(end), HasSubstr("\"state\":\"done\""));
  EXPECT_THAT(events.body.substr(end + 5), Not(HasSubstr("event: "))) << "no event may follow the end";
  // The stream of a job that has ended begins with the end.
  EXPECT_THAT(server.Get("/v1/jobs/" + id + "/events").body, HasSubstr("event: end"));
  EXPECT_EQ(server.Get("/v1/jobs/nothing/events").Problem(), "not-found");
}

TEST_F(HttpJobs, AreTheSameUnderOneIdempotencyKey) {
  LiveServer server({}, FakeImporter());
  const auto post = [&](const std::string& text, const std::string& key) {
    return PostRender(server, text, {{"Prefer", "wait=0"}, {"Idempotency-Key", key}});
  };
  const Reply first = post("slow 1500", "one");
  ASSERT_EQ(first.status, 202) << first.body;
  const std::string id = first.Json().at("id");
  EXPECT_EQ(post("slow 1500", "one").Json().at("id"), id);
  const Json result = server.JobAtItsEnd(id).at("result");
  // The job is the same when it is done. Only the times belong to each request.
  const auto without_times = [](Json json) {
    json.erase("kept");
    return WithoutMeasurements(json);
  };
  EXPECT_EQ(without_times(post("slow 1500", "one").Json()), without_times(result));
  const Reply other = post("ok", "one");
  EXPECT_EQ(other.status, 422);
  EXPECT_EQ(other.Problem(), "key-reused");
  // A new key for a known question refers to the known answer from then on.
  EXPECT_EQ(without_times(post("slow 1500", "two").Json()), without_times(result));
  EXPECT_EQ(post("ok", "two").Problem(), "key-reused");
  EXPECT_EQ(post("ok", std::string(256, 'k')).Problem(), "bad-usage");
}

TEST_F(HttpJobs, ForTheSameQuestionAtOnceAreOne) {
  LiveServer server({"--jobs", "2"}, FakeImporter());
  const std::string id = PostRender(server, "slow 1500").Json().at("id");
  EXPECT_EQ(PostRender(server, "slow 1500").Json().at("id"), id);
  std::vector<std::thread> clients;
  std::vector<Reply> replies(4);
  for (Reply& reply : replies)
    clients.emplace_back([&server, &reply] { reply = PostRender(server, "slow 1500", {}); });
  for (std::thread& client : clients) client.join();
  for (const Reply& reply : replies) {
    // The work was done once. Each request reports a time of its own.
    EXPECT_EQ(reply.Json().at("kept"), replies.front().Json().at("kept"));
    EXPECT_EQ(WithoutMeasurements(reply.Json()), WithoutMeasurements(replies.front().Json()));
  }
}

TEST_F(HttpJobs, SurviveTheirServersDeath) {
  LiveServer server({}, FakeImporter()), undisturbed({}, FakeImporter());
  const Reply accepted = PostRender(server, "slow 2000");
  ASSERT_EQ(accepted.status, 202);
  const std::string id = accepted.Json().at("id");
  WaitUntilRunning(server, id);
  server.Stop(SIGKILL);
  server.Start();
  const Json job = server.JobAtItsEnd(id);
  ASSERT_EQ(job.at("state"), "done") << job;
  EXPECT_EQ(job.at("attempts"), 2);
  const Json expected = PostRender(undisturbed, "slow 2000", {}).Json();
  EXPECT_EQ(WithoutMeasurements(job.at("result")), WithoutMeasurements(expected));
  EXPECT_THAT(server.Get("/v1/jobs/" + id + "/events").body, HasSubstr("event: end"));
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  ExpectSoundStore(server);
  server.Start();
}

TEST_F(HttpJobs, ThatSeeThreeDeathsAreGivenUp) {
  LiveServer server({}, FakeImporter());
  const std::string id = PostModel(server, "hang").Json().at("id");
  for (int attempt = 1; attempt <= 3; ++attempt) {
    while (Job(server, id).at("state") != "running" || Job(server, id).at("attempts") != attempt)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    server.Stop(SIGKILL);
    server.Start();
  }
  const Json job = Job(server, id);
  EXPECT_EQ(job.at("state"), "failed");
  EXPECT_EQ(job.at("problem").at("type"), "urn:facetless:problem:gave-up");
  EXPECT_THAT(job.at("problem").at("detail").get<std::string>(), HasSubstr("3 times"));
  EXPECT_EQ(PostModel(server, "ok", {}).status, 201) << "other requests must work";
}

TEST_F(HttpJobs, TakeTurnsBetweenOwners) {
  // Without keys, only the queue itself has owners. So put jobs of two owners into it, and then let a server
  // run them one at a time.
  LiveServer server({"--jobs", "1"}, FakeImporter());
  const std::string model = PostModel(server, "ok", {}).Json().at("id");
  server.Stop(SIGTERM);
  std::vector<std::string> ids;
  {
    auto directory = DataDirectory::Open(server.data()).value();
    SqlJobStore jobs(*directory, {});
    for (const auto& [owner, question] :
         {std::pair{"anna", "a1"}, {"anna", "a2"}, {"anna", "a3"}, {"", "b1"}, {"", "b2"}}) {
      NewJob job;
      job.kind = JobKind::kModel;
      job.owner = owner;
      job.question = question;
      job.request = {{"model", model}, {"options", Json::object()}};
      ids.push_back(jobs.Submit(job).value().job.id);
    }
  }
  server.Start();
  EXPECT_EQ(server.JobAtItsEnd(ids[4]).at("state"), "done");
  EXPECT_EQ(server.Get("/v1/jobs/" + ids[0]).status, 404)
      << "a request without anna's key must not see her job";
  {
    auto database = DataDirectory::OpenDatabase(server.data()).value();
    for (bool waiting = true; waiting; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
      waiting = false;
      (void)database->Query("SELECT 1 FROM jobs WHERE finished IS NULL", {},
                            [&](const SqlRow&) { waiting = true; });
    }
  }
  server.Stop(SIGTERM);
  auto directory = DataDirectory::Open(server.data()).value();
  SqlJobStore jobs(*directory, {});
  const auto started = [&](std::size_t i) { return jobs.Find(ids[i])->started; };
  EXPECT_LT(started(3), started(1)) << "b1 must not wait for a2";
  EXPECT_LT(started(4), started(2)) << "b2 must not wait for a3";
  directory.reset();
  server.Start();
}

TEST_F(HttpJobs, OfAKindOfANewerVersionFailAndSaySo) {
  LiveServer server({"--jobs", "1"}, FakeImporter());
  const std::string model = PostModel(server, "ok", {}).Json().at("id");
  server.Stop(SIGTERM);
  std::string strange, known;
  {
    auto directory = DataDirectory::Open(server.data()).value();
    SqlJobStore jobs(*directory, {});
    NewJob job;
    job.kind = JobKind::kRender;
    job.request = {{"model", model}, {"options", {{"size", "32x32"}}}};
    job.question = "of a newer version";
    strange = jobs.Submit(job).value().job.id;
    job.question = std::string(64, 'c');
    known = jobs.Submit(job).value().job.id;
    ASSERT_TRUE(directory->writer().Run("UPDATE jobs SET kind = 'hologram' WHERE id = ?", {strange}).ok());
  }
  server.Start();
  const Json failed = server.JobAtItsEnd(strange);
  EXPECT_EQ(failed.at("state"), "failed");
  EXPECT_EQ(failed.at("kind"), "unknown");
  EXPECT_THAT(failed.at("problem").at("detail").get<std::string>(),
              HasSubstr("a job of the kind \"hologram\", which this version of Facetless does not know"));
  EXPECT_EQ(server.JobAtItsEnd(known).at("state"), "done") << "other jobs must not wait";
  EXPECT_THAT(server.Get("/metrics").body,
              HasSubstr("facetless_jobs_ended_total{kind=\"unknown\",state=\"failed\"} 1"));
}

TEST_F(HttpJobs, GiveUpOldModelsForNewOnes) {
  LiveServer server({"--max-store", "1", "--max-upload", "2"}, FakeImporter());
  const auto large = [](const std::string& name) { return "ok " + name + std::string(600000, ' '); };
  const std::string first = PostModel(server, large("a"), {}).Json().at("id");
  EXPECT_EQ(server.Get("/v1/models/" + first).status, 200);
  const Reply second = PostModel(server, large("b"), {});
  EXPECT_EQ(second.status, 201) << second.body;
  EXPECT_EQ(server.Get("/v1/models/" + first).status, 404);
  EXPECT_EQ(PostModel(server, large("a"), {}).status, 201) << "imported again";
  const Reply too_large = PostModel(server, "ok" + std::string(1500000, ' '), {});
  EXPECT_EQ(too_large.status, 507);
  EXPECT_EQ(too_large.Problem(), "write-failed");
}

TEST_F(HttpJobs, ComputeAnEvictedAnswerAgain) {
  LiveServer server({"--max-store", "1"}, FakeImporter());
  const Reply first = PostRender(server, "ok", {});
  ASSERT_EQ(first.status, 200);
  const std::string picture = first.Json().at("views").at(0).at("links").at("direct");
  ASSERT_EQ(PostModel(server, "ok x" + std::string(900000, ' '), {}).status, 201);
  ASSERT_EQ(PostModel(server, "ok y" + std::string(900000, ' '), {}).status, 201);
  EXPECT_EQ(server.Get(picture).status, 404);
  const Reply again = PostRender(server, "ok", {});
  EXPECT_EQ(again.status, 200) << again.body;
  EXPECT_EQ(WithoutMeasurements(again.Json()), WithoutMeasurements(first.Json()));
  EXPECT_EQ(server.Get(picture).status, 200);
}

TEST_F(HttpJobs, SayThatTheDiskIsFullAndLeaveNothingTorn) {
  LiveServer server({}, FakeImporter());
  // A limit on the file size makes large writes fail, as a full disk does.
  const struct rlimit limit = {2 << 20, 2 << 20};
  if (prlimit(server.pid(), RLIMIT_FSIZE, &limit, nullptr) != 0)
    GTEST_SKIP() << "this system does not allow tests to limit the size of the server's files";
  const Reply reply = PostModel(server, "ok" + std::string(3 << 20, ' '), {});
  EXPECT_EQ(reply.status, 507) << reply.body;
  EXPECT_EQ(reply.Problem(), "write-failed");
  EXPECT_EQ(server.Get("/healthz").status, 200);
  EXPECT_EQ(PostModel(server, "ok", {}).status, 201) << "a small upload must still be accepted";
  EXPECT_TRUE(std::filesystem::is_empty(server.data() + "/tmp"));
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  ExpectSoundStore(server);
  server.Start();
}

TEST_F(HttpJobs, GoOnWhereTheDiskItselfIsFull) {
  LiveServer server({}, FakeImporter());
  ASSERT_EQ(server.Stop(SIGTERM), 0);
  // Mount a disk of three megabytes at the data directory.
  if (mount("tmpfs", server.data().c_str(), "tmpfs", 0, "size=3m") != 0)
    GTEST_SKIP() << "this system does not allow tests to mount a small disk; run the test as root";
  server.Start();
  const auto large = [](int i) { return "ok " + std::to_string(i) + std::string(200000, ' '); };
  std::vector<Json> answers;
  Reply last;
  for (int i = 0; i < 30; ++i) {
    last = PostRender(server, large(i), {});
    if (last.status != 200) break;
    answers.push_back(last.Json());
  }
  EXPECT_EQ(last.status, 507) << last.body;
  EXPECT_EQ(last.Problem(), "write-failed");
  ASSERT_FALSE(answers.empty());
  for (const Json& answer : answers)
    EXPECT_EQ(server.Get(answer.at("views").at(0).at("links").at("direct")).status, 200)
        << "earlier data must still be there";
  Json again = server.PostJson("/v1/renders", {{"model", Sha256Hex(large(0))}, {"size", "48x48"}}).Json();
  again.erase("kept");
  EXPECT_EQ(WithoutMeasurements(again), WithoutMeasurements(answers[0]));
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  ExpectSoundStore(server);
  EXPECT_EQ(umount(server.data().c_str()), 0);
  server.Start();
}

TEST_F(HttpJobs, AreCheckedOnTheCommandLineWhileNobodyWorks) {
  LiveServer server({}, FakeImporter());
  ASSERT_EQ(PostRender(server, "ok", {}).status, 200);
  const auto check = [&] { return RunProgram(Program("facetless"), {"store", "check", server.data()}, "/"); };
  EXPECT_EQ(check().exit_code, 64) << "the service holds the lock";
  EXPECT_THAT(check().error_tail, HasSubstr("in use"));
  ASSERT_EQ(server.Stop(SIGTERM), 0);
  const ChildOutcome sound = check();
  EXPECT_EQ(sound.exit_code, 0) << sound.out;
  EXPECT_EQ(Json::parse(sound.out).at("jobs").at("done"), 1);
  WriteText(server.data() + "/tmp/torn", "x");
  const ChildOutcome faulty = check();
  EXPECT_EQ(faulty.exit_code, 1);
  EXPECT_EQ(Json::parse(faulty.out).at("faults").at(0).at("kind"), "leftover");
  server.Start();
}

}  // namespace
}  // namespace facetless
