#include "server/run/bench_stages.h"

#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <utility>

#include "server/base/files.h"
#include "server/base/json_text.h"
#include "server/base/temp_dir.h"
#include "server/importer/child_process.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostReport = std::size_t{256} << 20;  // bytes

std::string Text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

// The options that `render` and `compare` share with the bench.
std::vector<std::string> SharedArguments(const RunOptions& options, int threads) {
  std::vector<std::string> arguments = {"--size",
                                        std::to_string(options.width) + "x" + std::to_string(options.height),
                                        "--projection", ProjectionName(options.projection)};
  const auto add = [&](const char* name, std::string value) {
    arguments.insert(arguments.end(), {name, std::move(value)});
  };
  if (options.cameras.is_null()) {
    for (const std::string& view : options.views) add("--view", view);
  } else {
    add("--camera", options.cameras.dump());
  }
  add("--import-timeout", Text(options.import_limits.timeout_s));
  add("--import-memory", std::to_string(options.import_limits.memory_mb));
  if (options.unit_mm > 0) add("--unit", Text(options.unit_mm));
  if (threads > 0) add("--threads", std::to_string(threads));
  return arguments;
}

// Runs this program as a process of its own.
class Runner {
 public:
  Runner(const std::string& path, const Execution& execution, TempDir scratch)
      : path_(path), execution_(execution), scratch_(std::move(scratch)) {}

  // Measures a process of the program that does nothing.
  Result<double> Start() const {
    auto outcome = Run({"--version"});
    if (!outcome) return outcome.error();
    return outcome.value().wall_ms;
  }

  Result<ProgramStages> Measure(const char* command, std::vector<std::string> arguments,
                                double start_ms) const {
    const std::string out = scratch_.File(command);
    std::error_code error;
    arguments.insert(arguments.begin(),
                     {command, std::filesystem::absolute(path_, error).string(), "--out", out});
    auto outcome = Run(arguments);
    if (!outcome) return outcome.error();
    const auto text = ReadFile((std::filesystem::path(out) / "report.json").string(), kMostReport);
    if (!text)
      return Error{ErrorCode::kInternal,
                   std::string("facetless ") + command + " wrote no report: " + outcome.value().error_tail};
    auto report = ParseJsonText(text.value(), "report.json");
    if (!report) return report.error();
    std::filesystem::remove_all(out, error);
    ProgramStages run = StagesOf(report.value(), {outcome.value().wall_ms, start_ms});
    run.file = std::filesystem::path(path_).filename().string();
    return run;
  }

 private:
  Result<ChildOutcome> Run(const std::vector<std::string>& arguments) const {
    ChildRequest child;
    std::error_code error;
    child.program = std::filesystem::read_symlink("/proc/self/exe", error).string();
    child.arguments = arguments;
    for (char** entry = environ; *entry != nullptr; ++entry) child.environment.emplace_back(*entry);
    child.working_directory = scratch_.path();
    child.cancel = execution_.cancel;
    auto outcome = RunChild(child);
    if (outcome && outcome.value().end == ChildEnd::kCancelled)
      return Error{ErrorCode::kCancelled, "cancelled"};
    return outcome;
  }

  const std::string path_;
  const Execution execution_;
  const TempDir scratch_;
};

}  // namespace

Result<std::vector<ProgramStages>> MeasureStages(const std::string& path, const RunOptions& options,
                                                 int repeats, const Execution& execution) {
  auto scratch = TempDir::Create();
  if (!scratch) return scratch.error();
  const Runner runner(path, execution, std::move(scratch).value());
  const std::vector<std::string> arguments = SharedArguments(options, execution.threads);
  constexpr const char* kCommands[] = {"render", "compare"};
  std::vector<ProgramStages> runs[std::size(kCommands)];
  for (int round = 0; round <= repeats; ++round) {
    for (std::size_t i = 0; i < std::size(kCommands); ++i) {
      const Result<double> start_ms = runner.Start();
      if (!start_ms) return start_ms.error();
      auto run = runner.Measure(kCommands[i], arguments, start_ms.value());
      if (!run) return run.error();
      if (round > 0) runs[i].push_back(std::move(run).value());
    }
  }
  std::vector<ProgramStages> medians;
  for (std::vector<ProgramStages>& of_command : runs) medians.push_back(MedianRun(std::move(of_command)));
  return medians;
}

}  // namespace facetless
