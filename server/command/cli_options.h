// The options of the commands, as --help shows them.
//
//  1. An option of a run is a row of the option table; it is collected as JSON under its own name, and
//     checked where requests over HTTP are (options.h): every check exists once.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/command/commands.h"
#include "server/options/option_table.h"

namespace CLI {
class App;
}

namespace facetless {

class OptionCollector {
 public:
  // Lets `app` take the option.
  void Add(CLI::App* app, const OptionRow& row);

  // What was given. Errors: kBadUsage (a camera that is no JSON, or whose file cannot be read).
  Result<nlohmann::json> Take();

 private:
  nlohmann::json json_ = nlohmann::json::object();
};

// Those that the command, one bit of Commands, takes, in the order of the table and under its headings.
void AddOptions(CLI::App* app, Commands command, OptionCollector& options,
                const OptionTable& table = AllOptions());
void AddBenchOptions(CLI::App* app, CommandArguments& arguments);

}  // namespace facetless
