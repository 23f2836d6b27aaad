// The command-line options of the commands.
//
//     OptionCollector options;
//     AddOptions(app, kRender, options);
//     app->parse(argc, argv);
//     Result<nlohmann::json> json = options.CollectedOptions();  // for ParseOptions
//
//  1. Each option of a run is a row of the option table. Its value is collected as JSON under its name, and
//     checked by the same code as HTTP requests (options.h), so that every check exists once.
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
  // Adds the option to `app`.
  void Add(CLI::App* app, const OptionRow& row);

  // The options that were given. Errors: kBadUsage (a camera that is not JSON, or whose file cannot be read).
  Result<nlohmann::json> CollectedOptions();

 private:
  nlohmann::json json_ = nlohmann::json::object();
};

// Adds the options of `command` (one bit of Commands), in the order and under the headings of the table.
void AddOptions(CLI::App* app, Commands command, OptionCollector& options,
                const OptionTable& table = AllOptions());
void AddBenchOptions(CLI::App* app, CommandArguments& arguments);

}  // namespace facetless
