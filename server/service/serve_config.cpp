#include "server/service/serve_config.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "server/base/files.h"
#include "server/base/json_text.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxFileBytes = 1 << 20;
constexpr const char* kSection = "serve";

Error BadUsage(const std::string& message) {
  return {ErrorCode::kBadUsage, message};
}

std::string EnvironmentName(const std::string& option) {
  std::string name = "FACETLESS_SERVE_" + option;
  for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

// The value of the environment variable; "" if it is not set.
std::string Environment(const std::string& option) {
  const char* value = std::getenv(EnvironmentName(option).c_str());
  return value == nullptr ? "" : value;
}

std::string WithDashes(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

using Values = std::map<std::string, std::string>;

Result<void> AddValue(Values& values, const std::string& path, const std::string& name,
                      const std::string& text) {
  if (values.emplace(WithDashes(name), text).second) return {};
  return BadUsage(path + " has \"" + name + "\" twice");
}

Result<void> AddJson(Values& values, const std::string& path, const Json& json, bool top) {
  for (const auto& [name, value] : json.items()) {
    if (top && name == kSection && value.is_object()) {
      if (auto added = AddJson(values, path, value, false); !added) return added;
      continue;
    }
    if (!value.is_string() && !value.is_number() && !value.is_boolean())
      return BadUsage(path + ": \"" + name + "\" must be a string, a number, true or false");
    auto added = AddValue(values, path, name, value.is_string() ? value.get<std::string>() : value.dump());
    if (!added) return added;
  }
  return {};
}

Result<void> AddToml(Values& values, const std::string& path, const std::string& text) {
  std::istringstream lines(text);
  for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(lines)) {
    // Skip the marks of the library for the beginning and the end of a section.
    if (item.name == "++" || item.name == "--") continue;
    const bool known = item.parents.empty() || (item.parents.size() == 1 && item.parents[0] == kSection);
    if (!known) return BadUsage(path + ": there is no section for \"" + item.fullname() + "\"");
    if (item.inputs.size() != 1) return BadUsage(path + ": \"" + item.name + "\" must have one value");
    if (auto added = AddValue(values, path, item.name, item.inputs[0]); !added) return added;
  }
  return {};
}

}  // namespace

Result<Values> ReadConfigFile(const std::string& path) {
  auto text = ReadFile(path, kMaxFileBytes);
  if (!text) return BadUsage("--config: " + text.error().message);
  Values values;
  const std::size_t first = text.value().find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text.value()[first] == '{') {
    const auto json = ParseJsonText(text.value(), path);
    if (!json) return json.error();
    if (auto added = AddJson(values, path, json.value(), true); !added) return added.error();
    return values;
  }
  try {
    if (auto added = AddToml(values, path, text.value()); !added) return added.error();
  } catch (const CLI::Error& error) {
    return BadUsage(path + ": " + error.what());
  }
  return values;
}

// ---- The options ----

template <typename T>
CLI::Option* ServeConfig::Add(const std::string& name, T& value, const std::string& help,
                              const std::string& type) {
  CLI::Option* option = command_->add_option("--" + name, value, help)->type_name(type);
  Setting setting;
  setting.name = name;
  setting.option = option;
  setting.value = [&value] { return Json(value); };
  settings_.push_back(std::move(setting));
  return option;
}

void ServeConfig::AddFlag(const std::string& name, bool& value, const std::string& help) {
  Setting setting;
  setting.name = name;
  setting.option = command_->add_flag("--" + name, value, help);
  setting.value = [&value] { return Json(value); };
  settings_.push_back(std::move(setting));
}

ServeConfig::ServeConfig(CLI::App* command) : command_(command) {
  Add("listen", options_.listen, "Address and port to listen on; port 0 selects a free one", "ADDR:PORT")
      ->capture_default_str();
  Add("ops-listen", options_.ops_listen,
      "Separate address and port for operators, without keys: /healthz, /readyz and /metrics", "ADDR:PORT");
  Add("data", options_.data, "Directory of models and results (default: " + DefaultDataDirectory() + ")",
      "DIR");
  Add("log", options_.log,
      "Format of the log: json, text, or auto, which is text on a terminal and json otherwise", "FORM")
      ->check(CLI::IsMember({"auto", "json", "text"}))
      ->capture_default_str();
  AddBounds();
  Add("allow-host", options_.allow_host,
      "Host names under which clients reach the service, besides localhost and numeric addresses, as a list "
      "a,b; *.NAME allows all names below NAME, * allows any name. A service without keys on a loopback "
      "address refuses requests for other hosts",
      "NAMES");
  Add("allow-origin", options_.allow_origin,
      "Origins of other sites whose pages may send requests, as a list a,b", "ORIGINS");
  AddFlag("require-keys", options_.require_keys, "Require a key for every request, on any address");
  AddFlag("allow-anonymous", options_.allow_anonymous,
          "Accept requests without a key, also on an address that other hosts can reach");
  command_->add_option("--config", file_, "File with these options, JSON or TOML (docs/api.md)")
      ->type_name("FILE");
  command_->add_flag("--print-config", print_,
                     "Print the value of each option and where it comes from, and exit");
}

void ServeConfig::AddBounds() {
  Add("jobs", options_.jobs, "Number of jobs that run at the same time", "N")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  Add("queue", options_.queue, "Number of jobs that may wait; further requests get status 503", "N")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  Add("max-upload", options_.max_upload_mb, "Largest upload in megabytes", "MB")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  Add("max-samples", options_.max_samples,
      "Largest number of samples of one request: pixels × samples per pixel × views", "N")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  Add("timeout", options_.timeout_s, "Time limit in seconds for a job, and for an upload", "S")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  Add("import-memory", options_.import_memory_mb, "Limit of an importer's address space in megabytes", "MB")
      ->check(CLI::Range(64, 1 << 30))
      ->capture_default_str();
  Add("max-view-memory", options_.max_view_memory_mb,
      "Memory limit in megabytes for the leaves of views and the search trees of meshes, shared equally by "
      "the jobs that run at the same time; a view that needs more than its share is refused",
      "MB")
      ->check(CLI::Range(64, 1 << 30))
      ->capture_default_str();
  Add("max-store", options_.max_store_mb,
      "Largest size of the stored files in megabytes; the least recently used are deleted first (0: no "
      "limit)",
      "MB")
      ->check(CLI::Range(0, 1 << 30))
      ->capture_default_str();
  Add("max-age", options_.max_age_days, "Days after which unused models and answers are deleted (0: never)",
      "DAYS")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

// ---- The sources of their values ----

ServeConfig::Setting* ServeConfig::Find(const std::string& name) {
  const auto found = std::find_if(settings_.begin(), settings_.end(),
                                  [&](const Setting& setting) { return setting.name == name; });
  return found == settings_.end() ? nullptr : &*found;
}

Result<void> ServeConfig::Apply(Setting& setting, const std::string& text, const std::string& source,
                                const std::string& place) {
  try {
    setting.option->clear();
    setting.option->add_result(text);
    setting.option->run_callback();
  } catch (const CLI::Error& error) {
    return BadUsage(place + ": " + error.what());
  }
  setting.source = source;
  setting.place = place;
  return {};
}

Result<void> ServeConfig::TakeFile(const std::string& path) {
  auto values = ReadConfigFile(path);
  if (!values) return values.error();
  // Check the names in the file first, even those of options that another source overrides.
  std::string known;
  for (const Setting& setting : settings_) known += (known.empty() ? "" : ", ") + setting.name;
  for (const auto& [name, text] : values.value()) {
    if (Find(name) == nullptr)
      return BadUsage(path + " has \"" + name + "\", which is not an option; the options are " + known);
  }
  for (const auto& [name, text] : values.value()) {
    Setting& setting = *Find(name);
    if (setting.source != "default") continue;
    if (auto applied = Apply(setting, text, "file", path); !applied) return applied;
  }
  return {};
}

Result<ServeOptions> ServeConfig::Resolve() {
  for (Setting& setting : settings_) {
    if (setting.option->count() > 0) setting.source = "command line";
  }
  for (Setting& setting : settings_) {
    const std::string text = Environment(setting.name);
    if (text.empty() || setting.source != "default") continue;
    if (auto applied = Apply(setting, text, "environment", EnvironmentName(setting.name)); !applied)
      return applied.error();
  }
  const std::string path = file_.empty() ? Environment("config") : file_;
  if (!path.empty()) {
    if (auto taken = TakeFile(path); !taken) return taken.error();
  }
  if (options_.data.empty()) options_.data = DefaultDataDirectory();
  return options_;
}

Json ServeConfig::Description() const {
  Json json = Json::object();
  for (const Setting& setting : settings_) {
    Json& entry = json[setting.name];
    entry = {{"value", setting.value()}, {"source", setting.source}};
    if (!setting.place.empty()) entry["name"] = setting.place;
  }
  return json;
}

}  // namespace facetless
