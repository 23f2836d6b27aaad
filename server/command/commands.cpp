#include "server/command/commands.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "render/base/utf8.h"
#include "render/baseline/mesh_file.h"
#include "render/inspect/report.h"
#include "render/model/model_file.h"
#include "server/base/exit_code.h"
#include "server/base/files.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"
#include "server/command/progress.h"
#include "server/run/mesh_output.h"
#include "server/run/methods.h"
#include "server/run/own_mesh.h"
#include "server/run/regress.h"
#include "server/run/run.h"
#include "server/run/trade.h"
#include "server/run/verdict.h"
#include "server/run/voxel_convert.h"
#include "server/run/voxel_output.h"
#include "server/run/voxel_render.h"

namespace facetless {
namespace {

void Print(const std::string& text) {
  std::printf("%s\n", text.c_str());
}

Execution ToExecution(const CommandArguments& arguments) {
  return {arguments.options.threads, &InterruptFlag()};
}

ImportRequest ToImportRequest(const CommandArguments& arguments, Progress& progress) {
  ImportRequest request;
  request.input = arguments.file;
  request.limits = arguments.options.import_limits;
  request.unit_mm = arguments.options.unit_mm;
  request.execution = ToExecution(arguments);
  request.progress = [&progress](const std::string& stage, double fraction) {
    progress.Report(stage, fraction);
  };
  return request;
}

RunContext ToContext(const CommandArguments& arguments, Progress& progress) {
  return {ToExecution(arguments),
          [&progress](const std::string& stage, double fraction) { progress.Report(stage, fraction); }};
}

// The exit code that follows from losses. `unmeshed` is the number of faces without a triangle.
int LossExitCode(const RunOptions& options, const Model& model, std::size_t unmeshed = 0) {
  if (options.strict && !KnowsUnit(model)) return kExitFailed;
  if (LossCount(model) + unmeshed == 0) return kExitDone;
  return options.strict ? kExitFailed : kExitLost;
}

constexpr std::size_t kMostNamed = 20;  // faces, on standard error

// Warns of the faces without a triangle.
void WarnOfUnmeshed(const std::vector<std::string>& faces) {
  for (std::size_t i = 0; i < std::min(faces.size(), kMostNamed); ++i)
    std::fprintf(stderr,
                 "facetless: warning: the mesh lacks the face %s: the mesher made no triangle of it\n",
                 Printable(faces[i]).c_str());
  if (faces.size() > kMostNamed)
    std::fprintf(stderr, "facetless: warning: the mesh lacks %zu more faces\n", faces.size() - kMostNamed);
}

// Prints the reasons why a run failed.
void PrintFailures(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences)
    std::fprintf(stderr, "facetless: failed: %s\n", Printable(sentence).c_str());
}

// The path of the file that a run left in `directory` in a role.
std::string PathOf(const RunFiles& files, const std::string& role, const std::string& directory) {
  return (std::filesystem::path(directory) / files.Json("").at(role).get<std::string>()).string();
}

// Prints the path of the report and the reasons for a failure, and returns the exit code of the verdict.
int PrintRun(const Result<RunResult>& run, const std::string& directory) {
  if (!run) return PrintError(run.error());
  Print(PathOf(run.value().files, "report", directory));
  for (const std::string& warning : run.value().warnings)
    std::fprintf(stderr, "facetless: warning: %s\n", warning.c_str());
  PrintFailures(VerdictSentences(run.value().verdict));
  return run.value().verdict.exit_code;
}

}  // namespace

int InspectCommand(const CommandArguments& arguments) {
  Progress progress(arguments.progress);
  auto imported = Import(ToImportRequest(arguments, progress));
  if (!imported) return PrintError(imported.error());
  const nlohmann::json answer = {{"facetless", ProgramJson(arguments.options.threads)},
                                 {"model", ImportedModelJson(imported.value())}};
  Print(JsonText(answer));
  return LossExitCode(arguments.options, *imported.value().model);
}

int ContinuityCommand(const CommandArguments& arguments) {
  Progress progress(arguments.progress);
  auto imported = Import(ToImportRequest(arguments, progress));
  if (!imported) return PrintError(imported.error());
  const Model& model = *imported.value().model;
  const auto continuity = MeasureContinuity(model, ToExecution(arguments));
  if (!continuity) return PrintError(continuity.error());
  const nlohmann::json answer = {
      {"facetless", ProgramJson(arguments.options.threads)},
      {"model",
       {{"file", model.info.file}, {"sha256", model.info.sha256}, {"diagonal_mm", model.Diagonal()}}},
      {"continuity", ContinuityJson(continuity.value(), model)}};
  Print(JsonText(answer));
  return LossExitCode(arguments.options, model);
}

int RenderCommand(const CommandArguments& arguments) {
  Progress progress(arguments.progress);
  const bool voxels = VoxelFormatOf(arguments.file).ok();
  if (const auto allowed = CheckRenderOptions(arguments.given, voxels); !allowed)
    return PrintError(allowed.error());
  if (voxels) {
    const auto rendered =
        RunVoxelRender(arguments.file, arguments.options, arguments.out, ToContext(arguments, progress));
    if (!rendered) return PrintError(rendered.error());
    Print(JsonText(rendered.value()));
    return kExitDone;
  }
  auto imported = Import(ToImportRequest(arguments, progress));
  if (!imported) return PrintError(imported.error());
  return PrintRun(
      RunRender(imported.value(), arguments.options, arguments.out, ToContext(arguments, progress)),
      arguments.out);
}

int MeshCommand(const CommandArguments& arguments) {
  // Refuse an unknown suffix before the import.
  const auto format = MeshFormatFromPath(arguments.out);
  if (!format) return PrintError(format.error());
  Progress progress(arguments.progress);
  ImportRequest request = ToImportRequest(arguments, progress);
  request.meshes = {arguments.options.tessellation};
  auto files = RunImporter(request);
  if (!files) return PrintError(files.error());
  auto model = ReadModel(files.value().model_path);
  if (!model) return PrintError(model.error());
  const std::vector<std::string>& unmeshed = files.value().summary.meshes.front().faces_unmeshed;
  WarnOfUnmeshed(unmeshed);
  auto mesh = LoadMesh(files.value().mesh_paths.front(), {}, nullptr);
  if (!mesh && mesh.error().code == ErrorCode::kNothingUsable)
    return PrintError({ErrorCode::kNothingUsable, "the mesher made no triangle of any face"});
  if (!mesh) return PrintError(mesh.error());
  auto said = WriteMeshFiles(model.value(), std::move(mesh).value(), format.value(),
                             arguments.options.picture.arrangement.show_hidden, arguments.out);
  if (!said) return PrintError(said.error());
  Print(arguments.out);
  for (const std::string& sentence : said.value())
    std::fprintf(stderr, "facetless: %s\n", Printable(sentence).c_str());
  return LossExitCode(arguments.options, model.value(), unmeshed.size());
}

int CompareCommand(const CommandArguments& arguments) {
  Progress progress(arguments.progress);
  const RunOptions& options = arguments.options;
  // Refuse inspections that no mesh can show before the import.
  if (auto can = CheckMeshCanShow(options.inspection, true); !can) return PrintError(can.error());
  if (options.mesh.empty() && !(options.mesh_unit + options.mesh_up).empty())
    return PrintError(
        {ErrorCode::kBadUsage, "--mesh-unit and --mesh-up apply to --mesh, which is not given"});
  const ImportRequest request = ToImportRequest(arguments, progress);
  if (options.mesh.empty()) {
    auto compared = CompareWithOwnMesh(request, options, arguments.out, ToContext(arguments, progress));
    if (!compared) return PrintError(compared.error());
    WarnOfUnmeshed(compared.value().faces_unmeshed);
    return PrintRun(std::move(compared.value().run), arguments.out);
  }
  // Compare with the mesh of the user.
  auto imported = Import(request);
  if (!imported) return PrintError(imported.error());
  auto mesh = LoadMesh(options.mesh, {.unit = options.mesh_unit, .up = options.mesh_up},
                       imported.value().model.get());
  if (!mesh) return PrintError(mesh.error());
  WarnOfUnmeshed(mesh.value().faces_unmeshed);
  return PrintRun(
      RunCompare(imported.value(), mesh.value(), options, arguments.out, ToContext(arguments, progress)),
      arguments.out);
}

int TradeCommand(const CommandArguments& arguments) {
  TradeResult trade;
  {
    Progress progress(arguments.progress);
    const ImportRequest request = ToImportRequest(arguments, progress);
    auto imported = Import(request);
    if (!imported) return PrintError(imported.error());
    auto result =
        RunTrade(request, imported.value(), arguments.options, arguments.out, ToContext(arguments, progress));
    if (!result) return PrintError(result.error());
    trade = std::move(result).value();
  }
  // Print the table, which is for users, to standard error. Standard output gets only the path, which is for
  // programs.
  std::fputs(trade.text.c_str(), stderr);
  return PrintRun(std::move(trade.run), arguments.out);
}

int MethodsCommand(const CommandArguments& arguments) {
  if (arguments.file.empty()) {
    if (!arguments.out.empty())
      return PrintError({ErrorCode::kBadUsage, "--out needs a FILE on which the methods are measured"});
    std::fputs(MethodsText().c_str(), stdout);
    return kExitDone;
  }
  Progress progress(arguments.progress);
  auto imported = Import(ToImportRequest(arguments, progress));
  if (!imported) return PrintError(imported.error());
  auto measured =
      RunMethods(imported.value(), arguments.options, arguments.out, ToContext(arguments, progress));
  if (!measured) return PrintError(measured.error());
  std::fputs(measured.value().text.c_str(), stdout);
  return LossExitCode(arguments.options, *imported.value().model);
}

int VoxelizeCommand(const CommandArguments& arguments) {
  // Refuse an unknown suffix before the import.
  if (const auto format = VoxelFormatOf(arguments.out); !format) return PrintError(format.error());
  Progress progress(arguments.progress);
  auto imported = Import(ToImportRequest(arguments, progress));
  if (!imported) return PrintError(imported.error());
  auto made = RunVoxelize(imported.value(), arguments.options, arguments.out, ToContext(arguments, progress));
  if (!made) return PrintError(made.error());
  Print(JsonText(made.value().json));
  for (const std::string& warning : made.value().warnings)
    std::fprintf(stderr, "facetless: warning: %s\n", Printable(warning).c_str());
  return LossExitCode(arguments.options, *imported.value().model);
}

int ConvertCommand(const CommandArguments& arguments) {
  Progress progress(arguments.progress);
  auto converted =
      RunConvert(arguments.file, arguments.out, arguments.options, ToContext(arguments, progress));
  if (!converted) return PrintError(converted.error());
  Print(JsonText(converted.value().json));
  for (const std::string& warning : converted.value().warnings)
    std::fprintf(stderr, "facetless: warning: %s\n", Printable(warning).c_str());
  return kExitDone;
}

int BenchCommand(const CommandArguments& arguments) {
  BenchReport report;
  {
    Progress progress(arguments.progress);
    ImportRequest request = ToImportRequest(arguments, progress);
    request.progress = nullptr;
    auto measured = RunBench(arguments.files, request, arguments.options, arguments.bench,
                             ToContext(arguments, progress));
    if (!measured) return PrintError(measured.error());
    report = std::move(measured).value();
  }
  for (const auto& [path, text] :
       {std::pair{arguments.json_out, JsonText(report.json) + "\n"},
        std::pair{arguments.plot_out, report.plot}, std::pair{arguments.stage_plot_out, report.stage_plot}}) {
    if (path.empty()) continue;
    if (auto written = WriteFileAtomically(path, text); !written) return PrintError(written.error());
  }
  std::fputs(report.text.c_str(), stdout);
  return kExitDone;
}

int RegressCommand(const CommandArguments& arguments) {
  Progress progress(arguments.progress);
  RegressRequest request;
  request.manifest = arguments.file;
  request.out = arguments.out;
  request.update = arguments.update;
  request.import_limits = arguments.options.import_limits;
  request.unit_mm = arguments.options.unit_mm;
  request.context = ToContext(arguments, progress);
  const auto result = RunRegress(request);
  if (!result) return PrintError(result.error());
  Print(JsonText(result.value().verdict));
  PrintFailures(result.value().failures);
  return result.value().exit_code;
}

}  // namespace facetless
