// Runs the examples of docs/api.md as they are written there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/files.h"
#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr const char* kCurl = "/usr/bin/curl";
constexpr const char* kMark = "<!-- tests/system/http runs this -->";
constexpr const char* kAddress = "http://127.0.0.1:8080";

// Returns the lines that call curl in the blocks after a mark. `blocks` receives the number of blocks.
std::vector<std::string> MarkedCommands(const std::string& text, int& blocks) {
  std::vector<std::string> commands;
  std::istringstream lines(text);
  bool marked = false, inside = false;
  blocks = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line == kMark) {
      marked = true;
      ++blocks;
    } else if (line.starts_with("```")) {
      inside = marked && !inside;
      marked = marked && inside;
    } else if (inside && line.starts_with("curl ")) {
      commands.push_back(line);
    }
  }
  return commands;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string Documentation() {
  return ReadText(SourceRoot() / "docs/api.md");
}

TEST(Documentation, MarksEveryBlockThatCallsTheService) {
  int blocks = 0;
  const std::vector<std::string> commands = MarkedCommands(Documentation(), blocks);
  EXPECT_GE(blocks, 5);
  std::istringstream lines(Documentation());
  std::size_t all = 0;
  for (std::string line; std::getline(lines, line);) all += line.starts_with("curl ");
  EXPECT_EQ(commands.size(), all) << "an example that no test runs";
}

TEST(Documentation, SaysWhatWorks) {
  if (!std::filesystem::exists(kCurl)) GTEST_SKIP() << kCurl << " is not installed";
  LiveServer server;
  const TempDir folder = TempDir::Create().value();
  std::filesystem::copy_file(Sample("cone.step"), folder.File("part.step"));
  const ChildOutcome mesh =
      RunProgram(Program("facetless"), {"mesh", "part.step", "--out", "exported.glb"}, folder.path());
  ASSERT_EQ(mesh.exit_code, 0) << mesh.error_tail;
  const std::string file = ReadText(folder.File("part.step"));
  const Reply model = server.PostForm("/v1/models", {{"file", "part.step", file}});
  const Reply job = server.PostForm("/v1/renders", {{"file", "part.step", file}}, {{"Prefer", "wait=0"}});
  ASSERT_EQ(job.status, 202) << job.body;
  const ChildOutcome key =
      RunProgram(Program("facetless"),
                 {"keys", "create", server.data(), "--name", "anna", "--scopes", "read,submit,admin"}, "/");
  const std::vector<std::string> variables = {"MODEL=" + model.Json().at("id").get<std::string>(),
                                              "JOB=" + job.Json().at("id").get<std::string>(),
                                              "KEY=" + Json::parse(key.out).at("key").get<std::string>()};
  // Run curl as written, but silently, and let it fail if the service answers with an error.
  const std::string quiet = std::string("curl() { ") + kCurl + " -sS --fail-with-body -o answer \"$@\"; }; ";
  int blocks = 0;
  for (const std::string& command : MarkedCommands(Documentation(), blocks)) {
    const std::string line = Replaced(command, kAddress, "http://127.0.0.1:" + std::to_string(server.port()));
    const ChildOutcome outcome = RunProgram("/bin/sh", {"-c", quiet + line}, folder.path(), variables);
    EXPECT_EQ(outcome.exit_code, 0) << command << "\n"
                                    << outcome.error_tail << ReadText(folder.File("answer"));
  }
}

}  // namespace
}  // namespace facetless
