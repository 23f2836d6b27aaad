// The options of `facetless serve`, from a file, the environment and the command line.
//
//  1. The sources, in ascending precedence, are: the default; a file (--config, or FACETLESS_SERVE_CONFIG);
//     the environment, in which --max-upload is FACETLESS_SERVE_MAX_UPLOAD; and the command line. An empty
//     variable is ignored.
//  2. A file that begins with { is JSON; any other file is TOML. It has one value for each option, under its
//     name without the leading dashes and with _ or - inside, at the top level or in a section [serve]. An
//     unknown name is an error.
//  3. All values are checked in the same way, and error messages name the source of the value.
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
  // Adds the options to the command, which must outlive this object.
  explicit ServeConfig(CLI::App* command);
  ServeConfig(const ServeConfig&) = delete;
  ServeConfig& operator=(const ServeConfig&) = delete;

  // Determines the options. Call it after the command line has been parsed. Error: kBadUsage.
  Result<ServeOptions> Resolve();

  bool print() const { return print_; }  // --print-config
  // The options after Resolve, such as {"listen": {"value": "127.0.0.1:8080", "source": "default"}, "jobs":
  // {"value": 4, "source": "environment", "name": "FACETLESS_SERVE_JOBS"}, …}. For values from a file, "name"
  // is its path.
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

// Reads the values of a configuration file, as texts by option. Errors: kBadUsage.
Result<std::map<std::string, std::string>> ReadConfigFile(const std::string& path);

}  // namespace facetless
