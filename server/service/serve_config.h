// The options of `facetless serve`, from where people who run services keep them.
//
//  1. In rising precedence: the default; a file (--config, or FACETLESS_SERVE_CONFIG); the environment, where
//     --max-upload is FACETLESS_SERVE_MAX_UPLOAD; the command line. An empty variable is none.
//  2. A file is JSON if it begins with {, else TOML: one value for each option, by its name without the
//     dashes in front, with _ or - inside, at the top or in a section [serve]. An unknown name is an error.
//  3. Every value goes through the same checks, and what is wrong is said with the place that it comes from.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/service/serve.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace facetless {

class ServeConfig {
 public:
  // Adds the options to the command, which must outlive this.
  explicit ServeConfig(CLI::App* command);
  ServeConfig(const ServeConfig&) = delete;
  ServeConfig& operator=(const ServeConfig&) = delete;

  // To be called when the command line was parsed. Error: kBadUsage.
  Result<ServeOptions> Resolve();

  bool print() const { return print_; }  // --print-config
  // {"listen": {"value": "127.0.0.1:8080", "source": "default"}, "jobs": {"value": 4, "source":
  // "environment", "name": "FACETLESS_SERVE_JOBS"}, …} as Resolve left it; the name of a file's values is its
  // path.
  nlohmann::json Description() const;

 private:
  struct Setting {
    std::string name;
    CLI::Option* option = nullptr;
    std::function<nlohmann::json()> value;
    std::string source = "default", place;
  };
  template <typename T>
  CLI::Option* Add(const std::string& name, T& value, const std::string& help, const std::string& type);
  void AddFlag(const std::string& name, bool& value, const std::string& help);
  void AddBounds();
  Result<void> TakeFile(const std::string& path);
  Result<void> Apply(Setting& setting, const std::string& text, const std::string& source,
                     const std::string& place);
  Setting* Find(const std::string& name);

  CLI::App* command_;
  ServeOptions options_;
  std::vector<Setting> settings_;
  std::string file_;
  bool print_ = false;
};

// The values of a configuration file by option, as texts. Errors: kBadUsage.
Result<std::map<std::string, std::string>> ReadConfigFile(const std::string& path);

}  // namespace facetless
