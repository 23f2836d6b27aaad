// The options of each group of commands, as --help shows them.
//
//  1. An option of a run is collected as JSON under its own name, and checked where requests over HTTP are (options.h): every check
//     exists once.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/command/commands.h"

namespace CLI {
class App;
}

namespace facetless {

class OptionCollector {
 public:
  void Text(CLI::App* app, const std::string& flag, const std::string& help, const std::string& type);
  void Number(CLI::App* app, const std::string& flag, const std::string& help, const std::string& type);
  void Switch(CLI::App* app, const std::string& flag, const std::string& help);
  // May be given several times.
  void List(CLI::App* app, const std::string& flag, const std::string& help, const std::string& type);

  // What was given. Errors: kBadUsage (a camera that is no JSON, or whose file cannot be read).
  Result<nlohmann::json> Take();

 private:
  nlohmann::json json_ = nlohmann::json::object();
};

void AddCameraOptions(CLI::App* app, OptionCollector& options);
void AddViewOptions(CLI::App* app, OptionCollector& options);  // those of cameras, too
void AddShowHiddenOption(CLI::App* app, OptionCollector& options);
void AddPictureOptions(CLI::App* app, OptionCollector& options);
void AddTurntableOptions(CLI::App* app, OptionCollector& options);
void AddTessellationOptions(CLI::App* app, OptionCollector& options);
void AddTradeOptions(CLI::App* app, OptionCollector& options);
void AddBenchOptions(CLI::App* app, CommandArguments& arguments);
void AddImportOptions(CLI::App* app, OptionCollector& options, CommandArguments& arguments);

}  // namespace facetless
