// Tests the service over a real socket, with an importer whose behaviour the first word of the upload selects
// (tests/support/fake_importer).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <thread>

#include "server/base/sha256.h"
#include "tests/support/sanitized.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

class HttpService : public testing::Test {
 protected:
  static std::string FakeImporter() { return Program("facetless-fake-importer"); }
  // Uploads a valid model and returns its id.
  static std::string Upload(LiveServer& server) {
    return server.PostForm("/v1/models", {{"file", "square.step", "ok"}}).Json().value("id", "");
  }
  // Counts the importers of this server that still run. They work below its data directory, which
  // distinguishes them from those of other tests.
  static int ChildrenLeft(const LiveServer& server) {
    int left = 0;
    std::error_code error;
    for (const auto& process : std::filesystem::directory_iterator("/proc")) {
      const std::filesystem::path where = std::filesystem::read_symlink(process.path() / "cwd", error);
      left += !error && where.string().starts_with(server.data());
    }
    return left;
  }
};

TEST_F(HttpService, SaysThatItLives) {
  LiveServer server;
  const Reply reply = server.Get("/healthz");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.Json().at("status"), "ok");
  EXPECT_EQ(reply.Json().at("running"), 0);
}

TEST_F(HttpService, ServesAPageThatFetchesNothingFromElsewhere) {
  LiveServer server;
  const Reply page = server.Get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  EXPECT_THAT(page.headers.at("content-security-policy"), HasSubstr("default-src 'none'"));
  EXPECT_EQ(page.headers.at("x-content-type-options"), "nosniff");
  for (const auto& [path, type] : {std::pair{"/style.css", "text/css"},
                                   {"/page/app.js", "text/javascript"},
                                   {"/favicon.svg", "image/svg+xml"}}) {
    EXPECT_THAT(page.body, HasSubstr(std::string(path).substr(1)));
    const Reply asset = server.Get(path);
    EXPECT_EQ(asset.status, 200) << path;
    EXPECT_THAT(asset.headers.at("content-type"), HasSubstr(type));
    EXPECT_FALSE(asset.body.empty());
  }
  EXPECT_THAT(page.body, Not(HasSubstr("https://")));
  // Modules may import these modules. Only scripts are below /page.
  EXPECT_EQ(server.Get("/page/service.js").status, 200);
  for (const char* other : {"/page/report.html", "/page/openapi.json", "/page/none.js", "/page/../main.cpp"})
    EXPECT_EQ(server.Get(other).Problem(), "not-found") << other;
  const Reply head = server.Request("HEAD", "/", {}, "");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
}

TEST_F(HttpService, KnowsTheSameFileAgain) {
  LiveServer server({}, FakeImporter());
  const Reply first = server.PostForm("/v1/models", {{"file", "square.step", "ok"}});
  EXPECT_EQ(first.status, 201) << first.body;
  const std::string id = first.Json().at("id");
  EXPECT_EQ(id, Sha256Hex("ok"));
  EXPECT_EQ(first.headers.at("location"), "/v1/models/" + id);
  EXPECT_EQ(first.Json().at("name"), "square.step");
  EXPECT_EQ(first.Json().at("model").at("faces"), 1);

  const Reply second = server.PostForm("/v1/models", {{"file", "other name.step", "ok"}});
  EXPECT_EQ(second.status, 200);
  EXPECT_EQ(second.Json(), first.Json());
  // The file may also be the request's body itself.
  const Reply raw =
      server.Request("POST", "/v1/models?name=raw.step", {{"Content-Type", "model/step"}}, "ok");
  EXPECT_EQ(raw.status, 200);
  EXPECT_EQ(raw.Json().at("id"), id);
  EXPECT_EQ(server.Get("/v1/models/" + id).Json(), first.Json());
  EXPECT_EQ(server.Get("/v1/models/" + std::string(64, '0')).Problem(), "not-found");
  EXPECT_EQ(server.Get("/v1/models/..%2f..%2fetc%2fpasswd").Problem(), "not-found");
}

TEST_F(HttpService, RendersAndKeepsThePictures) {
  LiveServer server({}, FakeImporter());
  const Reply reply =
      server.PostJson("/v1/render", {{"model", Upload(server)}, {"view", "top"}, {"size", "64x48"}});
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json report = reply.Json();
  ASSERT_EQ(report.at("views").size(), 1u);
  const Json view = report["views"][0];
  EXPECT_EQ(view.at("name"), "top");
  EXPECT_GT(view.at("direct").at("hits").get<int>(), 64 * 48 / 4);

  // The name of a picture is its digest, so it may be cached for ever, and a conditional request transfers
  // nothing.
  const std::string link = view.at("links").at("direct");
  const Reply picture = server.Get(link);
  EXPECT_EQ(picture.status, 200);
  EXPECT_EQ(picture.headers.at("content-type"), "image/png");
  EXPECT_TRUE(picture.body.starts_with("\x89PNG"));
  EXPECT_EQ(link, "/v1/artifacts/" + Sha256Hex(picture.body) + ".png");
  EXPECT_THAT(picture.headers.at("cache-control"), HasSubstr("immutable"));
  const Reply known = server.Get(link, {{"If-None-Match", picture.headers.at("etag")}});
  EXPECT_EQ(known.status, 304);
  EXPECT_EQ(known.body, "");
  EXPECT_EQ(known.headers.at("etag"), picture.headers.at("etag"));
  EXPECT_EQ(server.Get(link, {{"If-None-Match", "\"other\""}}).status, 200);
  EXPECT_EQ(server.Get(view.at("links").at("depth")).headers.at("content-type"), "image/tiff");

  // The report is also available as files.
  EXPECT_EQ(server.Get(report.at("links").at("report")).Json().at("views").size(), 1u);
  const Reply page = server.Get(report.at("links").at("page"));
  EXPECT_THAT(page.headers.at("content-type"), HasSubstr("text/html"));
  EXPECT_THAT(page.headers.at("content-security-policy"), HasSubstr("sandbox"));

  // A repeated request costs nothing: it returns the same answer, in which only the times belong to this
  // request.
  Json again =
      server.PostJson("/v1/render", {{"model", Upload(server)}, {"view", "top"}, {"size", "64x48"}}).Json();
  EXPECT_EQ(again.at("kept").at("timing_ms"), report.at("timing_ms"));
  again.erase("kept");
  again["timing_ms"] = report.at("timing_ms");
  EXPECT_EQ(again, report);
}

TEST_F(HttpService, IgnoresRanges) {
  LiveServer server({}, FakeImporter());
  const Json report =
      server.PostForm("/v1/render", {{"file", "square.step", "ok"}, {"options", "", R"({"size":"32x32"})"}})
          .Json();
  const std::string link = report.at("views").at(0).at("links").at("direct");
  const Reply whole = server.Get(link);
  for (const char* range : {"bytes=1-3", "bytes=0-,0-,0-,0-", "bytes=99999999-", "bytes=-1"}) {
    const Reply reply = server.Get(link, {{"Range", range}});
    EXPECT_EQ(reply.status, 200) << range;
    EXPECT_EQ(reply.body, whole.body) << range;
  }
}

TEST_F(HttpService, AnswersWhatIsWrongWithAProblem) {
  LiveServer server({"--max-upload", "1"}, FakeImporter());
  const std::string id = Upload(server);
  EXPECT_EQ(server.Get("/nothing/here").Problem(), "not-found");
  EXPECT_EQ(server.Get("/v1/artifacts/" + std::string(64, 'a') + ".png").Problem(), "not-found");
  EXPECT_EQ(server.Get("/v1/artifacts/../../lock").Problem(), "not-found");
  const Reply method = server.Request("DELETE", "/v1/compare", {}, "");
  EXPECT_EQ(method.Problem(), "method-not-allowed");
  EXPECT_EQ(method.headers.at("allow"), "POST");
  EXPECT_EQ(server.Request("POST", "/healthz", {}, "x").Problem(), "method-not-allowed");
  EXPECT_EQ(server.Request("POST", "/v1/render", {{"Content-Type", "text/plain"}}, "x").Problem(),
            "unsupported-media-type");
  EXPECT_EQ(server.Request("POST", "/v1/render", {{"Content-Type", "application/json"}}, "{").Problem(),
            "bad-usage");
  EXPECT_EQ(server.Request("POST", "/v1/render", {{"Content-Type", "application/json"}}, "").Problem(),
            "bad-usage");
  EXPECT_EQ(server.PostJson("/v1/render", {{"model", std::string(64, '0')}}).Problem(), "not-found");
  EXPECT_EQ(server.PostJson("/v1/render", {{"view", "iso"}}).Problem(), "bad-usage");
  for (const Json& options :
       {Json{{"view", "above"}}, Json{{"size", "0x0"}}, Json{{"samples", 7}}, Json{{"threads", 4}},
        Json{{"mesh", "/etc/passwd"}}, Json{{"camera", "@/etc/passwd"}}, Json{{"nonsense", 1}}}) {
    Json body = options;
    body["model"] = id;
    const Reply reply = server.PostJson("/v1/render", body);
    EXPECT_EQ(reply.status, 422) << body;
    EXPECT_EQ(reply.Problem(), "bad-usage") << reply.body;
  }
  EXPECT_EQ(server.PostForm("/v1/render", {{"file", "a.step", "ok"}, {"options", "", "[]"}}).Problem(),
            "bad-usage");
  EXPECT_EQ(server.PostForm("/v1/render", {{"file", "a.step", "ok"}, {"surprise", "", "1"}}).Problem(),
            "bad-usage");
  EXPECT_EQ(server.PostForm("/v1/render", {{"mesh", "a.glb", "x"}, {"model", "", id}}).Problem(),
            "bad-usage");
  EXPECT_EQ(server.Request("POST", "/v1/models", {{"Sec-Fetch-Site", "cross-site"}}, "ok").Problem(),
            "cross-site");
  EXPECT_EQ(server.Raw("NONSENSE\r\n\r\n").Problem(), "malformed-request");
  EXPECT_EQ(server.Raw("BREW /v1/models HTTP/1.1\r\n\r\n").status, 400);
}

TEST_F(HttpService, BoundsBodiesHoweverTheyCome) {
  LiveServer server({"--max-upload", "1"}, FakeImporter());
  const std::string large(1500000, 'x');
  const Reply announced = server.Request("POST", "/v1/models", {}, large);
  EXPECT_EQ(announced.status, 413);
  EXPECT_EQ(announced.Problem(), "payload-too-large");
  EXPECT_EQ(server.PostForm("/v1/compare", {{"file", "a.step", large}}).Problem(), "payload-too-large");
  // Send a chunked body, which has no Content-Length.
  std::string chunked = "POST /v1/models HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 1000; ++i) chunked += "186a0\r\n" + std::string(100000, 'x') + "\r\n";
  EXPECT_EQ(server.Raw(chunked + "0\r\n\r\n").Problem(), "payload-too-large");
  // The client announces a large body with Expect.
  EXPECT_EQ(server.Request("POST", "/v1/models", {{"Expect", "100-continue"}}, large).Problem(),
            "payload-too-large");
  EXPECT_EQ(server
                .PostForm("/v1/render",
                          {{"file", "a.step", "ok"}, {"options", "", std::string(1 << 20, ' ') + "{}"}})
                .status,
            413);
  EXPECT_EQ(server.PostForm("/v1/render", std::vector<FormPart>(20, {"options", "", "{}"})).status, 413);
  EXPECT_TRUE(std::filesystem::is_empty(server.data() + "/tmp")) << "uploads were not removed";
  EXPECT_EQ(server.Get("/healthz").status, 200);
}

TEST_F(HttpService, BoundsTheWorkOfARequest) {
  LiveServer server({"--max-samples", "10000"}, FakeImporter());
  const Reply reply = server.PostForm(
      "/v1/render", {{"file", "a.step", "ok"}, {"options", "", R"({"size":"64x64","samples":4})"}});
  EXPECT_EQ(reply.status, 422);
  EXPECT_EQ(reply.Problem(), "limit-exceeded");
  EXPECT_THAT(reply.body, HasSubstr("10000 are allowed"));
}

TEST_F(HttpService, SurvivesWhatFilesDoToTheImporter) {
  LiveServer server({"--timeout", "2"}, FakeImporter());
  EXPECT_EQ(server.PostForm("/v1/compare", {{"file", "a.step", "crash"}}).Problem(), "importer-crashed");
  const Reply unusable = server.PostForm("/v1/compare", {{"file", "a.step", "unusable nothing-usable"}});
  EXPECT_EQ(unusable.status, 422);
  EXPECT_EQ(unusable.Problem(), "nothing-usable");
  const Reply hanging = server.PostForm("/v1/models", {{"file", "a.step", "hang"}});
  EXPECT_EQ(hanging.status, 504);
  EXPECT_EQ(hanging.Problem(), "timeout");
  EXPECT_EQ(server.PostForm("/v1/models", {{"file", "a.step", "flood"}}).status, 504);
  EXPECT_EQ(server.PostForm("/v1/models", {{"file", "a.step", "garbage"}}).status, 422);
  EXPECT_TRUE(std::filesystem::is_empty(server.data() + "/tmp"));
  EXPECT_EQ(ChildrenLeft(server), 0);
  EXPECT_EQ(server.PostForm("/v1/models", {{"file", "a.step", "ok"}}).status, 201);
}

TEST_F(HttpService, SurvivesAnImporterThatEatsMemory) {
  if (kSanitized) GTEST_SKIP() << "sanitizers need more address space than a limit allows";
  LiveServer server({"--timeout", "10", "--import-memory", "400"}, FakeImporter());
  EXPECT_EQ(server.PostForm("/v1/models", {{"file", "a.step", "memory"}}).Problem(), "limit-exceeded");
  EXPECT_TRUE(std::filesystem::is_empty(server.data() + "/tmp"));
  EXPECT_EQ(ChildrenLeft(server), 0);
  EXPECT_EQ(server.PostForm("/v1/models", {{"file", "a.step", "ok"}}).status, 201);
}

TEST_F(HttpService, NamesNoDirectoriesOfItsOwn) {
  LiveServer server({}, FakeImporter());
  const Reply reply =
      server.PostForm("/v1/compare", {{"file", "a.step", "ok"}, {"mesh", "b.glb", "no mesh"}});
  EXPECT_EQ(reply.status, 422) << reply.body;
  EXPECT_THAT(reply.body, Not(HasSubstr(server.data())));
  EXPECT_THAT(reply.body, Not(HasSubstr("/tmp/")));
}

TEST_F(HttpService, TurnsAwayWhatItCannotDoSoon) {
  LiveServer server({"--jobs", "1", "--queue", "1"}, FakeImporter());
  const std::string known = Upload(server);
  const auto post = [&](const char* text) {
    return server.PostForm("/v1/models", {{"file", "a.step", text}}, {{"Prefer", "wait=0"}});
  };
  const Json running = post("hang").Json();
  while (server.Get("/healthz").Json().at("running") == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const Json waiting = post("ok 1").Json();
  EXPECT_EQ(waiting.at("state"), "queued");
  const Reply turned_away = post("ok 2");
  EXPECT_EQ(turned_away.status, 503);
  EXPECT_EQ(turned_away.Problem(), "busy");
  EXPECT_NE(turned_away.headers.at("retry-after"), "");
  EXPECT_EQ(server.Get("/healthz").status, 200) << "requests without a job must still be answered";
  EXPECT_EQ(Upload(server), known) << "known results must still be answered";
  EXPECT_EQ(post("ok 1").Json().at("id"), waiting.at("id")) << "waiting jobs must still be found";
  // Cancelling a job makes room in the queue.
  EXPECT_EQ(
      server.Request("DELETE", "/v1/jobs/" + waiting.at("id").get<std::string>(), {}, "").Json().at("state"),
      "cancelled");
  EXPECT_EQ(post("ok 2").status, 202);
  server.Request("DELETE", "/v1/jobs/" + running.at("id").get<std::string>(), {}, "");
}

TEST_F(HttpService, ServesManyAtOnce) {
  LiveServer server({"--timeout", "30"}, FakeImporter());
  std::atomic<int> good{0};
  std::vector<std::thread> clients;
  for (int i = 0; i < 4; ++i) {
    clients.emplace_back([&, i] {
      for (int round = 0; round < 5; ++round) {
        const std::string text = i % 2 == 0 ? "ok " + std::to_string(i * 10 + round) : "crash";
        const int status = server.PostForm("/v1/models", {{"file", "a.step", text}}).status;
        good += status == (i % 2 == 0 ? 201 : 422);
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(good, 20);
}

TEST_F(HttpService, StopsInOrder) {
  LiveServer server({"--timeout", "60"}, FakeImporter());
  Reply reply;
  std::thread slow([&] { reply = server.PostForm("/v1/models", {{"file", "a.step", "hang"}}); });
  while (server.Get("/healthz").Json().at("running") == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(server.Stop(SIGTERM), 0);
  slow.join();
  EXPECT_EQ(reply.status, 202) << "the job must be kept, and the answer must say where to ask: "
                               << reply.body;
  EXPECT_TRUE(std::filesystem::is_empty(server.data() + "/tmp"));
  EXPECT_EQ(ChildrenLeft(server), 0);
  // The next start continues the job, and does not count the attempt that was interrupted.
  server.Start();
  const Json job = server.Get(reply.headers.at("location")).Json();
  EXPECT_THAT(job.at("state"), testing::AnyOf("queued", "running"));
  EXPECT_LE(job.at("attempts").get<int>(), 1);
}

TEST_F(HttpService, StopsAtOnceWhenNothingRuns) {
  LiveServer server;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(server.Stop(SIGINT), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
}

}  // namespace
}  // namespace facetless
