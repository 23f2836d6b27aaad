#include "server/importer/plain_read.h"

#include <filesystem>
#include <utility>

#include "server/importer/importer_child.h"

namespace facetless {

Result<void> ReadPlainly(const ImportRequest& request, PlainHealing healing) {
  if (auto checked = CheckInput(request.input); !checked) return checked.error();
  auto directory = TempDir::Create(request.temp_parent);
  if (!directory) return directory.error();
  ChildRequest child;
  child.program = ProgramBesideThis("facetless-plain-read");
  std::error_code path_error;
  child.arguments = {std::filesystem::absolute(request.input, path_error).string()};
  if (healing == PlainHealing::kNone)
    child.arguments.insert(child.arguments.end(), {"--unhealed", directory.value().path()});
  if (auto confined = Confine(request, directory.value(), child); !confined) return confined.error();
  child.limits.wall_seconds = request.limits.timeout_s;
  auto run = RunChild(child);
  if (!run) return run.error();
  const ChildOutcome& outcome = run.value();
  const std::string name = std::filesystem::path(request.input).filename().string();
  if (outcome.end == ChildEnd::kCancelled)
    return Error{ErrorCode::kCancelled, name + ": OpenCASCADE's reader was stopped"};
  if (outcome.end == ChildEnd::kTimedOut)
    return Error{ErrorCode::kNothingUsable, "OpenCASCADE's reader takes longer than --import-timeout allows"};
  if (outcome.end != ChildEnd::kExited || outcome.exit_code != 0)
    return Error{ErrorCode::kNothingUsable, "OpenCASCADE's reader fails on the file"};
  return {};
}

}  // namespace facetless
