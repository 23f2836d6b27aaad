#include "server/importer/openvdb_process.h"

#include <signal.h>

#include <filesystem>

#include "server/importer/import_process.h"
#include "server/importer/importer_child.h"

namespace facetless {
namespace {

std::string Program() {
  return ProgramBesideThis("facetless-openvdb");
}

// The error for a process that did not end by itself.
Error EndError(const ChildOutcome& outcome, const std::string& name, const OpenVdbRequest& request) {
  if (outcome.end == ChildEnd::kCancelled)
    return {ErrorCode::kCancelled, name + ": the work with OpenVDB was stopped"};
  if (outcome.end == ChildEnd::kTimedOut ||
      (outcome.end == ChildEnd::kSignalled && outcome.signal == SIGXCPU))
    return {ErrorCode::kLimitExceeded, name + ": OpenVDB took longer than " +
                                           std::to_string(static_cast<int>(request.timeout_s)) +
                                           " s; use --timeout to allow more"};
  if (outcome.end != ChildEnd::kSignalled)
    return {ErrorCode::kLimitExceeded, name + ": OpenVDB exceeded its limits of threads or files"};
  return {ErrorCode::kImporterCrashed, name + ": OpenVDB was killed by " + SignalName(outcome.signal) +
                                           "; write the file again, or in another format"};
}

}  // namespace

bool HasOpenVdb() {
  std::error_code failed;
  return std::filesystem::is_regular_file(Program(), failed);
}

Result<nlohmann::json> RunOpenVdb(const OpenVdbRequest& request, const TempDir& directory) {
  const std::string name = std::filesystem::path(request.input).filename().string();
  if (!HasOpenVdb())
    return Error{ErrorCode::kBadUsage,
                 "this build of Facetless cannot read or write .vdb files, since it was built without "
                 "OpenVDB; install "
                 "libopenvdb-dev and libboost-dev and build again, or use .vti or .nrrd"};
  if (auto checked = CheckInput(request.input); !checked) return checked.error();
  ChildRequest child;
  child.program = Program();
  std::error_code failed;
  child.arguments = {std::filesystem::absolute(request.input, failed).string()};
  child.arguments.insert(child.arguments.end(), request.arguments.begin(), request.arguments.end());
  child.arguments.insert(child.arguments.end(), {"--max-bytes", std::to_string(request.max_bytes)});
  ImportRequest limits;
  constexpr std::uint64_t kLibraryMb = 1024;  // of address space for libraries and the stacks of threads
  limits.limits.memory_mb = (request.max_bytes >> 20) + kLibraryMb;
  limits.limits.timeout_s = request.timeout_s > 0 ? request.timeout_s : 1e6;
  limits.limits.file_mb = std::uint64_t{1} << 20;
  limits.execution = request.execution;
  if (auto confined = Confine(limits, directory, child); !confined) return confined.error();
  child.limits.wall_seconds = request.timeout_s;
  const auto run = RunChild(child);
  if (!run) return run.error();
  const ChildOutcome& outcome = run.value();
  if (outcome.end != ChildEnd::kExited) return EndError(outcome, name, request);
  nlohmann::json answer = nlohmann::json::parse(outcome.out, nullptr, /*allow_exceptions=*/false);
  if (!answer.is_object())
    return Error{ErrorCode::kImporterCrashed,
                 name + ": facetless-openvdb ended without an answer, with exit code " +
                     std::to_string(outcome.exit_code) + ": " + outcome.error_tail.substr(0, 500)};
  if (const auto error = answer.find("error"); error != answer.end() && error->is_object())
    return Error{ErrorCodeFromName(error->value("code", "")),
                 error->value("message", name + ": OpenVDB failed")};
  return answer;
}

}  // namespace facetless
