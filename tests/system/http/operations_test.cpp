// Tests what operators of the service look at: health, readiness, metrics and the log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::json;
using Headers = LiveServer::Headers;

const Headers kAtOnce = {{"Prefer", "wait=0"}};

std::string FakeImporter() {
  return Program("facetless-fake-importer");
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Returns the value of a series in Prometheus format; −1 if it is missing.
double Value(const std::string& metrics, const std::string& series) {
  for (const std::string& line : Lines(metrics)) {
    if (line.starts_with(series + " ")) return std::stod(line.substr(series.size() + 1));
  }
  return -1;
}

Reply Post(LiveServer& server, const std::string& path, const std::string& text,
           const Headers& headers = {}) {
  std::vector<FormPart> parts = {{"file", "square.step", text}};
  if (path != "/v1/models") parts.push_back({"options", "", R"({"size":"48x48"})"});
  return server.PostForm(path, parts, headers);
}

// Returns the metrics as soon as `series` is at least `least`. A request is counted when its answer has been
// sent.
std::string MetricsWith(LiveServer& server, const std::string& series, double least) {
  std::string text;
  for (int i = 0; i < 200; ++i) {
    text = server.Get("/metrics").body;
    if (Value(text, series) >= least) return text;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ADD_FAILURE() << series << " did not reach " << least << " in\n" << text;
  return text;
}

TEST(Metrics, CountRequestsJobsWorkAndLookUps) {
  LiveServer server({}, FakeImporter());
  ASSERT_EQ(Post(server, "/v1/renders", "ok").status, 200);
  ASSERT_EQ(Post(server, "/v1/renders", "ok").status, 200);
  ASSERT_EQ(server.Get("/v1/jobs/" + std::string(32, 'a')).status, 404);
  ASSERT_EQ(server.Get("/nothing/here").status, 404);
  const std::string text =
      MetricsWith(server, R"(facetless_http_requests_total{method="GET",route="none",status="404"})", 1);
  EXPECT_EQ(Value(text, R"(facetless_http_requests_total{method="POST",route="/v1/renders",status="200"})"),
            2);
  EXPECT_EQ(Value(text, R"(facetless_http_requests_total{method="GET",route="/v1/jobs/{id}",status="404"})"),
            1);
  EXPECT_EQ(
      Value(text, R"(facetless_http_request_duration_seconds_count{method="POST",route="/v1/renders"})"), 2);
  EXPECT_EQ(Value(text, R"(facetless_jobs_ended_total{kind="render",state="done"})"), 1);
  EXPECT_EQ(Value(text, R"(facetless_job_duration_seconds_count{kind="render"})"), 1);
  EXPECT_EQ(Value(text, R"(facetless_cache_lookups_total{kind="render",result="hit"})"), 1);
  EXPECT_EQ(Value(text, R"(facetless_cache_lookups_total{kind="render",result="miss"})"), 1);
  EXPECT_EQ(Value(text, R"(facetless_job_stage_duration_seconds_count{stage="render"})"), 1);
  EXPECT_GE(Value(text, "facetless_rays_total"), 48 * 48);
  EXPECT_GT(Value(text, "facetless_trace_seconds_total"), 0);
  EXPECT_EQ(Value(text, "facetless_rays_per_second_count"), 1);
  EXPECT_GT(Value(text, "facetless_store_bytes"), 0);
  EXPECT_EQ(Value(text, "facetless_jobs_waiting"), 0);
  EXPECT_EQ(Value(text, "facetless_jobs_running"), 0);
  EXPECT_EQ(Value(text, "facetless_ready"), 1);
  // Values that callers choose must not be labels.
  EXPECT_THAT(text, Not(HasSubstr("square")));
  EXPECT_THAT(text, Not(HasSubstr("nothing/here")));
}

TEST(Metrics, CountOneReadOfTheModelForEachJobAtMost) {
  LiveServer server;
  const auto reads = [&] {
    return Value(server.Get("/metrics").body, "facetless_model_read_duration_seconds_count");
  };
  const std::string cone = ReadText(Sample("cone.step")), sphere = ReadText(Sample("sphere.step"));
  const auto post = [&](const std::string& path, const std::string& file, const char* options) {
    const Reply reply = server.PostForm(path, {{"file", "part.step", file}, {"options", "", options}});
    EXPECT_EQ(reply.status, 200) << reply.body;
  };
  EXPECT_EQ(reads(), 0);
  EXPECT_EQ(server.PostForm("/v1/models", {{"file", "part.step", cone}}).status, 201);
  EXPECT_EQ(reads(), 1) << "the import of a model";
  post("/v1/renders", cone, R"({"size":"32x32"})");
  EXPECT_EQ(reads(), 2) << "a render of a model that is kept";
  post("/v1/renders", cone, R"({"size":"32x32"})");
  EXPECT_EQ(reads(), 2) << "an answer that is kept";
  post("/v1/comparisons", sphere, R"({"size":"32x32","deflection":0.1})");
  EXPECT_EQ(reads(), 3) << "a comparison, its import included";
  post("/v1/comparisons", sphere, R"({"size":"32x32","deflection":0.05})");
  EXPECT_EQ(reads(), 4) << "a comparison with another mesh of a model that is kept";
  post("/v1/trades", sphere,
       R"({"size":"32x32","deflections":"1e-1","angles":"30","tolerances":"1e-3","unit":"cm"})");
  EXPECT_EQ(reads(), 5) << "a trade, its import in another unit included";
}

TEST(Metrics, AreWellFormed) {
  LiveServer server({}, FakeImporter());
  ASSERT_EQ(Post(server, "/v1/models", "ok").status, 201);
  const Reply reply = server.Get("/metrics");
  EXPECT_THAT(reply.headers.at("content-type"), StartsWith("text/plain; version=0.0.4"));
  std::string type_of;
  int series = 0;
  for (const std::string& line : Lines(reply.body)) {
    if (line.starts_with("# TYPE ")) type_of = line.substr(7, line.find(' ', 7) - 7);
    if (line.starts_with("#")) continue;
    EXPECT_THAT(line, testing::MatchesRegex("[a-z_]+([{].*[}])? [-+.0-9eEaIinNf]+")) << line;
    EXPECT_THAT(line, StartsWith(type_of)) << "a series stands below its type";
    ++series;
  }
  EXPECT_GT(series, 20);
}

TEST(Metrics, NameTheCausesOfImportersDeaths) {
  LiveServer server({"--timeout", "2"}, FakeImporter());
  EXPECT_EQ(Post(server, "/v1/models", "crash").status, 422);
  EXPECT_EQ(Post(server, "/v1/models", "garbage").status, 422);
  EXPECT_EQ(Post(server, "/v1/models", "manyfiles").status, 422);
  EXPECT_EQ(Post(server, "/v1/models", "hang").status, 504);
  EXPECT_EQ(Post(server, "/v1/models", "unusable nothing-usable").status, 422);
  const std::string text =
      MetricsWith(server, R"(facetless_jobs_ended_total{kind="model",state="failed"})", 5);
  const auto died = [&](const std::string& cause) {
    return Value(text, "facetless_importer_deaths_total{cause=\"" + cause + "\"}");
  };
  for (const char* cause : {"crash", "answer", "output", "timeout"}) EXPECT_EQ(died(cause), 1) << cause;
  EXPECT_EQ(died("memory"), 0);
  EXPECT_EQ(died("threads"), 0);
}

// Returns the id of the importer that the service keeps loaded; 0 if there is none.
pid_t LoadedImporter(pid_t service) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(service) + "/task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;)
      if (ReadText("/proc/" + std::to_string(child) + "/cmdline").find("--serve-forks") != std::string::npos)
        return child;
  }
  return 0;
}

TEST(Operations, GoOnWhenTheLoadedImporterIsKilled) {
  LiveServer server({}, FakeImporter());
  const std::string forked = R"(facetless_importers_total{start="forked"})";
  int posts = 0;
  // Posts another file each time, until so many importers were forked.
  const auto post_until_forked = [&](double count) {
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(Post(server, "/v1/models", "ok " + std::to_string(++posts)).status, 201);
      if (Value(server.Get("/metrics").body, forked) >= count) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  };
  ASSERT_TRUE(post_until_forked(1));
  const pid_t first = LoadedImporter(server.pid());
  ASSERT_GT(first, 0);
  kill(first, SIGKILL);
  ASSERT_TRUE(post_until_forked(Value(server.Get("/metrics").body, forked) + 1));
  EXPECT_NE(LoadedImporter(server.pid()), first);
  const std::string metrics = server.Get("/metrics").body;
  EXPECT_EQ(Value(metrics, forked) + Value(metrics, R"(facetless_importers_total{start="executed"})"), posts);
}

TEST(Metrics, CountWhatWaitsAndWhatIsCancelled) {
  LiveServer server({"--jobs", "1"}, FakeImporter());
  const std::string running = Post(server, "/v1/models", "hang", kAtOnce).Json().at("id");
  while (server.Get("/v1/jobs/" + running).Json().at("state") != "running")
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const std::string waiting = Post(server, "/v1/models", "ok", kAtOnce).Json().at("id");
  const std::string before = server.Get("/metrics").body;
  EXPECT_EQ(Value(before, "facetless_jobs_waiting"), 1);
  EXPECT_EQ(Value(before, "facetless_jobs_running"), 1);
  for (const std::string& id : {waiting, running}) {
    for (int again = 0; again < 2; ++again)
      EXPECT_EQ(server.Request("DELETE", "/v1/jobs/" + id, {}, "").status, 200);
  }
  const std::string cancelled = R"(facetless_jobs_ended_total{kind="model",state="cancelled"})";
  EXPECT_EQ(Value(MetricsWith(server, cancelled, 2), cancelled), 2) << "each once";
}

TEST(Operations, HaveAListenerOfTheirOwnWhereThatIsWanted) {
  const int port = FreePort();
  LiveServer server({"--ops-listen", "127.0.0.1:" + std::to_string(port)}, FakeImporter());
  const auto ask = [&](const std::string& path) {
    return server.Raw("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n", port);
  };
  EXPECT_EQ(ask("/healthz").status, 200);
  EXPECT_EQ(ask("/readyz").status, 200);
  EXPECT_EQ(Value(ask("/metrics").body, "facetless_ready"), 1);
  for (const char* path : {"/", "/openapi.json", "/v1/jobs/x", "/v1/models/x"})
    EXPECT_EQ(ask(path).Problem(), "not-found") << path;
  EXPECT_EQ(server.Raw("POST /v1/models HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nok", port)
                .Problem(),
            "not-found");
  EXPECT_EQ(server.Get("/healthz").status, 200);
  EXPECT_EQ(server.Get("/readyz").status, 200);
  EXPECT_EQ(server.Get("/metrics").Problem(), "not-found");
}

TEST(Operations, AreAnsweredWhileSlowSendersHoldTheServiceUp) {
  const int port = FreePort();
  LiveServer server({"--ops-listen", "127.0.0.1:" + std::to_string(port)}, FakeImporter());
  // Start more unfinished uploads than the main listener has threads.
  std::vector<std::thread> slow;
  for (int i = 0; i < 120; ++i) {
    slow.emplace_back([&server] {
      server.RawInPieces(
          {"POST /v1/models HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\nok", "        "}, 1.5);
    });
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  for (const char* path : {"/healthz", "/readyz", "/metrics"})
    EXPECT_EQ(server.Raw(std::string("GET ") + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n", port).status,
              200);
  for (std::thread& sender : slow) sender.join();
}

TEST(Operations, SayThatTheServiceStopsUntilItHasStopped) {
  const int port = FreePort();
  LiveServer server({"--ops-listen", "127.0.0.1:" + std::to_string(port)}, FakeImporter());
  const std::string id = Post(server, "/v1/models", "hang", kAtOnce).Json().at("id");
  while (server.Get("/v1/jobs/" + id).Json().at("state") != "running")
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(server.pid(), SIGTERM);
  Reply ready;
  for (int i = 0; i < 100 && ready.status != 503; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ready = server.Raw("GET /readyz HTTP/1.1\r\nHost: localhost\r\n\r\n", port);
  }
  EXPECT_EQ(ready.status, 503);
  EXPECT_EQ(ready.Problem(), "not-ready");
  EXPECT_THAT(ready.body, HasSubstr("stopping"));
  EXPECT_EQ(server.Raw("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n", port).Json().at("status"),
            "stopping");
  EXPECT_EQ(server.Stop(SIGCONT), 0);
  server.Start();
}

TEST(Operations, ShareNoPort) {
  LiveServer server;
  const std::string taken = "127.0.0.1:" + std::to_string(server.port());
  const TempDir folder = TempDir::Create().value();
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--listen", taken}, {"--listen", "127.0.0.1:0", "--ops-listen", taken}}) {
    std::vector<std::string> arguments = {"serve", "--data", folder.File("data")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ChildOutcome refused = RunProgram(Program("facetless"), arguments, folder.path());
    EXPECT_EQ(refused.exit_code, 64);
    EXPECT_THAT(refused.error_tail, HasSubstr("cannot listen"));
  }
  const ChildOutcome malformed =
      RunProgram(Program("facetless"), {"serve", "--ops-listen", "nowhere", "--data", folder.File("data")},
                 folder.path());
  EXPECT_EQ(malformed.exit_code, 64);
  EXPECT_THAT(malformed.error_tail, HasSubstr("--ops-listen is nowhere"));
}

TEST(Readiness, IsThatWorkWouldBeTaken) {
  LiveServer server({}, FakeImporter());
  const Reply ready = server.Get("/readyz");
  EXPECT_EQ(ready.status, 200) << ready.body;
  EXPECT_EQ(ready.Json().at("status"), "ready");
  // Without the store's directory, the service cannot accept data.
  std::filesystem::remove_all(server.data() + "/tmp");
  Reply unready;
  for (int i = 0; i < 100 && unready.status != 503; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    unready = server.Get("/readyz");
  }
  EXPECT_EQ(unready.Problem(), "not-ready");
  EXPECT_EQ(unready.Json().at("detail"), "The store cannot be written.");
  EXPECT_THAT(unready.body, Not(HasSubstr(server.data())));
  EXPECT_EQ(server.Get("/healthz").status, 200) << "the process must still be healthy";
  EXPECT_EQ(Value(server.Get("/metrics").body, "facetless_ready"), 0);
}

TEST(Readiness, EndsWhereTheDiskDoes) {
  LiveServer server({}, FakeImporter());
  ASSERT_EQ(server.Stop(SIGTERM), 0);
  if (mount("tmpfs", server.data().c_str(), "tmpfs", 0, "size=3m") != 0)
    GTEST_SKIP() << "this system does not allow tests to mount a small disk; run the test as root";
  server.Start();
  const Reply unready = server.Get("/readyz");
  EXPECT_EQ(unready.Problem(), "not-ready");
  EXPECT_THAT(unready.body, HasSubstr("The disk has less room"));
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  EXPECT_EQ(umount(server.data().c_str()), 0);
  server.Start();
}

// ---- The log ----

class Log : public testing::Test {
 protected:
  // Restarts the server with its log in a file.
  void StartWith(const std::vector<std::string>& arguments) {
    ASSERT_EQ(server_.Stop(SIGTERM), 0);
    server_.LogTo(path_);
    server_.Start(arguments);
  }
  std::string Text() {
    EXPECT_EQ(server_.Stop(SIGTERM), 0);
    const std::string text = ReadText(path_);
    server_.Start();
    return text;
  }
  // Returns every line of the log as JSON.
  std::vector<Json> Entries() {
    std::vector<Json> entries;
    for (const std::string& line : Lines(Text())) {
      entries.push_back(Json::parse(line, nullptr, false));
      EXPECT_TRUE(entries.back().is_object()) << line;
    }
    return entries;
  }
  static std::vector<Json> With(const std::vector<Json>& entries, const char* field,
                                const std::string& value) {
    std::vector<Json> found;
    for (const Json& entry : entries) {
      if (entry.value(field, "") == value) found.push_back(entry);
    }
    return found;
  }

  TempDir folder_ = TempDir::Create().value();
  const std::string path_ = folder_.File("log");
  LiveServer server_{{}, FakeImporter()};
};

const std::string kTrace = "4bf92f3577b34da6a3ce929d0e0e4736";

TEST_F(Log, TiesARequestItsJobAndItsTraceTogether) {
  StartWith({"--log", "json"});
  const Reply reply = Post(server_, "/v1/models", "unusable nothing-usable",
                           {{"Prefer", "wait=60"}, {"traceparent", "00-" + kTrace + "-00f067aa0ba902b7-01"}});
  ASSERT_EQ(reply.status, 422) << reply.body;
  const std::string id = reply.headers.at("x-request-id");
  EXPECT_EQ(reply.Json().at("request_id"), id);
  EXPECT_EQ(reply.Json().at("trace_id"), kTrace);
  const std::string job = reply.Json().at("job_id");

  const std::vector<Json> entries = With(Entries(), "request_id", id);
  const std::vector<Json> requests = With(entries, "event", "request"), jobs = With(entries, "event", "job");
  ASSERT_EQ(requests.size(), 1u);
  ASSERT_EQ(jobs.size(), 1u);
  const Json& request = requests[0];
  EXPECT_EQ(request.at("method"), "POST");
  EXPECT_EQ(request.at("path"), "/v1/models");
  EXPECT_EQ(request.at("status"), 422);
  EXPECT_EQ(request.at("job_id"), job);
  EXPECT_EQ(request.at("trace_id"), kTrace);
  EXPECT_EQ(request.at("level"), "info");
  EXPECT_GT(request.at("ms").get<double>(), 0);
  EXPECT_THAT(request.at("time").get<std::string>(), testing::MatchesRegex("20..-..-..T..:..:...*Z"));
  EXPECT_EQ(jobs[0].at("job_id"), job);
  EXPECT_EQ(jobs[0].at("state"), "failed");
  EXPECT_EQ(jobs[0].at("problem"), "urn:facetless:problem:nothing-usable");
  EXPECT_EQ(jobs[0].at("trace_id"), kTrace);
}

TEST_F(Log, HasAnIdForEveryAnswer) {
  StartWith({"--log", "json"});
  std::vector<std::string> ids;
  for (const Reply& reply : {server_.Get("/healthz"), server_.Get("/nothing"),
                             server_.Raw("NONSENSE\r\n\r\n"), server_.Request("HEAD", "/", {}, "")})
    ids.push_back(reply.headers.at("x-request-id"));
  const std::vector<Json> entries = Entries();
  for (const std::string& id : ids) EXPECT_EQ(With(entries, "request_id", id).size(), 1u) << id;
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end()) << "all ids must differ";
}

TEST_F(Log, HoldsNoSecret) {
  const ChildOutcome made =
      RunProgram(Program("facetless"), {"keys", "create", server_.data(), "--name", "anna"}, "/");
  const Json key = Json::parse(made.out);
  const std::string text = key.at("key"), secret = text.substr(text.rfind('_') + 1);
  StartWith({"--log", "json", "--require-keys"});
  // Send the key in the header, where it belongs, and in all places where it does not.
  EXPECT_EQ(server_.Get("/v1/jobs/x", {{"Authorization", "Bearer " + text}}).status, 404);
  EXPECT_EQ(server_.Get("/v1/jobs/x?key=" + text).status, 401);
  EXPECT_EQ(server_.Get("/v1/jobs/" + text).status, 401);
  EXPECT_EQ(server_.Get("/v1/jobs/x", {{"traceparent", text}}).status, 401);
  const std::vector<Json> entries = Entries();
  EXPECT_THAT(ReadText(path_), Not(HasSubstr(secret)));
  EXPECT_THAT(ReadText(path_), Not(HasSubstr("?key")));
  EXPECT_EQ(With(With(entries, "event", "request"), "key_id", key.at("id")).size(), 1u);
  EXPECT_EQ(With(With(entries, "event", "audit"), "key_id", key.at("id")).size(), 1u);
  EXPECT_EQ(With(entries, "event", "audit").size(), 4u);
}

TEST_F(Log, OfPeopleHasALineWithTheSameIds) {
  StartWith({"--log", "text"});
  const std::string id = server_.Get("/healthz%0aforged").headers.at("x-request-id");
  const std::vector<std::string> lines = Lines(Text());
  std::vector<std::string> found;
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(found),
               [&](const std::string& line) { return line.find(id) != std::string::npos; });
  EXPECT_THAT(found,
              ElementsAre(testing::MatchesRegex("20.*Z info GET /healthz\\?forged 404 .* ms request_id=.*")));
}

}  // namespace
}  // namespace facetless
