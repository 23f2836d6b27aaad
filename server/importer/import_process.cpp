#include "server/importer/import_process.h"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include "render/base/stopwatch.h"
#include "server/base/files.h"
#include "server/importer/child_process.h"
#include "server/importer/importer_child.h"

namespace facetless {
namespace {

// The largest length of a message of the importer; its genuine messages are shorter.
constexpr std::size_t kMessageBytes = 2000;

// The text of a number, which reads back as the same double.
std::string Number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string Seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%g s", seconds);
  return text;
}

// The current stage of the importer and the time spent, because meshing has a time limit of its own (law 4).
class StageClock {
 public:
  void Enter(std::string_view stage) {
    (meshing() ? mesh_s_ : other_s_) += stage_time_.Seconds();
    stage_time_ = Stopwatch();
    stage_ = stage;
  }
  const std::string& stage() const { return stage_; }
  bool meshing() const { return stage_ == kMeshStage; }
  bool Expired(const ImportLimits& limits) {
    Enter(std::string(stage_));
    return mesh_s_ > limits.mesh_timeout_s || other_s_ > limits.timeout_s;
  }

 private:
  static constexpr std::string_view kMeshStage = "mesh";
  Stopwatch stage_time_;
  std::string stage_;
  double mesh_s_ = 0, other_s_ = 0;
};

// Parses a line such as "progress transfer 0.25".
void ReportProgress(std::string_view line, const ImportRequest& request, StageClock& clock) {
  constexpr std::string_view kPrefix = "progress ";
  if (!line.starts_with(kPrefix)) return;
  line.remove_prefix(kPrefix.size());
  const std::size_t space = line.find(' ');
  if (space == std::string_view::npos) return;
  double fraction = 0;
  const auto parsed = std::from_chars(line.data() + space + 1, line.data() + line.size(), fraction);
  if (parsed.ec != std::errc{} || !(fraction >= 0 && fraction <= 1)) return;
  const std::string_view name = line.substr(0, space);
  constexpr std::array<std::string_view, 5> kStages = {"read", "transfer", "convert", "mesh", "intersect"};
  if (std::find(kStages.begin(), kStages.end(), name) == kStages.end()) return;
  clock.Enter(name);
  if (request.progress) request.progress(clock.stage(), fraction);
}

// The entity that a killed importer had noted as its position (import/crash_note.h), in its own folder within
// `directory`. Only letters, digits and '#' are accepted.
std::string LastEntity(const std::string& directory) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    if (!entry.path().filename().string().starts_with("facetless-import-")) continue;
    const auto text = ReadFile((entry.path() / "entity").string(), 64);
    if (!text) continue;
    const std::string& note = text.value();
    const auto end = std::find_if(note.begin(), note.end(), [](char c) {
      return c != '#' && !std::isalnum(static_cast<unsigned char>(c));
    });
    return {note.begin(), end};
  }
  return {};
}

constexpr const char* kCoarserMesh = ", and a coarser --deflection needs less";

Error TimeError(const std::string& name, const ImportLimits& limits, bool meshing) {
  const std::string message = meshing ? ": meshing took longer than " + Seconds(limits.mesh_timeout_s) +
                                            "; use --mesh-timeout to allow more" + kCoarserMesh
                                      : ": the import took longer than " + Seconds(limits.timeout_s) +
                                            "; use --import-timeout to allow more";
  return {ErrorCode::kLimitExceeded, name + message};
}

Error MemoryError(const std::string& name, const ImportLimits& limits, bool meshing) {
  return {ErrorCode::kLimitExceeded, name + (meshing ? ": meshing" : ": the import") + " needs more than " +
                                         std::to_string(limits.memory_mb) +
                                         " MB of memory; use --import-memory to allow more" +
                                         (meshing ? kCoarserMesh : "")};
}

Error SizeError(const std::string& name, const ImportLimits& limits) {
  return {ErrorCode::kLimitExceeded,
          name + ": the imported model is larger than " + std::to_string(limits.file_mb) + " MB"};
}

// Returns whether a death by a signal was caused by a failed allocation: the library reported it, or the
// address space had come within an eighth of its limit. (The peak does not include the request that failed.)
bool RanOutOfMemory(const ChildOutcome& outcome, const ChildLimits& limits) {
  if (outcome.error_tail.find("bad_alloc") != std::string::npos ||
      outcome.error_tail.find("annot allocate memory") != std::string::npos)
    return true;
  return limits.memory_bytes > 0 &&
         outcome.peak_address_bytes > limits.memory_bytes - limits.memory_bytes / 8;
}

// The error for a child that did not exit by itself; nothing if it did. `entity` is the position at which a
// signal killed it.
std::optional<Error> EndError(const ChildOutcome& outcome, const ChildLimits& child_limits,
                              const std::string& name, const ImportLimits& limits, const StageClock& clock,
                              const std::string& entity) {
  switch (outcome.end) {
    case ChildEnd::kExited:
      return std::nullopt;
    case ChildEnd::kCancelled:
      return Error{ErrorCode::kCancelled, name + ": the import was stopped"};
    case ChildEnd::kTimedOut:
      return TimeError(name, limits, clock.meshing());
    case ChildEnd::kTooManyThreads:
      return Error{ErrorCode::kLimitExceeded, name + ": the import started more than " +
                                                  std::to_string(child_limits.threads) + " threads"};
    case ChildEnd::kDirectoryTooLarge:
      return SizeError(name, limits);
    case ChildEnd::kTooManyNames:
      return Error{ErrorCode::kLimitExceeded, name + ": the import wrote more than " +
                                                  std::to_string(child_limits.directory_names) + " files"};
    case ChildEnd::kSignalled:
      break;
  }
  if (outcome.signal == SIGXCPU) return TimeError(name, limits, clock.meshing());
  if (outcome.signal == SIGXFSZ) return SizeError(name, limits);
  // Only the out-of-memory killer of the kernel, or a user, can have sent this SIGKILL.
  if (outcome.signal == SIGKILL)
    return Error{
        ErrorCode::kLimitExceeded,
        name + ": the import was killed from outside, most likely because the machine ran out of memory"};
  if (RanOutOfMemory(outcome, child_limits)) return MemoryError(name, limits, clock.meshing());
  if (clock.meshing())
    return Error{ErrorCode::kImporterCrashed, name + ": the mesher was killed by " +
                                                  SignalName(outcome.signal) +
                                                  "; another --deflection may avoid it"};
  return Error{ErrorCode::kImporterCrashed,
               name + ": the importer was killed by " + SignalName(outcome.signal) + " while reading it" +
                   (clock.stage().empty() ? "" : ", in the stage \"" + clock.stage() + "\"") +
                   (entity.empty() ? "" : ", at or after entity " + entity) +
                   "; export the model again, or in another format"};
}

// The cause in one word, for metrics; nullptr if the child exited or was cancelled.
const char* ImporterDeathCause(const ChildOutcome& outcome, const ChildLimits& child_limits) {
  switch (outcome.end) {
    case ChildEnd::kExited:
    case ChildEnd::kCancelled:
      return nullptr;
    case ChildEnd::kTimedOut:
      return "timeout";
    case ChildEnd::kTooManyThreads:
      return "threads";
    case ChildEnd::kDirectoryTooLarge:
    case ChildEnd::kTooManyNames:
      return "output";
    case ChildEnd::kSignalled:
      break;
  }
  if (outcome.signal == SIGXCPU) return "timeout";
  if (outcome.signal == SIGXFSZ) return "output";
  return outcome.signal == SIGKILL || RanOutOfMemory(outcome, child_limits) ? "memory" : "crash";
}

// A message of the importer, shortened and on one line, with a question mark for each byte that is neither
// printable ASCII nor part of a longer UTF-8 sequence.
std::string Printable(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size() && out.size() < kMessageBytes;) {
    const auto lead = static_cast<unsigned char>(text[at]);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xc2 && lead < 0xe0 ? 2
                               : lead >= 0xe0 && lead < 0xf0 ? 3
                               : lead >= 0xf0 && lead < 0xf5 ? 4
                                                             : 0;
    bool sound = length > 0 && at + length <= text.size() && lead != 0x7f && lead >= 0x20;
    for (std::size_t i = 1; sound && i < length; ++i)
      sound = (static_cast<unsigned char>(text[at + i]) & 0xc0) == 0x80;
    out += sound ? std::string(text.substr(at, length)) : "?";
    at += sound ? length : 1;
  }
  return out;
}

// The error in an answer; nothing if there is none.
std::optional<Error> AnsweredError(const nlohmann::json& answer, const std::string& name) {
  const auto error = answer.find("error");
  if (error == answer.end()) return std::nullopt;
  const auto text = [&](const char* key) {
    const auto found = error->is_object() ? error->find(key) : error->end();
    return found != error->end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  const std::string message = Printable(text("message"));
  return Error{ErrorCodeFromName(text("code")),
               message.empty() ? name + ": the importer gave no reason" : message};
}

// The error if `path` is not a proper output file; otherwise nothing. Links, pipes and devices could lead to
// other files or block.
std::optional<Error> OutputError(const std::string& path, const std::string& name) {
  struct stat info = {};
  const auto broken = [&](const char* what) {
    return Error{ErrorCode::kImporterCrashed, name + ": the importer's answer is " + what};
  };
  if (lstat(path.c_str(), &info) != 0) return broken("incomplete: a file is missing");
  if (!S_ISREG(info.st_mode)) return broken("invalid: one of its files is not a regular file");
  if (info.st_nlink != 1) return broken("invalid: one of its files has a second hard link");
  return std::nullopt;
}

// ": " and the last line that is not a progress line; "" if there is none.
std::string LastLine(const std::string& text) {
  std::string last;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && !line.starts_with("progress ")) last = line;
  }
  return last.empty() ? last : ": " + Printable(last);
}

// Reads the depths that the importer wrote for at most `count` rays.
Result<std::vector<double>> ReadDepths(const std::string& path, std::size_t count) {
  auto bytes = ReadFile(path, count * sizeof(double));
  if (!bytes) return bytes.error();
  std::vector<double> depths(bytes.value().size() / sizeof(double));
  std::memcpy(depths.data(), bytes.value().data(), depths.size() * sizeof(double));
  return depths;
}

// The command line of the importer, without the rays. It also sets the paths of the files in `files`.
std::vector<std::string> ImporterArguments(const ImportRequest& request, ImportedFiles& files) {
  std::error_code path_error;
  std::vector<std::string> arguments = {std::filesystem::absolute(request.input, path_error).string(),
                                        "--model", files.model_path};
  if (request.unit_mm > 0) arguments.insert(arguments.end(), {"--unit-mm", Number(request.unit_mm)});
  if (request.execution.threads > 0)
    arguments.insert(arguments.end(), {"--threads", std::to_string(request.execution.threads)});
  for (std::size_t i = 0; i < request.meshes.size(); ++i) {
    const TessellationOptions& mesh = request.meshes[i];
    files.mesh_paths.push_back(files.directory.File("mesh" + std::to_string(i) + ".glb"));
    const bool absolute = mesh.deflection_mm > 0;
    arguments.insert(
        arguments.end(),
        {"--mesh", files.mesh_paths.back(), absolute ? "--deflection-mm" : "--deflection",
         Number(absolute ? mesh.deflection_mm : mesh.deflection), "--angular", Number(mesh.angular_deg)});
  }
  return arguments;
}

// Writes the rays for the exact intersector, and adds their path to the arguments.
Result<void> AddRays(const IntersectorRays& exact, const std::string& rays_path,
                     const std::string& depths_path, std::vector<std::string>& arguments) {
  if (auto written = WriteFileAtomically(rays_path, {reinterpret_cast<const char*>(exact.rays.data()),
                                                     exact.rays.size() * sizeof exact.rays[0]});
      !written)
    return written.error();
  arguments.insert(arguments.end(),
                   {"--rays", rays_path, "--depths", depths_path, "--rays-seconds", Number(exact.seconds)});
  if (exact.near > 0) arguments.insert(arguments.end(), {"--rays-near", Number(exact.near)});
  return {};
}

// Evaluates the end of an importer. Returns nothing, with the answer in `files`, or the failure with its
// cause in one word.
std::optional<MeshFailure> EvaluateImporterEnd(const ChildOutcome& outcome, const ChildLimits& child_limits,
                                               const ImportRequest& request, const StageClock& clock,
                                               const std::vector<std::string>& outputs,
                                               ImportedFiles& files) {
  const std::string name = std::filesystem::path(request.input).filename().string();
  const auto died = [&](const char* cause) {
    if (cause != nullptr && request.died) request.died(cause);
  };
  const char* cause = ImporterDeathCause(outcome, child_limits);
  died(cause);
  if (auto error = EndError(outcome, child_limits, name, request.limits, clock,
                            outcome.end == ChildEnd::kSignalled ? LastEntity(files.directory.path()) : ""))
    return MeshFailure{cause != nullptr ? cause : "", *error};
  files.answer = nlohmann::json::parse(outcome.out, nullptr, /*allow_exceptions=*/false);
  const bool answered = files.answer.is_object();
  if (answered) {
    if (auto error = AnsweredError(files.answer, name)) {
      const bool memory =
          error->code == ErrorCode::kLimitExceeded;  // the only limit that the importer itself can report
      if (memory && clock.meshing()) error = MemoryError(name, request.limits, true);
      if (clock.meshing() && !error->message.starts_with(name)) error->message = name + ": " + error->message;
      return MeshFailure{memory ? "memory" : "failed", *error};
    }
  }
  if (!answered || outcome.exit_code != 0) {
    died("answer");
    return MeshFailure{
        "crash",
        {ErrorCode::kImporterCrashed, name + ": the importer gave up with exit code " +
                                          std::to_string(outcome.exit_code) + LastLine(outcome.error_tail)}};
  }
  for (const std::string& output : outputs) {
    if (auto error = OutputError(output, name)) {
      died("answer");
      return MeshFailure{"crash", *error};
    }
  }
  return std::nullopt;
}

}  // namespace

ForkServerSettings ImporterForkServer() {
  return {.program = ImporterPath(), .environment = ImporterEnvironment(), .log = {}};
}

ErrorCode ErrorCodeFromName(const std::string& name) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code) {
    if (name == ErrorCodeName(static_cast<ErrorCode>(code))) return static_cast<ErrorCode>(code);
  }
  return ErrorCode::kInternal;
}

Result<ImportedFiles> RunImporter(const ImportRequest& request) {
  const std::string name = std::filesystem::path(request.input).filename().string();
  if (auto checked = CheckInput(request.input); !checked) return checked.error();
  auto directory = TempDir::Create(request.temp_parent);
  if (!directory) return directory.error();
  ImportedFiles files;
  files.directory = std::move(directory).value();
  files.model_path = files.directory.File("model.flm");

  // Set the program, its arguments and its limits.
  ChildRequest child;
  child.program = ImporterPath();
  child.arguments = ImporterArguments(request, files);
  std::vector<std::string> outputs = files.mesh_paths;
  outputs.push_back(files.model_path);
  const std::string depths_path = files.directory.File("depths.bin");
  if (!request.exact.rays.empty()) {
    outputs.push_back(depths_path);
    if (auto added = AddRays(request.exact, files.directory.File("rays.bin"), depths_path, child.arguments);
        !added)
      return added.error();
  }

  child.fork_server = request.fork_server;
  if (auto confined = Confine(request, files.directory, child); !confined) return confined.error();
  StageClock clock;
  bool model_told = false;
  child.expired = [&] { return clock.Expired(request.limits); };
  child.on_stderr_line = [&](std::string_view line) {
    ReportProgress(line, request, clock);
    if (model_told || !clock.meshing()) return;
    model_told = true;
    if (request.model_written && !OutputError(files.model_path, name))
      request.model_written(files.model_path);
  };

  // Run the importer, and convert its end to files or an error.
  auto run = RunChild(child);
  if (!run) return run.error();
  const ChildOutcome& outcome = run.value();
  files.wall_ms = outcome.wall_ms;
  if (request.ended) request.ended(outcome.forked);
  files.peak_bytes = outcome.peak_bytes;
  files.peak_address_bytes = outcome.peak_address_bytes;
  if (auto failure = EvaluateImporterEnd(outcome, child.limits, request, clock, outputs, files)) {
    const bool keeps_model = request.model_suffices && clock.meshing() &&
                             outcome.end != ChildEnd::kCancelled && !OutputError(files.model_path, name);
    if (!keeps_model) return failure->error;
    files.mesh_failure = std::move(failure);
    files.mesh_paths.clear();
    files.answer = nullptr;
    return files;
  }
  files.summary = ReadImportSummary(files.answer, request.meshes.size());
  if (!request.exact.rays.empty()) {
    auto depths = ReadDepths(depths_path, request.exact.rays.size());
    if (!depths) return depths.error();
    files.exact_depths = std::move(depths).value();
  }
  return files;
}

}  // namespace facetless
