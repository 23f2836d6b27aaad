// Tests the hosts and origins that a service accepts.
#include "server/service/protocol/hosts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace facetless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(HostPolicy, AnswersForAddressesAndLocalNames) {
  const HostPolicy policy({}, {});
  for (const char* host : {"127.0.0.1", "127.0.0.1:8080", "localhost", "LOCALHOST:80", "localhost.",
                           "a.localhost:8080", "[::1]:8080", "[fe80::1]", "192.168.1.2:8080", ""})
    EXPECT_THAT(policy.RefusalReason(host, ""), IsEmpty()) << host;
  for (const char* host : {"evil.example", "evil.example:8080", "localhost.evil.example",
                           "127.0.0.1.evil.example", "127.1", "[evil]", "["})
    EXPECT_THAT(policy.RefusalReason(host, ""), HasSubstr("--allow-host")) << host;
}

TEST(HostPolicy, KnowsTheNamesOfItsList) {
  const HostPolicy policy({"cad.example.org", "*.Parts.example"}, {});
  for (const char* host : {"cad.example.org", "CAD.example.org:443", "a.parts.example", "a.b.parts.example"})
    EXPECT_THAT(policy.RefusalReason(host, ""), IsEmpty()) << host;
  for (const char* host : {"example.org", "xcad.example.org", "parts.example", "aparts.example"})
    EXPECT_THAT(policy.RefusalReason(host, ""), HasSubstr("--allow-host")) << host;
  EXPECT_THAT(HostPolicy({"*"}, {}).RefusalReason("anything.example", ""), IsEmpty());
}

TEST(HostPolicy, AnOriginMustBeTheHostsOwnOrOfTheList) {
  const HostPolicy policy({}, {"https://viewer.example"});
  EXPECT_THAT(policy.RefusalReason("localhost:8080", "http://localhost:8080"), IsEmpty());
  EXPECT_THAT(policy.RefusalReason("localhost:8080", "HTTP://LocalHost:8080"), IsEmpty());
  EXPECT_THAT(policy.RefusalReason("localhost:8080", "https://viewer.example"), IsEmpty());
  for (const char* origin :
       {"http://localhost:8081", "http://evil.example", "null", "http://viewer.example", "localhost:8080"})
    EXPECT_THAT(policy.RefusalReason("localhost:8080", origin), HasSubstr("--allow-origin")) << origin;
}

TEST(HostPolicy, WithoutOneEverythingIsAnswered) {
  EXPECT_THAT(HostPolicy().RefusalReason("evil.example", "http://evil.example"), IsEmpty());
}

TEST(HostPolicy, NothingOfAHeaderReachesATerminal) {
  EXPECT_THAT(HostPolicy({}, {}).RefusalReason("a\x1b[31m", ""), HasSubstr("a\xef\xbf\xbd[31m"));
}

TEST(SplitList, TakesNamesApart) {
  EXPECT_THAT(SplitList(" a, b.c ,,d"), ElementsAre("a", "b.c", "d"));
  EXPECT_THAT(SplitList(""), IsEmpty());
}

}  // namespace
}  // namespace facetless
