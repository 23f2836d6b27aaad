// Tests which keys get access, and what they can see.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "server/service/access/keys.h"
#include "server/service/store/data_directory.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;
using Headers = LiveServer::Headers;

class Keys : public testing::Test {
 protected:
  Keys() {
    anna_ = Create({"--name", "anna"});
    bert_ = Create({"--name", "bert"});
    EXPECT_EQ(server_.Stop(SIGTERM), 0);
    server_.Start({"--require-keys"});
  }
  // Creates a key while the service runs.
  Json Create(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"keys", "create", server_.data()});
    const ChildOutcome outcome = RunProgram(Program("facetless"), arguments, "/");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error_tail;
    return Json::parse(outcome.out);
  }
  static Headers With(const Json& key) {
    return {{"Authorization", "Bearer " + key.at("key").get<std::string>()}};
  }
  Reply Post(const std::string& text, Headers headers) {
    headers.emplace_back("Prefer", "wait=60");
    return server_.PostForm("/v1/renders",
                            {{"file", "square.step", text}, {"options", "", R"({"size":"32x32"})"}}, headers);
  }
  Reply PostLater(const std::string& text, Headers headers) {
    headers.emplace_back("Prefer", "wait=0");
    return server_.PostForm("/v1/models", {{"file", "square.step", text}}, headers);
  }

  LiveServer server_{{}, Program("facetless-fake-importer")};
  Json anna_, bert_;
};

TEST_F(Keys, NobodyComesInWithoutOne) {
  for (const Headers& headers :
       {Headers{}, Headers{{"Authorization", "Bearer nonsense"}}, Headers{{"Authorization", "Basic YTpi"}},
        Headers{
            {"Authorization", "Bearer facetless_" + std::string(16, '0') + "_" + std::string(64, '0')}}}) {
    const Reply reply = Post("ok", headers);
    EXPECT_EQ(reply.status, 401);
    EXPECT_EQ(reply.Problem(), "unauthorized");
    EXPECT_THAT(reply.headers.at("www-authenticate"), HasSubstr("Bearer"));
    EXPECT_EQ(server_.Get("/v1/models/" + std::string(64, '0'), headers).status, 401);
    EXPECT_EQ(server_.Request("DELETE", "/v1/jobs/x", headers, "").status, 401);
  }
  // Change one digit of the secret.
  Json wrong = anna_;
  std::string text = wrong.at("key");
  text.back() = text.back() == '0' ? '1' : '0';
  wrong["key"] = text;
  EXPECT_EQ(Post("ok", With(wrong)).status, 401);
  EXPECT_EQ(Post("ok", With(anna_)).status, 200);
  EXPECT_EQ(server_.Get("/healthz").status, 200) << "monitoring needs no key";
  EXPECT_EQ(server_.Get("/").status, 200);
}

TEST_F(Keys, EachSeesItsOwnOnly) {
  const Reply reply = Post("ok", With(anna_));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json report = reply.Json();
  const std::string job = PostLater("slow 200", With(anna_)).Json().at("id");
  for (const std::string& address :
       {report.at("links").at("model").get<std::string>(), report.at("links").at("self").get<std::string>(),
        report.at("links").at("page").get<std::string>(),
        report.at("views").at(0).at("links").at("direct").get<std::string>(), "/v1/jobs/" + job,
        "/v1/jobs/" + job + "/events"}) {
    EXPECT_EQ(server_.Get(address, With(anna_)).status, 200) << address;
    EXPECT_EQ(server_.Get(address, With(bert_)).Problem(), "not-found") << address;
  }
  EXPECT_EQ(server_.Request("DELETE", "/v1/jobs/" + job, With(bert_), "").Problem(), "not-found");
  EXPECT_THAT(
      server_.Get(report.at("views").at(0).at("links").at("direct"), With(anna_)).headers.at("cache-control"),
      Not(HasSubstr("public")));
  // The same file becomes a separate model for each key. bert must not learn that it is known.
  const auto created = [&](const Json& key) {
    Headers headers = With(key);
    headers.emplace_back("Prefer", "wait=60");
    return server_.PostForm("/v1/models", {{"file", "square.step", "ok"}}, headers).status;
  };
  EXPECT_EQ(created(bert_), 201);
  EXPECT_EQ(created(anna_), 200);
}

TEST_F(Keys, DoWhatTheirScopesSay) {
  const Json reader = Create({"--name", "reader", "--scopes", "read"});
  const Json watcher = Create({"--name", "watcher", "--scopes", "read,admin"});
  EXPECT_EQ(Post("ok", With(reader)).Problem(), "forbidden");
  EXPECT_EQ(server_.Get("/v1/models/" + std::string(64, '0'), With(reader)).status, 404);
  const std::string job = PostLater("hang", With(anna_)).Json().at("id");
  EXPECT_EQ(server_.Get("/v1/jobs/" + job, With(reader)).status, 404);
  EXPECT_EQ(server_.Get("/v1/jobs/" + job, With(watcher)).Json().at("id"), job);
  EXPECT_EQ(server_.Request("DELETE", "/v1/jobs/" + job, With(reader), "").Problem(), "forbidden");
  EXPECT_EQ(server_.Request("DELETE", "/v1/jobs/" + job, With(watcher), "").Json().at("state"), "cancelled");
  EXPECT_EQ(Post("ok", With(watcher)).Problem(), "forbidden") << "a key for monitoring must not post";
}

TEST_F(Keys, AreRevokedAtOnce) {
  ASSERT_EQ(Post("ok", With(anna_)).status, 200);
  const std::string id = anna_.at("id");
  EXPECT_EQ(RunProgram(Program("facetless"), {"keys", "revoke", server_.data(), id}, "/").exit_code, 0);
  EXPECT_EQ(Post("ok", With(anna_)).Problem(), "unauthorized");
  EXPECT_EQ(Post("ok", With(bert_)).status, 200);
  const ChildOutcome list = RunProgram(Program("facetless"), {"keys", "list", server_.data()}, "/");
  EXPECT_FALSE(Json::parse(list.out).at(0).at("revoked").is_null());
  EXPECT_TRUE(Json::parse(list.out).at(1).at("revoked").is_null());
  EXPECT_THAT(list.out, Not(HasSubstr("facetless_"))) << "a list must not show keys";
  EXPECT_EQ(RunProgram(Program("facetless"), {"keys", "revoke", server_.data(), "nobody"}, "/").exit_code,
            64);
  EXPECT_EQ(RunProgram(Program("facetless"),
                       {"keys", "create", server_.data(), "--name", "x", "--scopes", "root"}, "/")
                .exit_code,
            64);
}

TEST_F(Keys, HaveARateAndAQuotaOfTheirOwn) {
  const Json slow = Create({"--name", "slow", "--rate", "2"});
  EXPECT_EQ(server_.Get("/v1/jobs/x", With(slow)).status, 404);
  EXPECT_EQ(server_.Get("/v1/jobs/x", With(slow)).status, 404);
  const Reply limited = server_.Get("/v1/jobs/x", With(slow));
  EXPECT_EQ(limited.status, 429);
  EXPECT_EQ(limited.Problem(), "rate-limited");
  EXPECT_NE(limited.headers.at("retry-after"), "");
  EXPECT_EQ(server_.Get("/v1/jobs/x", With(anna_)).status, 404) << "anna must not see this job";

  const Json small = Create({"--name", "small", "--quota", "1"});
  const auto large = [](const char* name) { return std::string("ok ") + name + std::string(600000, ' '); };
  const auto post = [&](const Json& key, const char* name) {
    Headers headers = With(key);
    headers.emplace_back("Prefer", "wait=60");
    return server_.PostForm("/v1/models", {{"file", "square.step", large(name)}}, headers);
  };
  const std::string first = post(small, "a").Json().at("id");
  const std::string annas = post(anna_, "a").Json().at("id");
  EXPECT_EQ(post(small, "b").status, 201);
  EXPECT_EQ(server_.Get("/v1/models/" + first, With(small)).status, 404) << "made room";
  EXPECT_EQ(server_.Get("/v1/models/" + annas, With(anna_)).status, 200);
}

TEST_F(Keys, ARequestThatAsksBeforeItSendsCountsOnce) {
  // The key allows two requests per minute. Each waits for 100 Continue before it sends its body.
  Headers headers = With(Create({"--name", "careful", "--rate", "2"}));
  headers.emplace_back("Expect", "100-continue");
  headers.emplace_back("Content-Type", "application/octet-stream");
  for (const int status : {201, 200, 429})
    EXPECT_EQ(server_.Request("POST", "/v1/models?name=part.step", headers, "ok").status, status);
}

TEST(KeyStore, KeepsNoSecret) {
  const TempDir folder = TempDir::Create().value();
  std::string text;
  {
    auto database = DataDirectory::OpenDatabase(folder.path()).value();
    AccessKey key;
    key.name = "anna";
    text = KeyStore(*database).Create(key).value().text;
    EXPECT_EQ(KeyStore(*database).Verify(text).value().name, "anna");
    EXPECT_FALSE(KeyStore(*database).Verify(text + "0").has_value());
    EXPECT_FALSE(KeyStore(*database).Verify("").has_value());
  }
  const std::string secret = text.substr(text.rfind('_') + 1);
  EXPECT_EQ(secret.size(), 64u);
  for (const auto& file : std::filesystem::directory_iterator(folder.path()))
    EXPECT_THAT(ReadText(file.path()), Not(HasSubstr(secret))) << file.path();
}

TEST(ServeWithoutKeys, IsRefusedWhereOthersComeByUnlessTheOwnerSaysSo) {
  const TempDir folder = TempDir::Create().value();
  const ChildOutcome refused = RunProgram(
      Program("facetless"), {"serve", "--listen", "0.0.0.0:0", "--data", folder.File("data")}, folder.path());
  EXPECT_EQ(refused.exit_code, 64);
  EXPECT_THAT(refused.error_tail, HasSubstr("--allow-anonymous"));
  LiveServer open({"--listen", "0.0.0.0:0", "--allow-anonymous"});
  EXPECT_EQ(open.Get("/v1/jobs/x").status, 404);
}

}  // namespace
}  // namespace facetless
