// Tests the sources of the options of `facetless serve`, as --print-config reports them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "server/base/exit_code.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class ServeConfiguration : public testing::Test {
 protected:
  ChildOutcome Run(std::vector<std::string> arguments, const std::vector<std::string>& environment = {}) {
    arguments.insert(arguments.begin(), {"serve", "--print-config"});
    return RunProgram(Program("facetless"), arguments, directory_.path(), environment);
  }
  Json Print(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {}) {
    const ChildOutcome outcome = Run(arguments, environment);
    EXPECT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
    return Json::parse(outcome.out, nullptr, false);
  }
  std::string File(const std::string& text) { return WriteText(directory_.File("serve.conf"), text); }
  void ExpectRefused(const ChildOutcome& outcome, const std::string& names) {
    EXPECT_EQ(outcome.exit_code, kExitUsage) << outcome.out;
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.error_tail, HasSubstr(names));
  }

  TempDir directory_ = TempDir::Create().value();
};

TEST_F(ServeConfiguration, IsTheDefaultsWhereNobodySaysAnything) {
  const Json config = Print({});
  EXPECT_EQ(config.at("listen"), (Json{{"value", "127.0.0.1:8080"}, {"source", "default"}}));
  EXPECT_EQ(config.at("jobs").at("value"), 2);
  EXPECT_EQ(config.at("require-keys").at("value"), false);
  EXPECT_NE(config.at("data").at("value"), "") << "the directory that would be used";
  for (const auto& [name, entry] : config.items()) EXPECT_EQ(entry.at("source"), "default") << name;
}

TEST_F(ServeConfiguration, RisesFromFileToEnvironmentToCommandLine) {
  const std::string file = File("jobs = 3\nqueue = 10\nmax-upload = 20\n");
  const Json config =
      Print({"--config", file, "--queue", "30"}, {"FACETLESS_SERVE_JOBS=5", "FACETLESS_SERVE_QUEUE=6"});
  EXPECT_EQ(config.at("max-upload"), (Json{{"value", 20}, {"source", "file"}, {"name", file}}));
  EXPECT_EQ(config.at("jobs"),
            (Json{{"value", 5}, {"source", "environment"}, {"name", "FACETLESS_SERVE_JOBS"}}));
  EXPECT_EQ(config.at("queue"), (Json{{"value", 30}, {"source", "command line"}}));
  EXPECT_EQ(config.at("timeout").at("source"), "default");
}

TEST_F(ServeConfiguration, ReadsTomlAndJsonAlike) {
  const std::vector<std::string> texts = {
      "# ours\n[serve]\nlisten = \"0.0.0.0:80\"\nmax_age = 1.5\nrequire-keys = true\nlog = 'json'\n",
      "listen = \"0.0.0.0:80\"\nmax-age = 1.5\nrequire_keys = true\nlog = \"json\"\n",
      R"({"listen": "0.0.0.0:80", "max-age": 1.5, "require_keys": true, "log": "json"})",
      R"( {"serve": {"listen": "0.0.0.0:80", "max_age": 1.5, "require-keys": true, "log": "json"}})"};
  for (const std::string& text : texts) {
    // The environment may name the configuration file, too.
    const Json config = Print({}, {"FACETLESS_SERVE_CONFIG=" + File(text)});
    EXPECT_EQ(config.at("listen").at("value"), "0.0.0.0:80") << text;
    EXPECT_EQ(config.at("max-age").at("value"), 1.5) << text;
    EXPECT_EQ(config.at("require-keys").at("value"), true) << text;
    EXPECT_EQ(config.at("log").at("value"), "json") << text;
    EXPECT_EQ(config.at("allow-anonymous").at("source"), "default") << text;
  }
}

TEST_F(ServeConfiguration, SaysWhatOfAFileIsUnknown) {
  ExpectRefused(Run({"--config", File("jobs = 3\ncolour = red\n")}), "\"colour\"");
  ExpectRefused(Run({"--config", File(R"({"jobs": 3, "colour": "red"})")}), "\"colour\"");
  ExpectRefused(Run({"--config", File("[paint]\njobs = 3\n")}), "paint.jobs");
  ExpectRefused(Run({"--config", File("config = other.toml\n")}), "\"config\"");
  // An unknown option must be refused even if it would change nothing.
  ExpectRefused(Run({"--config", File("colour = red\n"), "--jobs", "1"}), "\"colour\"");
}

TEST_F(ServeConfiguration, ChecksEveryValueWhereverItComesFrom) {
  ExpectRefused(Run({"--config", File("jobs = 0\n")}), "serve.conf: ");
  ExpectRefused(Run({"--config", File("jobs = many\n")}), "jobs");
  ExpectRefused(Run({"--config", File(R"({"jobs": [1, 2]})")}), "\"jobs\"");
  ExpectRefused(Run({"--config", File("jobs = 1\nqueue = 2\njobs = 3\n")}), "\"jobs\" twice");
  ExpectRefused(Run({"--config", File("{\"jobs\": 3")}), "is not valid JSON: line 1, column 11");
  ExpectRefused(Run({"--config", File("require-keys = perhaps\n")}), "require-keys");
  ExpectRefused(Run({}, {"FACETLESS_SERVE_JOBS=0"}), "FACETLESS_SERVE_JOBS");
  ExpectRefused(Run({}, {"FACETLESS_SERVE_LOG=xml"}), "FACETLESS_SERVE_LOG");
  ExpectRefused(Run({"--config", directory_.File("absent")}), "--config");
  ExpectRefused(Run({"--jobs", "0"}), "--jobs");
}

TEST_F(ServeConfiguration, TakesAnEmptyVariableForNone) {
  EXPECT_EQ(Print({}, {"FACETLESS_SERVE_JOBS="}).at("jobs").at("source"), "default");
}

}  // namespace
}  // namespace facetless
