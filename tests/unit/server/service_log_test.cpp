// Tests the content of the log, and the trace to which a request belongs.
#include "server/service/http/service_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/service/protocol/trace_context.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

const std::string kTrace = "0af7651916cd43dd8448eb211c80319c", kParent = "b7ad6b7169203331";

TEST(TraceContext, IsTakenFromAWellFormedHeader) {
  EXPECT_EQ(ParseTraceId("00-" + kTrace + "-" + kParent + "-01"), kTrace);
  EXPECT_EQ(ParseTraceId("00-" + kTrace + "-" + kParent + "-00"), kTrace) << "sampled or not";
  EXPECT_EQ(ParseTraceId("cc-" + kTrace + "-" + kParent + "-01-what-the-future-brings"), kTrace);
}

TEST(TraceContext, IsIgnoredWhereItIsMalformed) {
  const std::string upper = "0AF7651916CD43DD8448EB211C80319C";
  for (const std::string& wrong :
       {std::string(), std::string("00"), "00-" + kTrace, "00-" + kTrace + "-" + kParent,
        "00-" + kTrace + "-" + kParent + "-0", "00-" + kTrace + "-" + kParent + "-01-more",
        "ff-" + kTrace + "-" + kParent + "-01", "0x-" + kTrace + "-" + kParent + "-01",
        "00-" + std::string(32, '0') + "-" + kParent + "-01",
        "00-" + kTrace + "-" + std::string(16, '0') + "-01", "00-" + upper + "-" + kParent + "-01",
        "00_" + kTrace + "-" + kParent + "-01", "cc-" + kTrace + "-" + kParent + "-01x", std::string(55, '-'),
        "00-" + kTrace.substr(1) + "\n-" + kParent + "-01"})
    EXPECT_EQ(ParseTraceId(wrong), "") << wrong;
}

TEST(ServiceLog, CutsWhatLooksLikeAKey) {
  const std::string id(16, '1'), secret(64, 'a');
  EXPECT_EQ(WithoutSecrets("/v1/jobs/facetless_" + id + "_" + secret + "/events"),
            "/v1/jobs/facetless_" + id + "_***/events");
  EXPECT_EQ(WithoutSecrets("facetless_" + id + "_" + secret + " facetless_" + id + "_" + secret),
            "facetless_" + id + "_*** facetless_" + id + "_***");
  EXPECT_EQ(WithoutSecrets("facetless_report.step"), "facetless_report.step");
  EXPECT_EQ(WithoutSecrets("a\nb\x1b[2Jc\x7f"), "a?b?[2Jc?");
}

TEST(ServiceLog, WritesOneLineInEitherForm) {
  ServedRequest request;
  request.id = "r1";
  request.trace_id = kTrace;
  request.method = "GET";
  request.path = "/v1/jobs/a\nb";
  request.key = "k1";
  request.job = "j1";
  request.status = 200;
  request.ms = 12.3456;
  const std::string text = LogLine(RequestEntry(request), 1700000000, false);
  EXPECT_EQ(text, "2023-11-14T22:13:20.000Z info GET /v1/jobs/a?b 200 12 ms request_id=r1 trace_id=" +
                      kTrace + " key_id=k1 job_id=j1");
  const std::string line = LogLine(RequestEntry(request), 1700000000, true);
  EXPECT_THAT(line, Not(HasSubstr("\n")));
  const Json json = Json::parse(line);
  EXPECT_EQ(json.at("time"), "2023-11-14T22:13:20.000Z");
  EXPECT_EQ(json.at("event"), "request");
  EXPECT_EQ(json.at("status"), 200);
  EXPECT_EQ(json.at("path"), "/v1/jobs/a?b");
  EXPECT_DOUBLE_EQ(json.at("ms"), 12.346);
  EXPECT_EQ(json.at("key_id"), "k1");
}

TEST(ServiceLog, LeavesOutWhatThereIsNot) {
  const Json json = Json::parse(LogLine(RequestEntry({}), 1700000000, true));
  for (const char* id : {"request_id", "trace_id", "key_id", "job_id"}) EXPECT_FALSE(json.contains(id)) << id;
}

}  // namespace
}  // namespace facetless
