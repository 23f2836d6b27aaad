// Tests which key permits which request, without a socket.
#include "server/service/access/access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/service/store/data_directory.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Access : public testing::Test {
 protected:
  NewKey Create(const std::string& scopes) {
    AccessKey key;
    EXPECT_TRUE(ParseScopes(scopes, key).ok());
    return keys_.Create(key).value();
  }
  // Returns the status of the refusal, or 0.
  int Decide(const std::string& method, const std::string& path, const std::string& authorization,
             bool anonymous = false) {
    AccessControl access(keys_, anonymous);
    access.audit = [this](const std::string& line, const HttpRequest&) { log_.push_back(line); };
    request_ = HttpRequest();
    request_.method = method;
    request_.path = path;
    if (!authorization.empty()) request_.headers["authorization"] = authorization;
    const auto refusal = access.Decide(request_, FindRoute(path));
    return refusal ? refusal->status : 0;
  }

  TempDir folder_ = TempDir::Create().value();
  std::unique_ptr<Database> database_ = DataDirectory::OpenDatabase(folder_.path()).value();
  KeyStore keys_{*database_};
  HttpRequest request_;
  std::vector<std::string> log_;
};

TEST_F(Access, AKeyNamesItsOwner) {
  const NewKey key = Create("read,submit");
  EXPECT_EQ(Decide("POST", "/v1/models", "Bearer " + key.text), 0);
  EXPECT_EQ(request_.caller.owner, key.key.id);
  EXPECT_FALSE(request_.caller.admin);
  EXPECT_EQ(Decide("GET", "/v1/jobs/x", "bearer " + key.text), 0) << "the scheme's case does not matter";
}

TEST_F(Access, EachDecisionIsOneLineWithoutTheKey) {
  const NewKey key = Create("read");
  EXPECT_EQ(Decide("GET", "/v1/models/x", "Bearer " + key.text), 0);
  EXPECT_EQ(Decide("POST", "/v1/models", "Bearer " + key.text), 403);
  EXPECT_EQ(Decide("POST", "/v1/models", ""), 401);
  EXPECT_EQ(Decide("POST", "/v1/models", "Bearer " + key.text + "0"), 401);
  EXPECT_THAT(log_, ElementsAre("key=" + key.key.id + " GET /v1/models/x allowed",
                                "key=" + key.key.id + " POST /v1/models denied: its scopes are read",
                                "key=none POST /v1/models denied: no key",
                                "key=none POST /v1/models denied: no such key, or a revoked one"));
  for (const std::string& line : log_) EXPECT_THAT(line, Not(HasSubstr(key.text)));
}

TEST_F(Access, WhereEverybodyMayComeInAKeyMustStillBeAGoodOne) {
  EXPECT_EQ(Decide("POST", "/v1/models", "", /*anonymous=*/true), 0);
  EXPECT_EQ(request_.caller.owner, "");
  EXPECT_EQ(Decide("POST", "/v1/models", "Bearer nonsense", /*anonymous=*/true), 401);
  const NewKey key = Create("read,submit");
  EXPECT_EQ(Decide("POST", "/v1/models", "Bearer " + key.text, /*anonymous=*/true), 0);
  EXPECT_EQ(request_.caller.owner, key.key.id);
}

TEST_F(Access, ScopesAreNamesThatAreKnown) {
  AccessKey key;
  EXPECT_TRUE(ParseScopes("admin,read", key).ok());
  EXPECT_EQ(ScopesText(key), "read,admin");
  for (const char* wrong : {"", "root", "read,", "read;submit", "READ"})
    EXPECT_FALSE(ParseScopes(wrong, key).ok()) << wrong;
}

}  // namespace
}  // namespace facetless
