// Tests the table of kinds of jobs, and that a request may contain only what its kind accepts.
#include "server/service/jobs/job_kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "server/service/jobs/routes.h"
#include "server/service/jobs/submission.h"
#include "tests/unit/server/option_samples.h"

namespace facetless {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::json;

constexpr std::uint64_t kAnySamples = std::numeric_limits<std::uint64_t>::max();

Result<Submission> Parsed(const HttpRequest& request, JobKind kind) {
  return ParseSubmission(request, kind, kAnySamples);
}

// Returns a request whose JSON body has one option.
HttpRequest RequestWith(const std::string& name, const Json& value) {
  HttpRequest request;
  request.parts.push_back({});
  request.parts.back().text = Json{{"model", std::string(64, 'a')}, {name, value}}.dump();
  return request;
}

// Returns a request with a model file and another part.
HttpRequest FileWith(const std::string& part, const std::string& text) {
  HttpRequest request;
  request.headers["content-type"] = "multipart/form-data; boundary=x";
  request.parts.push_back({"file", "a.step", "", "", "/kept", std::string(64, 'b'), 7});
  if (!part.empty()) request.parts.push_back({part, "", "", text, "", "", text.size()});
  return request;
}

TEST(JobKinds, HaveARowEachInTheirOrder) {
  ASSERT_EQ(JobKinds().size(), static_cast<std::size_t>(JobKind::kUnknown));
  std::set<std::string> names, addresses;
  for (const JobKindRow& row : JobKinds()) {
    EXPECT_EQ(&RowOf(row.kind), &row) << row.name;
    EXPECT_EQ(JobKindOf(row.name), row.kind);
    EXPECT_EQ(JobKindName(row.kind), row.name);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    ASSERT_FALSE(row.addresses.empty()) << row.name;
    for (const std::string& address : row.addresses) {
      EXPECT_TRUE(addresses.insert(address).second) << address;
      const Route route = FindRoute(address);
      EXPECT_EQ(route.kind, RouteKind::kSubmit) << address;
      EXPECT_EQ(route.job, row.kind) << address;
      EXPECT_TRUE(route.Allows("POST")) << address;
    }
    EXPECT_EQ(row.commands == 0, row.run == nullptr) << row.name << ": a kind that runs must have options";
  }
  EXPECT_EQ(JobKindOf("diff-of-tomorrow"), JobKind::kUnknown);
  EXPECT_EQ(JobKindName(JobKind::kUnknown), "unknown");
}

TEST(JobKinds, TakeTheOptionsOfTheirCommandAndRefuseTheOthersByName) {
  std::size_t kinds = 0, taken = 0, refused = 0;
  for (const JobKindRow& row : JobKinds()) {
    if (row.commands == 0) continue;
    ++kinds;
    for (const OptionRow& option : AllOptions()) {
      const Json value = AnotherValueOf(option);
      ASSERT_FALSE(value.is_null()) << option.name;
      const auto submission = Parsed(RequestWith(option.name, value), row.kind);
      const bool takes = option.owner == OptionOwner::kCaller && (option.commands & row.commands) != 0;
      SCOPED_TRACE(row.name + ", " + option.name);
      if (takes) {
        ++taken;
        // These options refer to a part that the request does not have.
        if (option.name.starts_with("mesh_u"))
          EXPECT_THAT(submission.error().message, HasSubstr("about the part \"mesh\""));
        else
          EXPECT_TRUE(submission.ok()) << submission.error().message;
        continue;
      }
      ++refused;
      ASSERT_FALSE(submission.ok());
      EXPECT_EQ(submission.error().code, ErrorCode::kBadUsage);
      const std::string& said = submission.error().message;
      EXPECT_THAT(said, HasSubstr(option.name + " is not an option of"));
      if (option.owner == OptionOwner::kOperator) {
        EXPECT_THAT(said, HasSubstr("the operator of the service sets it"));
        continue;
      }
      if (option.owner == OptionOwner::kCommandLine) {
        EXPECT_THAT(said, HasSubstr("of the command line alone"));
        continue;
      }
      // The message must name the addresses that accept the option.
      for (const JobKindRow& other : JobKinds())
        if ((other.commands & option.commands) != 0)
          EXPECT_THAT(said, HasSubstr(other.addresses.front()));
        else
          EXPECT_THAT(said, Not(HasSubstr(other.addresses.front())));
    }
  }
  EXPECT_GT(taken, 0u);
  EXPECT_GT(refused, 0u);
  EXPECT_EQ(taken + refused, kinds * AllOptions().size());
}

TEST(JobKinds, RefuseAnOptionThatHasItsDefaultToo) {
  const auto deflection = Parsed(RequestWith("deflection", 1e-3), JobKind::kRender);
  ASSERT_FALSE(deflection.ok());
  EXPECT_EQ(deflection.error().message,
            "deflection is not an option of renders: leave it out, or send the request to /v1/comparisons");
  const auto turntable = Parsed(RequestWith("turntable", 0), JobKind::kComparison);
  ASSERT_FALSE(turntable.ok());
  EXPECT_EQ(turntable.error().message,
            "turntable is not an option of comparisons: leave it out, or send the request to /v1/renders");
  const auto samples = Parsed(RequestWith("samples", 4), JobKind::kTrade);
  ASSERT_FALSE(samples.ok());
  EXPECT_THAT(samples.error().message, HasSubstr("to /v1/renders or /v1/comparisons"));
  const auto mesh = Parsed(RequestWith("mesh", "a.stl"), JobKind::kRender);
  ASSERT_FALSE(mesh.ok());
  EXPECT_THAT(mesh.error().message, HasSubstr("it is a part of the body, which /v1/comparisons takes"));
}

TEST(JobKinds, TakeTheirPartsAndNoOthers) {
  for (const JobKindRow& row : JobKinds()) {
    SCOPED_TRACE(row.name);
    EXPECT_TRUE(Parsed(FileWith("", ""), row.kind).ok());
    EXPECT_EQ(Parsed(FileWith("mesh", "x"), row.kind).ok(), row.compares_mesh);
    const auto options = Parsed(FileWith("options", R"({"size":"32x32"})"), row.kind);
    EXPECT_EQ(options.ok(), row.commands != 0);
    if (!options.ok()) {
      EXPECT_THAT(options.error().message, AllOf(HasSubstr("take no options"),
                                                 HasSubstr("/v1/renders or /v1/comparisons or /v1/trades")));
    }
    const auto other = Parsed(FileWith("optoins", "{}"), row.kind);
    ASSERT_FALSE(other.ok());
    EXPECT_THAT(other.error().message, HasSubstr("there is no part \"optoins\""));
  }
}

TEST(JobKinds, AreNamedBesideEachOptionOfRequests) {
  EXPECT_THAT(CollectionsOf(*FindOption("margin")), ElementsAre("renders", "comparisons", "trades"));
  EXPECT_THAT(CollectionsOf(*FindOption("deflection")), ElementsAre("comparisons"));
  EXPECT_THAT(CollectionsOf(*FindOption("threads")), IsEmpty());
  EXPECT_THAT(CollectionsOf(*FindOption("mesh")), IsEmpty());
}

}  // namespace
}  // namespace facetless
