#include "server/service/jobs/job_kinds.h"

#include <string_view>

#include "server/options/option_values.h"
#include "server/service/jobs/job_runs.h"

namespace facetless {
namespace {

constexpr std::string_view kRoot = "/v1/";

bool Takes(const JobKindRow& row, const OptionRow& option) {
  return option.owner == OptionOwner::kCaller && (option.commands & row.commands) != 0;
}

// Returns the addresses of the kinds whose commands have the option: "/v1/renders or /v1/comparisons".
std::string PathsOf(const OptionRow& option) {
  std::string paths;
  for (const JobKindRow& row : JobKinds())
    if ((row.commands & option.commands) != 0) paths += (paths.empty() ? "" : " or ") + row.addresses.front();
  return paths;
}

Result<void> CheckComparison(const RunOptions& options) {
  return CheckMeshCanShow(options.inspection, true);
}

}  // namespace

const std::vector<JobKindRow>& JobKinds() {
  static const std::vector<JobKindRow> kKinds = {
      {.kind = JobKind::kModel, .name = "model", .addresses = {"/v1/models"}},
      {.kind = JobKind::kRender,
       .name = "render",
       .addresses = {"/v1/renders", "/v1/render"},
       .commands = kRender,
       .run = RunRenderJob},
      {.kind = JobKind::kComparison,
       .name = "comparison",
       .addresses = {"/v1/comparisons", "/v1/compare"},
       .commands = kCompare,
       .compares_mesh = true,
       .check = CheckComparison,
       .run = RunComparisonJob},
      {.kind = JobKind::kTrade,
       .name = "trade",
       .addresses = {"/v1/trades"},
       .commands = kTrade,
       .run = RunTradeJob},
  };
  return kKinds;
}

const JobKindRow& RowOf(JobKind kind) {
  return JobKinds().at(static_cast<std::size_t>(kind));
}

const std::string& JobKindName(JobKind kind) {
  static const std::string kUnknownName = "unknown";
  return kind == JobKind::kUnknown ? kUnknownName : RowOf(kind).name;
}

JobKind JobKindOf(const std::string& name) {
  for (const JobKindRow& row : JobKinds())
    if (row.name == name) return row.kind;
  return JobKind::kUnknown;
}

std::string Collection(const JobKindRow& row) {
  return row.addresses.front().substr(kRoot.size());
}

std::vector<std::string> CollectionsOf(const OptionRow& option) {
  std::vector<std::string> collections;
  for (const JobKindRow& row : JobKinds())
    if (Takes(row, option)) collections.push_back(Collection(row));
  return collections;
}

Result<void> CheckOptionNames(const JobKindRow& row, const nlohmann::json& options) {
  std::vector<std::string> taken;
  for (const OptionRow& option : AllOptions())
    if (Takes(row, option)) taken.push_back(option.name);
  for (const auto& [key, value] : options.items()) {
    const OptionRow* option = FindOption(key);
    if (option == nullptr)
      return BadUsage("there is no option " + Shortened(key) + Suggestion(OptionName(key), taken) +
                      "; the options of " + Collection(row) + " are " + Joined(taken));
    if (option->owner == OptionOwner::kOperator)
      return BadUsage(option->name + " is not an option of a request; the operator of the service sets it");
    if (option->owner == OptionOwner::kCommandLine)
      return BadUsage(option->name + " is not an option of a request; it is one of the command line alone");
    if (option->owner == OptionOwner::kPart)
      return BadUsage(option->name + " is not an option of a request; it is a part of the body, which " +
                      PathsOf(*option) + " takes");
    if (!Takes(row, *option))
      return BadUsage(option->name + " is not an option of " + Collection(row) +
                      ": leave it out, or send the request to " + PathsOf(*option));
  }
  return {};
}

}  // namespace facetless
