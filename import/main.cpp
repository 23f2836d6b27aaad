// facetless-import reads one CAD file and writes one model file and any number of meshes; then the process
// ends. The caller sets its limits of memory, time and file size.
//
// With --serve-forks it becomes a process that forks a child for each file instead (sandbox/fork_requests.h).
//
// Standard output is one JSON object. Standard error has lines `progress STAGE FRACTION`. Exit status: 0
// written, 4 nothing usable, 64 bad usage.
#include <sys/resource.h>
#include <unistd.h>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import/command_line.h"
#include "import/convert.h"
#include "import/crash_note.h"
#include "import/exact_intersector.h"
#include "import/mesh_file.h"
#include "import/readers.h"
#include "import/scratch.h"
#include "import/source_file.h"
#include "import/warm_up.h"
#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/model/model_file.h"
#include "sandbox/fork_requests.h"

namespace facetless {
namespace {

constexpr int kExitDone = 0, kExitNothingUsable = 4, kExitUsage = 64;

std::uint64_t PeakBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Records when stages begin, and reports progress to standard error, at most once per whole per cent.
class Stages {
 public:
  static void Report(const char* stage, double fraction) {
    const int percent = static_cast<int>(fraction * 100);
    if (stage == last_stage_ && percent == last_percent_) return;
    if (stage != last_stage_) stopwatch_ = Stopwatch();
    last_stage_ = stage;
    last_percent_ = percent;
    std::fprintf(stderr, "progress %s %.2f\n", stage, fraction);
    if (fraction >= 1) {
      if (last_stage_ == "read") read_ms = stopwatch_.Milliseconds();
      if (last_stage_ == "transfer") transfer_ms = stopwatch_.Milliseconds();
      if (last_stage_ == "convert") convert_ms = stopwatch_.Milliseconds();
    }
  }
  inline static double read_ms = 0, transfer_ms = 0, convert_ms = 0;

 private:
  inline static std::string last_stage_;
  inline static int last_percent_ = -1;
  inline static Stopwatch stopwatch_;
};

// Reserves standard output for the importer's JSON. OpenCASCADE writes to standard output, too; its text goes
// to standard error instead.
class Answer {
 public:
  Answer() : descriptor_(dup(STDOUT_FILENO)) { dup2(STDERR_FILENO, STDOUT_FILENO); }
  ~Answer() { close(descriptor_); }
  Answer(const Answer&) = delete;
  Answer& operator=(const Answer&) = delete;

  void Write(const nlohmann::json& json) const {
    const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t count = write(descriptor_, text.data() + done, text.size() - done);
      if (count <= 0) return;
      done += static_cast<std::size_t>(count);
    }
  }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

// The answer of a process that runs out of time. It is prepared in advance, because a signal handler must not
// allocate memory.
std::string& DeadlineAnswer() {
  static std::string text;
  return text;
}
int deadline_descriptor = -1;

void GiveUp(int) {
  const std::string& text = DeadlineAnswer();
  const ssize_t written = write(deadline_descriptor, text.data(), text.size());
  _exit(written < 0 ? kExitUsage : kExitNothingUsable);
}

void SetDeadline(unsigned seconds, const Answer& answer) {
  std::string message = "The import took longer than ";
  message.append(std::to_string(seconds)).append(" s.");
  DeadlineAnswer() =
      nlohmann::json{{"ok", false},
                     {"error", {{"code", ErrorCodeName(ErrorCode::kLimitExceeded)}, {"message", message}}}}
          .dump() +
      "\n";
  deadline_descriptor = answer.descriptor();
  std::signal(SIGALRM, GiveUp);
  alarm(seconds);
}

int Fail(const Error& error, const Answer& answer) {
  answer.Write({{"ok", false}, {"error", {{"code", ErrorCodeName(error.code)}, {"message", error.message}}}});
  return error.code == ErrorCode::kBadUsage ? kExitUsage : kExitNothingUsable;
}

int OutOfMemory(const std::string& input, const Answer& answer) {
  return Fail({ErrorCode::kLimitExceeded, std::filesystem::path(input).filename().string() +
                                              ": the import needs more memory than it may use."},
              answer);
}

nlohmann::json HealedJson(const std::vector<HealedBody>& bodies) {
  nlohmann::json healed = nlohmann::json::array();
  for (const HealedBody& body : bodies)
    healed.push_back({{"name", body.name},
                      {"entity", body.entity},
                      {"reason", body.reason},
                      {"faces_changed", body.faces_changed},
                      {"edges_changed", body.edges_changed},
                      {"pcurves_changed", body.pcurves_changed},
                      {"moved_mm", body.moved_mm}});
  return healed;
}

nlohmann::json Summary(const Model& model, const std::vector<MeshReport>& meshes,
                       const std::vector<MeshRequest>& requests) {
  const ImportInfo& info = model.info;
  nlohmann::json summary{{"ok", true},
                         {"format", info.format},
                         {"unit", info.unit},
                         {"faces", model.faces.size()},
                         {"placed_faces", model.PlacedFaceCount()},
                         {"faces_declared", info.faces_declared},
                         {"faces_lost", info.faces_lost.size()},
                         {"loops_lost", info.loops_lost.size()},
                         {"edges_lost", info.edges_lost.size()},
                         {"approximated", info.approximated.size()},
                         {"bodies_healed", HealedJson(info.healed)},
                         {"solids", model.solids.size()},
                         {"parts", model.parts.size()},
                         {"instances", model.instances.size()},
                         {"patches", model.control_points.size()},
                         {"diagonal_mm", model.Diagonal()},
                         {"max_edge_gap_mm", info.max_edge_gap_mm},
                         {"read_ms", info.read_ms},
                         {"transfer_ms", info.transfer_ms},
                         {"convert_ms", info.convert_ms},
                         {"peak_bytes", info.peak_bytes},
                         {"warnings", info.warnings},
                         {"meshes", nlohmann::json::array()}};
  std::uint64_t patches = 0;
  for (const Surface& surface : model.surfaces) patches += surface.PatchCount();
  summary["patches"] = patches;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    summary["meshes"].push_back({{"path", requests[i].path},
                                 {"deflection_mm", meshes[i].deflection_mm},
                                 {"angular_deg", meshes[i].angular_deg},
                                 {"triangles", meshes[i].triangles},
                                 {"mesh_ms", meshes[i].mesh_ms},
                                 {"peak_bytes", meshes[i].peak_bytes},
                                 {"faces_unmeshed", meshes[i].faces_unmeshed}});
  }
  return summary;
}

int Import(const CommandLine& options, const Answer& answer) {
  const Scratch scratch;
  if (scratch.path().empty())
    return Fail({ErrorCode::kWriteFailed, "No folder for temporary files can be made; set TMPDIR to one."},
                answer);
  if (options.deadline_s > 0) SetDeadline(options.deadline_s, answer);
  PrepareOpenCascade(scratch.path());
  OpenCrashNote(scratch.path());
  // Read and convert.
  Result<SourceFile> source = OpenSource(options.input, scratch.path());
  if (!source.ok()) return Fail(source.error(), answer);
  Result<CadDocument> document = ReadDocument(source.value(), &Stages::Report, options.unit_mm);
  if (!document.ok()) return Fail(document.error(), answer);
  Stages::Report("convert", 0);
  Result<Conversion> conversion =
      Convert(std::move(document.value()), [](double fraction) { Stages::Report("convert", fraction); });
  if (!conversion.ok()) return Fail(conversion.error(), answer);
  Stages::Report("convert", 1);
  Model& model = conversion.value().model;
  if (!options.meshes.empty() && !(model.Diagonal() > 0))
    return Fail({ErrorCode::kNothingUsable, source.value().name + ": all of its geometry lies in one point."},
                answer);
  // Write the model before steps that may take long, so that the caller can use it if the mesher fails.
  model.info.read_ms = Stages::read_ms;
  model.info.transfer_ms = Stages::transfer_ms;
  model.info.convert_ms = Stages::convert_ms;
  model.info.peak_bytes = PeakBytes();
  if (Result<void> written = WriteModel(model, options.model); !written.ok())
    return Fail(written.error(), answer);
  // Mesh, once for each request.
  std::vector<MeshReport> meshes;
  for (const MeshRequest& request : options.meshes) {
    Stages::Report("mesh", 0);
    const double deflection =
        request.deflection_mm > 0 ? request.deflection_mm : request.deflection * model.Diagonal();
    Result<MeshReport> mesh = WriteMesh(conversion.value(), {deflection, request.angular_deg}, request.path,
                                        [](double fraction) { Stages::Report("mesh", fraction); });
    if (!mesh.ok()) return Fail(mesh.error(), answer);
    meshes.push_back(std::move(mesh.value()));
  }
  // Ask the exact intersector.
  nlohmann::json exact;
  if (!options.rays.empty()) {
    Stages::Report("intersect", 0);
    const double near = options.rays_near > 0 ? options.rays_near : -std::numeric_limits<double>::infinity();
    const Result<ExactTiming> timing = TimeExactIntersector(PlacedFaces(conversion.value()), options.rays,
                                                            options.depths, near, options.rays_seconds);
    if (!timing.ok()) return Fail(timing.error(), answer);
    exact = {{"rays", timing.value().rays}, {"trace_ms", timing.value().trace_ms}};
  }
  nlohmann::json summary = Summary(model, meshes, options.meshes);
  if (!exact.is_null()) summary["exact"] = std::move(exact);
  answer.Write(summary);
  return kExitDone;
}

int Run(int argc, const char* const* argv) {
  const auto options = ParseCommandLine(argc, argv);
  if (options.ok() && options.value().help) {
    std::cout << CommandLineHelp();
    return kExitDone;
  }
  const Answer answer;
  if (!options.ok()) {
    std::cerr << options.error().message << "\n";
    return Fail(options.error(), answer);
  }
  // Handle exceptions that the readers and the mesher did not catch.
  try {
    OCC_CATCH_SIGNALS
    int status = kExitDone;
    RunWithThreads(options.value().threads, [&] { status = Import(options.value(), answer); });
    return status;
  } catch (const std::bad_alloc&) {
    return OutOfMemory(options.value().input, answer);
  } catch (const Standard_OutOfMemory&) {
    return OutOfMemory(options.value().input, answer);
  } catch (const Standard_Failure& failure) {
    return Fail({ErrorCode::kFormatBroken, "OpenCASCADE failed on " + options.value().input + " (" +
                                               failure.DynamicType()->Name() + "); export the model again."},
                answer);
  }
}

int RunArguments(const std::vector<std::string>& arguments) {
  std::vector<const char*> words;
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  return Run(static_cast<int>(words.size()), words.data());
}

int ServeForks() {
  WarmUp();
  return ServeForkRequests(kForkSocket, RunArguments);
}

}  // namespace
}  // namespace facetless

int main(int argc, char** argv) {
  const bool serves = argc == 2 && std::string_view(argv[1]) == facetless::kServeForks;
  const int status = serves ? facetless::ServeForks() : facetless::Run(argc, argv);
  // Everything is written. OpenCASCADE's destructors of static objects race with the threads of its pool, and
  // about one run in ten crashes in them. Therefore the process ends without running them.
  std::cout.flush();
  std::fflush(nullptr);
  std::_Exit(status);
}
