// Tests that errors in a request are reported in the terms of HTTP, before any work is done.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/service/protocol/http_terms.h"
#include "tests/support/files.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(HttpTerms, OptionsAreNamedAsRequestsNameThem) {
  EXPECT_EQ(TranslateToHttpTerms("try the other one of --mesh-up y, --mesh-up z"),
            "try the other one of mesh_up y, mesh_up z");
  EXPECT_EQ(TranslateToHttpTerms("--parts and --hide leave nothing"), "parts and hide leave nothing");
  EXPECT_EQ(TranslateToHttpTerms("use --import-memory to allow more"),
            "use the service's own option --import-memory to allow more");
  EXPECT_EQ(TranslateToHttpTerms("as (--mesh) says"), "as (the part mesh) says");
  EXPECT_EQ(TranslateToHttpTerms("a--strict b -- --nonsense"), "a--strict b -- --nonsense");
}

class Requests : public testing::Test {
 protected:
  // Returns the detail of the problem that the render request gets. Its status must be `status`.
  std::string DetailOf(const std::vector<FormPart>& parts, int status = 422,
                       const std::string& path = "/v1/renders") {
    const Reply reply = server_.PostForm(path, parts);
    EXPECT_EQ(reply.status, status) << reply.body;
    return reply.Json().value("detail", "");
  }
  std::string DetailOfOptions(const std::string& options) {
    // If the request reached this importer, which never ends, the test would notice.
    return DetailOf({{"file", "part.step", "hang"}, {"options", "", options}});
  }
  LiveServer server_{{"--max-samples", "20000"}, Program("facetless-fake-importer")};
};

TEST_F(Requests, JsonErrorsHaveTheirPosition) {
  EXPECT_THAT(DetailOfOptions("{\n  \"size\": 32x32\n}"),
              AllOf(HasSubstr("the part \"options\" is not valid JSON: line 2, column 13"), HasSubstr("x")));
  EXPECT_THAT(DetailOfOptions(""), HasSubstr("line 1, column 1"));
  EXPECT_THAT(DetailOfOptions(R"({"size":"32x32","view":"iso","view":"top"})"),
              HasSubstr("has the name \"view\" twice"));
  EXPECT_THAT(DetailOfOptions("[1]"), HasSubstr("must be a JSON object"));
  const Reply body =
      server_.Request("POST", "/v1/renders", {{"Content-Type", "application/json"}}, "{\"model\": nul}");
  EXPECT_EQ(body.status, 422);
  EXPECT_THAT(body.Json().at("detail"), HasSubstr("the body is not valid JSON: line 1, column 1"));
  // A word of a megabyte must not be repeated in the message.
  EXPECT_LT(DetailOfOptions("{\"size\": " + std::string(50000, 'y') + "}").size(), 400u);
  EXPECT_LT(DetailOfOptions("{\"" + std::string(50000, 'y') + "\": 1}").size(), 3000u);
}

TEST_F(Requests, UnknownOptionsGetASuggestion) {
  EXPECT_THAT(DetailOfOptions(R"({"sise":"32x32"})"), HasSubstr("no option \"sise\" (did you mean size?)"));
  EXPECT_THAT(DetailOfOptions(R"({"colour":"part"})"), HasSubstr("did you mean color?"));
  EXPECT_THAT(DetailOfOptions(R"({"veiw":"iso"})"), HasSubstr("did you mean view?"));
  EXPECT_THAT(DetailOfOptions(R"({"nonsense":"iso"})"),
              AllOf(Not(HasSubstr("did you mean")), HasSubstr("the options of renders are"),
                    Not(HasSubstr("threads"))));
  EXPECT_THAT(DetailOfOptions(R"({"threads":4})"), HasSubstr("threads is not an option of a request"));
  EXPECT_THAT(DetailOfOptions(R"({"import-timeout":4})"),
              HasSubstr("import_timeout is not an option of a request"));
  EXPECT_THAT(DetailOfOptions(R"({"camera":{"eyes":[1,2,3]}})"), HasSubstr("did you mean eye?"));
  EXPECT_THAT(DetailOf({{"file", "a.step", "hang"}, {"option", "", "{}"}}),
              HasSubstr("did you mean options?"));
}

TEST_F(Requests, TwoPartsOfOneNameAreRefused) {
  EXPECT_THAT(DetailOf({{"file", "a.step", "ok"}, {"file", "b.step", "ok"}}),
              HasSubstr("two parts \"file\""));
  EXPECT_THAT(DetailOf({{"file", "a.step", "ok"}, {"options", "", "{}"}, {"options", "", "{}"}}),
              HasSubstr("two parts \"options\""));
  EXPECT_THAT(DetailOf({{"file", "a.step", "ok"}, {"file", "b.step", "ok"}}, 422, "/v1/models"),
              HasSubstr("two parts \"file\""));
}

TEST_F(Requests, AModelThatIsNoIdIsNotEchoed) {
  const std::string detail = DetailOf({{"model", "", std::string(12000, 'z')}});
  EXPECT_THAT(detail, HasSubstr("64 hexadecimal digits"));
  EXPECT_LT(detail.size(), 300u);
  EXPECT_THAT(DetailOf({{"model", "", std::string(64, 'A')}}), HasSubstr("64 hexadecimal digits"));
  EXPECT_THAT(DetailOf({{"model", "", std::string(64, 'a')}, {"options", "", R"({"size":"32x32"})"}}, 404),
              HasSubstr("There is no model"));
  const Reply json = server_.PostJson("/v1/renders", {{"model", "../x"}});
  EXPECT_EQ(json.status, 422);
  EXPECT_THAT(json.Json().at("detail"), HasSubstr("64 hexadecimal digits"));
}

TEST_F(Requests, LimitsHoldBeforeTheImport) {
  // If the importer started, it would hang.
  for (const char* options :
       {R"({"size":"100x100","samples":4})", R"({"size":"100x100","samples":1,"view":["iso","top","front"]})",
        R"({"size":"32x32","samples":1,"turntable":30})",
        R"({"samples":1,"camera":{"eye":[1,2,3],"width":200,"height_px":200}})"}) {
    const Reply reply =
        server_.PostForm("/v1/renders", {{"file", "part.step", "hang"}, {"options", "", options}});
    EXPECT_EQ(reply.Problem(), "limit-exceeded") << options << reply.body;
    EXPECT_THAT(reply.body, HasSubstr("20000 are allowed"));
  }
  EXPECT_THAT(DetailOfOptions(R"({"camera":{"target":[1,2,3]}})"), HasSubstr("a camera needs an \"eye\""));
}

TEST_F(Requests, OptionsOfAMeshNeedAMeshAndOthersNone) {
  const auto detail = [&](const std::vector<FormPart>& parts) {
    return DetailOf(parts, 422, "/v1/comparisons");
  };
  EXPECT_THAT(detail({{"file", "a.step", "hang"}, {"options", "", R"({"size":"32x32","mesh_unit":"mm"})"}}),
              HasSubstr("about the part \"mesh\""));
  EXPECT_THAT(detail({{"file", "a.step", "hang"},
                      {"mesh", "a.glb", "x"},
                      {"options", "", R"({"size":"32x32","deflection":0.1})"}}),
              HasSubstr("either mesh or deflection"));
}

TEST(RequestsOfRealFiles, ErrorsHaveTheNamesOfTheFilesAndOptionsOfRequests) {
  LiveServer server;
  const std::string sphere = ReadText(Sample("sphere.step"));
  const auto detail = [&](const std::string& mesh) {
    const Reply reply = server.PostForm("/v1/comparisons", {{"file", "sphere.step", sphere},
                                                            {"mesh", "my export.stl", mesh},
                                                            {"options", "", R"({"size":"32x32"})"}});
    EXPECT_EQ(reply.status, 422) << reply.body;
    return reply.Json().value("detail", "");
  };
  EXPECT_THAT(detail("nonsense"), HasSubstr("my export.stl: neither glTF"));
  // This mesh is a thousand times too small.
  std::string stl = "solid x\n";
  for (const char* corners :
       {"0 0 0\nvertex 0.02 0 0\nvertex 0 0.02 0.02", "0 0 0\nvertex 0 0.02 0\nvertex 0 0 0.02"})
    stl += std::string("facet normal 0 0 1\nouter loop\nvertex ") + corners + "\nendloop\nendfacet\n";
  EXPECT_THAT(detail(stl + "endsolid x\n"),
              AllOf(HasSubstr("my export.stl: "), HasSubstr("mesh_unit"), Not(HasSubstr("--"))));
  // The message for a file in an unknown format must use the name of the uploaded file.
  const Reply reply = server.PostForm(
      "/v1/renders", {{"file", "my part.step", "nothing"}, {"options", "", R"({"size":"32x32"})"}});
  EXPECT_EQ(reply.status, 422);
  EXPECT_THAT(reply.body, HasSubstr("my part.step"));
}

}  // namespace
}  // namespace facetless
