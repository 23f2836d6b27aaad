#include "server/command/cli_options.h"

#include <CLI/CLI.hpp>

#include <utility>
#include <vector>

#include "server/base/files.h"
#include "server/base/json_text.h"

namespace facetless {

using Json = nlohmann::json;

void OptionCollector::Add(CLI::App* app, const OptionRow& row) {
  const std::string flag = CommandLineName(row), name = row.name, help = HelpText(row);
  CLI::Option* option = nullptr;
  if (row.kind == OptionKind::kFlag) {
    option = app->add_flag_callback(
        flag, [=, this] { json_[name] = true; }, help);
  } else if (row.kind == OptionKind::kInteger || row.kind == OptionKind::kNumber) {
    option = app->add_option_function<double>(
        flag, [=, this](double v) { json_[name] = v; }, help);
  } else if (row.repeatable) {
    option = app->add_option_function<std::vector<std::string>>(
                    flag, [=, this](const std::vector<std::string>& v) { json_[name] = v; }, help)
                 ->expected(1)
                 ->take_all();
  } else {
    option = app->add_option_function<std::string>(
        flag, [=, this](const std::string& v) { json_[name] = v; }, help);
  }
  if (!row.value.empty()) option->type_name(row.value);
  option->group(row.group);
}

Result<Json> OptionCollector::CollectedOptions() {
  if (!json_.contains("camera")) return json_;
  std::string text = json_["camera"].get<std::string>();
  if (text.starts_with("@")) {
    constexpr std::size_t kMaxCameraFile = 1 << 20;
    auto file = ReadFile(text.substr(1), kMaxCameraFile);
    if (!file) return Error{ErrorCode::kBadUsage, "--camera: " + file.error().message};
    text = std::move(file).value();
  }
  auto camera = ParseJsonText(text, "--camera");
  if (!camera)
    return Error{ErrorCode::kBadUsage,
                 camera.error().message + "; an example is '{\"eye\":[200,-300,150],\"height\":120}'"};
  json_["camera"] = std::move(camera).value();
  return json_;
}

void AddOptions(CLI::App* app, Commands command, OptionCollector& options, const OptionTable& table) {
  for (const OptionRow& row : table)
    if ((row.commands & command) != 0) options.Add(app, row);
}

void AddBenchOptions(CLI::App* app, CommandArguments& arguments) {
  BenchSettings& bench = arguments.bench;
  app->add_option("FILE", arguments.files,
                  "STEP, IGES, BREP or model files; with --published also voxel files");
  app->add_option("--repeats", bench.repeats,
                  "Runs of each measurement after a warm-up; the median is reported")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->add_option("--time-limit", bench.time_limit_s,
                  "Time limit of one mesh in seconds; a slower mesh is reported at the limit")
      ->type_name("S")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--json", arguments.json_out, "Also write all measurements to FILE")->type_name("FILE");
  app->add_option("--plot", arguments.plot_out, "Also plot the rows of the table")->type_name("FILE.svg");
  app->add_option("--stage-plot", arguments.stage_plot_out,
                  "Also plot the stages of render and compare, from start to end")
      ->type_name("FILE.svg");
  app->add_flag("--markdown", bench.markdown, "Print the tables as Markdown");
  app->add_flag("!--no-growth", bench.growth, "Leave out row 9, which takes about a minute");
  app->add_flag("!--no-stages", bench.stages, "Leave out the stages of render and compare");
  app->add_flag("--published", bench.published, "Measure the tables of the published papers instead");
  app->add_flag("--openvdb", bench.openvdb, "Compare voxels of the files with OpenVDB's instead");
  app->add_flag("--structures", bench.structures,
                "Compare the structures for rays in any direction instead, on random boxes and on the files");
}

}  // namespace facetless
