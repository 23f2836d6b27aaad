// Tests GET /v1/models and /v1/jobs with pages, and DELETE of a model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <set>

#include "server/service/store/store_check.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class Listing : public testing::Test {
 protected:
  std::string Upload(const std::string& text) {
    return server_.PostForm("/v1/models", {{"file", "square.step", text}}).Json().value("id", "");
  }
  // Returns the ids of all pages.
  std::vector<std::string> Read(const std::string& path, const std::string& name, std::size_t limit) {
    std::vector<std::string> ids;
    std::string next = path + "?limit=" + std::to_string(limit);
    while (!next.empty() && ids.size() < 100) {
      const Reply reply = server_.Get(next);
      EXPECT_EQ(reply.status, 200) << reply.body;
      const Json page = reply.Json();
      EXPECT_LE(page.at(name).size(), limit);
      for (const Json& entry : page.at(name)) ids.push_back(entry.at("id"));
      next = page.at("next").is_null() ? "" : page.at("next").get<std::string>();
    }
    return ids;
  }
  LiveServer server_{{}, Program("facetless-fake-importer")};
};

TEST_F(Listing, ModelsComeOnceOnPagesOfAnySize) {
  EXPECT_EQ(server_.Get("/v1/models").Json(), (Json{{"models", Json::array()}, {"next", nullptr}}));
  std::set<std::string> ids;
  for (int i = 0; i < 5; ++i) ids.insert(Upload("ok " + std::to_string(i)));
  ASSERT_EQ(ids.size(), 5u);
  const std::vector<std::string> sorted(ids.begin(), ids.end());
  for (const std::size_t limit : {1, 2, 4, 5, 6, 1000})
    EXPECT_EQ(Read("/v1/models", "models", limit), sorted);
  const Json first = server_.Get("/v1/models?limit=1").Json().at("models").at(0);
  EXPECT_EQ(first.at("name"), "square.step");
  EXPECT_EQ(first.at("bytes"), 4);
  EXPECT_THAT(first.at("created").get<std::string>(), HasSubstr("T"));
  EXPECT_EQ(server_.Get(first.at("links").at("self")).Json().at("id"), first.at("id"));
}

TEST_F(Listing, JobsComeNewestFirstWithoutTheirResults) {
  std::vector<std::string> newest_first;
  for (int i = 0; i < 5; ++i) {
    const Reply reply = server_.PostForm("/v1/models", {{"file", "a.step", "ok " + std::to_string(i)}},
                                         {{"Prefer", "wait=0"}});
    newest_first.insert(newest_first.begin(), reply.Json().at("id").get<std::string>());
    server_.JobAtItsEnd(newest_first.front());
  }
  for (const std::size_t limit : {1, 2, 5, 100}) EXPECT_EQ(Read("/v1/jobs", "jobs", limit), newest_first);
  const Json job = server_.Get("/v1/jobs?limit=1").Json().at("jobs").at(0);
  EXPECT_EQ(job.at("state"), "done");
  EXPECT_FALSE(job.contains("result"));
  EXPECT_THAT(server_.Get("/v1/jobs?after=" + std::string(32, '0')).body,
              HasSubstr("after must name one of your jobs"));
}

TEST_F(Listing, ParametersAreChecked) {
  for (const char* query : {"limit=0", "limit=1001", "limit=x", "limit=", "after=x", "afer=x"})
    for (const char* path : {"/v1/models?", "/v1/jobs?"}) {
      const Reply reply = server_.Get(std::string(path) + query);
      EXPECT_EQ(reply.status, 422) << query;
      EXPECT_EQ(reply.Problem(), "bad-usage") << query;
    }
  EXPECT_THAT(server_.Get("/v1/models?afer=x").body, HasSubstr("did you mean after?"));
}

TEST_F(Listing, AModelThatIsGivenUpIsGoneWithItsFilesAndCanComeAgain) {
  const std::string id = Upload("ok"), other = Upload("ok other");
  const Reply gone = server_.Request("DELETE", "/v1/models/" + id, {}, "");
  EXPECT_EQ(gone.status, 204);
  EXPECT_EQ(gone.body, "");
  EXPECT_EQ(server_.Get("/v1/models/" + id).status, 404);
  EXPECT_EQ(server_.Request("DELETE", "/v1/models/" + id, {}, "").status, 404);
  EXPECT_EQ(server_.Request("DELETE", "/v1/models/../x", {}, "").status, 404);
  EXPECT_EQ(Read("/v1/models", "models", 10), std::vector<std::string>{other});
  EXPECT_FALSE(std::filesystem::exists(server_.data() + "/files/" + id.substr(0, 2) + "/" + id));
  EXPECT_EQ(server_.PostForm("/v1/models", {{"file", "square.step", "ok"}}).status, 201);
  EXPECT_EQ(server_.Get("/v1/models/" + id).status, 200);
  EXPECT_EQ(server_.Stop(SIGTERM), 0);
  const auto checked = CheckStore(server_.data());
  ASSERT_TRUE(checked.ok());
  EXPECT_EQ(checked.value().at("faults"), Json::array());
}

}  // namespace
}  // namespace facetless
