// Tests comparisons over HTTP for which no mesh is made: the answer has the exact half, and the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

class HttpNoBaseline : public testing::Test {
 protected:
  static std::string FakeImporter() { return Program("facetless-fake-importer"); }
  static Reply Post(LiveServer& server, const std::string& path, const std::string& text,
                    Json options = Json::object()) {
    options["size"] = "32x24";
    return server.PostForm(path, {{"file", "square.step", text}, {"options", "", options.dump()}});
  }
  // Checks that the answer has the exact half, whose pictures can be fetched, and the reason.
  static void ExpectExactHalf(LiveServer& server, const Reply& reply, const std::string& reason,
                              const std::string& words) {
    ASSERT_EQ(reply.status, 200) << reply.body;
    const Json answer = reply.Json();
    EXPECT_EQ(answer.at("no_baseline").at("reason"), reason);
    const std::string message = answer["no_baseline"].at("message");
    EXPECT_THAT(message, HasSubstr("square.step: " + words));
    EXPECT_THAT(message, Not(HasSubstr("--mesh-timeout"))) << "the message must use HTTP's option names";
    EXPECT_EQ(answer.at("verdict").at("problems"), Json::array({message}));
    const Json& view = answer.at("views").at(0);
    EXPECT_GT(view.at("direct").at("hits"), 0);
    EXPECT_FALSE(view.at("links").contains("baseline"));
    EXPECT_EQ(server.Get(view["links"].at("direct")).headers.at("content-type"), "image/png");
    EXPECT_EQ(server.Get(answer.at("links").at("page")).status, 200);
  }
};

TEST_F(HttpNoBaseline, SaysWhyForEachEndOfTheMesher) {
  LiveServer server({}, FakeImporter());
  ExpectExactHalf(server, Post(server, "/v1/comparisons", "mesh-crash"), "crash",
                  "the mesher was killed by SIGSEGV");
  ExpectExactHalf(server, Post(server, "/v1/comparisons", "mesh-hang", {{"mesh_timeout", 0.3}}), "timeout",
                  "meshing took longer than 0.3 s; use mesh_timeout to allow more");
  ExpectExactHalf(server, Post(server, "/v1/comparisons", "mesh-unusable write-failed"), "failed", "");
  const Json fine = Post(server, "/v1/comparisons", "mesh-ok").Json();
  EXPECT_FALSE(fine.contains("no_baseline"));
  EXPECT_TRUE(fine.at("views").at(0).at("links").contains("baseline"));
}

TEST_F(HttpNoBaseline, SaysWhyOfAModelThatIsThereAlready) {
  LiveServer server({}, FakeImporter());
  ASSERT_EQ(Post(server, "/v1/renders", "mesh-crash").status, 200);
  ExpectExactHalf(server, Post(server, "/v1/comparisons", "mesh-crash"), "crash", "the mesher was killed");
  const Reply known = Post(server, "/v1/comparisons", "mesh-crash");
  ExpectExactHalf(server, known, "crash", "the mesher was killed");
  EXPECT_THAT(known.headers.at("cache-status"), HasSubstr("hit"))
      << "the reason depends only on the file, so the answer is kept";
  // A comparison keeps the model, too.
  ExpectExactHalf(server, Post(server, "/v1/comparisons", "mesh-hang", {{"mesh_timeout", 0.3}}), "timeout",
                  "meshing took longer");
  EXPECT_EQ(Post(server, "/v1/renders", "mesh-hang").Json().at("timing_ms").at("import"), 0);
}

TEST_F(HttpNoBaseline, IsAnotherAnswerNextTimeWhereOnlyTimeRanOut) {
  LiveServer server({}, FakeImporter());
  const Reply first = Post(server, "/v1/comparisons", "mesh-hang", {{"mesh_timeout", 0.3}});
  const Reply again = Post(server, "/v1/comparisons", "mesh-hang", {{"mesh_timeout", 0.3}});
  for (const Reply* reply : {&first, &again}) {
    ExpectExactHalf(server, *reply, "timeout", "meshing took longer");
    EXPECT_FALSE(reply->headers.contains("cache-status")) << "the mesher must have been tried again";
  }
  // Each answer keeps an address of its own, and its job refers to it.
  const std::string one = first.Json().at("links").at("self"), two = again.Json().at("links").at("self");
  EXPECT_NE(one, two);
  EXPECT_EQ(server.Get(one).body, first.body);
  EXPECT_EQ(server.Get(two).body, again.body);
  const Json jobs = server.Get("/v1/jobs").Json().at("jobs");
  ASSERT_EQ(jobs.size(), 2u);
  const Json job = server.Get(jobs.at(0).at("links").at("self")).Json();
  EXPECT_EQ(job.at("links").at("result"), two);
  EXPECT_EQ(job.at("result"), again.Json());
}

TEST_F(HttpNoBaseline, LeavesHalfOfTheJobsTimeToTheExactHalf) {
  LiveServer server({"--timeout", "4"}, FakeImporter());
  const Reply reply = Post(server, "/v1/comparisons", "mesh-hang", {{"mesh_timeout", 1000}});
  ExpectExactHalf(server, reply, "timeout", "meshing took longer than 2 s, half of what a job may take");
  EXPECT_THAT(reply.body, HasSubstr("use the service's own option --timeout to allow more"));
}

TEST_F(HttpNoBaseline, NamesTheOperatorsOptionWhereTheSearchTreeIsTooLarge) {
  // With these options, the memory limit of a view is one megabyte.
  LiveServer server({"--jobs", "64", "--max-view-memory", "64"});
  const Reply reply =
      server.PostForm("/v1/comparisons", {{"file", "sphere.step", ReadText(Sample("sphere.step"))},
                                          {"options", "", R"({"size":"32x24","deflection":1e-4})"}});
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(reply.Json().at("no_baseline").at("reason"), "memory");
  EXPECT_THAT(reply.Json().at("no_baseline").at("message").get<std::string>(),
              HasSubstr("sphere.step: the mesh's search tree needs more than the 1 MB of memory that it may "
                        "take; use the service's own "
                        "option --max-view-memory to allow more"));
  const std::string page = server.Get(reply.Json().at("links").at("page")).body;
  EXPECT_THAT(page, HasSubstr("the service's own option --max-view-memory"));
}

}  // namespace
}  // namespace facetless
