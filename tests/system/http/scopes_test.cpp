// Tests every route with every kind of caller, as a table.
#include <gtest/gtest.h>
#include <signal.h>

#include <map>
#include <set>

#include "server/service/jobs/routes.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using Headers = LiveServer::Headers;

// The callers: without a key; with a key for each scope alone; a stranger, who may read and submit; and anna,
// who owns everything that the requests refer to.
enum Caller { kNobody, kReader, kSubmitter, kAdmin, kStranger, kAnna };
constexpr const char* kCallers[] = {"nobody", "reader", "submitter", "admin", "stranger", "anna"};

struct Row {
  const char* method;
  const char* pattern;
  int status[6];  // in the order above
};

// Common properties of the routes are columns.
constexpr Row kTable[] = {
    {"GET", "/", {200, 200, 200, 200, 200, 200}},
    {"HEAD", "/", {200, 200, 200, 200, 200, 200}},
    {"GET", "/style.css", {200, 200, 200, 200, 200, 200}},
    {"HEAD", "/style.css", {200, 200, 200, 200, 200, 200}},
    {"GET", "/page/{name}", {200, 200, 200, 200, 200, 200}},
    {"HEAD", "/page/{name}", {200, 200, 200, 200, 200, 200}},
    {"GET", "/favicon.svg", {200, 200, 200, 200, 200, 200}},
    {"HEAD", "/favicon.svg", {200, 200, 200, 200, 200, 200}},
    {"GET", "/openapi.json", {200, 200, 200, 200, 200, 200}},
    {"HEAD", "/openapi.json", {200, 200, 200, 200, 200, 200}},
    {"GET", "/healthz", {200, 200, 200, 200, 200, 200}},
    {"HEAD", "/healthz", {200, 200, 200, 200, 200, 200}},
    {"GET", "/readyz", {200, 200, 200, 200, 200, 200}},
    {"HEAD", "/readyz", {200, 200, 200, 200, 200, 200}},
    {"GET", "/metrics", {401, 403, 403, 200, 403, 403}},
    {"HEAD", "/metrics", {401, 403, 403, 200, 403, 403}},
    // These refer to a model of anna's.
    {"POST", "/v1/renders", {401, 403, 404, 403, 404, 200}},
    {"POST", "/v1/render", {401, 403, 404, 403, 404, 200}},
    {"POST", "/v1/comparisons", {401, 403, 404, 403, 404, 200}},
    {"POST", "/v1/compare", {401, 403, 404, 403, 404, 200}},
    {"POST", "/v1/trades", {401, 403, 404, 403, 404, 200}},
    // These refer to anna's models, jobs and answers.
    {"GET", "/v1/models/{id}", {401, 404, 403, 403, 404, 200}},
    {"HEAD", "/v1/models/{id}", {401, 404, 403, 403, 404, 200}},
    {"GET", "/v1/answers/{id}", {401, 404, 403, 403, 404, 200}},
    {"HEAD", "/v1/answers/{id}", {401, 404, 403, 403, 404, 200}},
    {"GET", "/v1/artifacts/{name}", {401, 404, 403, 403, 404, 200}},
    {"HEAD", "/v1/artifacts/{name}", {401, 404, 403, 403, 404, 200}},
    {"GET", "/v1/jobs/{id}", {401, 404, 403, 200, 404, 200}},
    {"HEAD", "/v1/jobs/{id}", {401, 404, 403, 200, 404, 200}},
    {"GET", "/v1/jobs/{id}/events", {401, 404, 403, 200, 404, 200}},
    {"HEAD", "/v1/jobs/{id}/events", {401, 404, 403, 200, 404, 200}},
    {"DELETE", "/v1/jobs/{id}", {401, 403, 404, 200, 404, 200}},
    {"GET", "/v1/methods", {401, 200, 403, 403, 200, 200}},
    {"HEAD", "/v1/methods", {401, 200, 403, 403, 200, 200}},
    {"GET", "/v1/models", {401, 200, 403, 403, 200, 200}},
    {"HEAD", "/v1/models", {401, 200, 403, 403, 200, 200}},
    {"GET", "/v1/jobs", {401, 200, 403, 403, 200, 200}},
    {"HEAD", "/v1/jobs", {401, 200, 403, 403, 200, 200}},
    {"DELETE", "/v1/models/{id}", {401, 403, 404, 403, 404, 204}},
    // This upload is new for all keys that may submit. It is new for anna, too, because she has deleted it.
    // It comes last, because the other callers own it afterwards.
    {"POST", "/v1/models", {401, 403, 201, 403, 201, 201}},
};

class Scopes : public testing::Test {
 protected:
  Scopes() {
    const char* scopes[] = {"", "read", "submit", "admin", "read,submit", "read,submit"};
    for (int caller = kReader; caller <= kAnna; ++caller) {
      const ChildOutcome made = RunProgram(
          Program("facetless"),
          {"keys", "create", server_.data(), "--name", kCallers[caller], "--scopes", scopes[caller]}, "/");
      keys_[caller] = Json::parse(made.out).at("key").get<std::string>();
    }
    EXPECT_EQ(server_.Stop(SIGTERM), 0);
    server_.Start({"--require-keys"});
    const Reply render = server_.PostForm(
        "/v1/renders", {{"file", "square.step", "ok"}, {"options", "", R"({"size":"32x32"})"}}, Of(kAnna));
    EXPECT_EQ(render.status, 200) << render.body;
    const Json report = render.Json();
    const Json& links = report.at("links");
    const Json& pictures = report.at("views").at(0).at("links");
    things_ = {{"/v1/models/{id}", links.at("model").get<std::string>()},
               {"/v1/answers/{id}", links.at("self").get<std::string>()},
               {"/v1/artifacts/{name}", pictures.at("direct").get<std::string>()}};
    model_ = things_.at("/v1/models/{id}").substr(std::string("/v1/models/").size());
    Headers at_once = Of(kAnna);
    at_once.emplace_back("Prefer", "wait=0");
    const Json job =
        server_.PostForm("/v1/models", {{"file", "square.step", "unusable nothing-usable"}}, at_once).Json();
    const auto address = job.at("links").at("self").get<std::string>();
    things_["/v1/jobs/{id}"] = address;
    things_["/v1/jobs/{id}/events"] = job.at("links").at("events").get<std::string>();
    // Wait until the job has ended, so that no caller changes its state.
    while (server_.Get(address, Of(kAnna)).Json().at("state") != "failed") {
    }
  }
  Headers Of(int caller) const {
    if (caller == kNobody) return {};
    return {{"Authorization", "Bearer " + keys_.at(caller)}};
  }
  std::string Address(const std::string& pattern) const {
    if (pattern == "/page/{name}") return "/page/app.js";
    const auto thing = things_.find(pattern);
    return thing == things_.end() ? pattern : thing->second;
  }
  Reply Ask(const Row& row, int caller) {
    const std::string method = row.method, pattern = row.pattern;
    if (method != "POST") return server_.Request(method, Address(pattern), Of(caller), "");
    if (pattern == "/v1/models")
      return server_.PostForm(pattern, {{"file", "square.step", "ok"}}, Of(caller));
    return server_.PostJson(pattern, {{"model", model_}, {"size", "32x32"}}, Of(caller));
  }

  LiveServer server_{{}, Program("facetless-fake-importer")};
  std::map<int, std::string> keys_;
  std::map<std::string, std::string> things_;
  std::string model_;
};

TEST_F(Scopes, AllowWhatTheTableSays) {
  for (const Row& row : kTable) {
    for (int caller = kNobody; caller <= kAnna; ++caller) {
      const Reply reply = Ask(row, caller);
      EXPECT_EQ(reply.status, row.status[caller])
          << row.method << " " << row.pattern << " by " << kCallers[caller] << ": " << reply.body;
    }
  }
}

TEST_F(Scopes, AreTriedOnEveryRoute) {
  std::set<std::string> tried, known;
  for (const Row& row : kTable) tried.insert(std::string(row.method) + " " + row.pattern);
  for (const Route& route : AllRoutes()) {
    for (const char* method : {"GET", "HEAD", "POST", "DELETE"}) {
      if (route.Allows(method)) known.insert(std::string(method) + " " + route.pattern);
    }
  }
  EXPECT_EQ(tried, known);
}

TEST_F(Scopes, TellAStrangerNotEvenThatAThingIsThere) {
  for (const auto& [pattern, address] : things_) {
    // The same address with other digits refers to nothing.
    std::string nothing = address;
    const std::size_t id = nothing.find('/', 4) + 1;
    for (std::size_t i = id; i < nothing.size() && nothing[i] != '/' && nothing[i] != '.'; ++i)
      nothing[i] = '0';
    const Reply theirs = server_.Get(address, Of(kStranger)), none = server_.Get(nothing, Of(kStranger));
    EXPECT_EQ(theirs.status, 404) << address;
    EXPECT_EQ(theirs.body, none.body) << address;
    for (const auto& [name, value] : none.headers) {
      if (name == "x-request-id") continue;
      EXPECT_EQ(theirs.headers.at(name), value) << name;
    }
    EXPECT_EQ(theirs.headers.size(), none.headers.size());
  }
}

}  // namespace
}  // namespace facetless
