#include "server/run/run.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "render/base/stopwatch.h"
#include "render/baseline/mesh_file.h"
#include "render/baseline/tracer.h"
#include "render/compare/compare_view.h"
#include "render/compare/mesh_deviation.h"
#include "render/compare/pixel_data.h"
#include "render/compare/report.h"
#include "render/compare/section_report.h"
#include "render/image/radiance_map.h"
#include "render/inspect/report.h"
#include "render/lines/draw_lines.h"
#include "render/model/model_file.h"
#include "server/base/files.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"
#include "server/options/shade_option.h"
#include "server/run/mesh_check.h"
#include "server/run/pictures.h"
#include "server/run/report_html.h"
#include "server/run/shown_model.h"
#include "server/run/trace_options.h"
#include "server/run/verdict.h"
#include "server/run/view_files.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

std::string SvgOf(const ImportedModel& imported, const Camera& camera, const View& view) {
  const bool flat = camera.projection == Projection::kOrthographic;
  return LinesSvg(view.lines, camera.width_px, camera.height_px, flat ? view.frame.pixel_x : 0,
                  imported.model->info.file + ", " + camera.name);
}

// Measures the deviation of every triangle and writes its file. Returns the report's "mesh_deviation".
Result<Json> WriteMeshDeviation(const Model& model, const Mesh& mesh, const std::string& directory,
                                const Execution& execution) {
  const auto measured = MeasureMeshDeviation(model, mesh, execution);
  if (!measured) return measured.error();
  const MeshDeviation& deviation = measured.value();
  if (auto written = WriteFileAtomically(directory + "/mesh.bin", EncodeMeshDeviation(mesh, deviation));
      !written)
    return written.error();
  return Json{{"triangles", deviation.triangles},
              {"max_mm", deviation.largest_mm},
              {"max_mm_at_least", deviation.largest_at_least_mm},
              {"p99_mm", deviation.p99_mm},
              {"faces_missing", deviation.faces_missing.size()},
              {"faces_missing_named", deviation.faces_missing}};
}

// Adds to an error that the memory was shared with the search tree: without the tree, the view may have
// enough.
Error BesideTree(const ImportedModel& imported, const BaselineScene& tree, const Error& error) {
  char text[100];
  std::snprintf(text, sizeof text, ": beside the mesh's search tree of %.4g MB, ",
                static_cast<double>(tree.bvh_bytes()) / (1 << 20));
  return {error.code, imported.model->info.file + text + error.message};
}

Json NoBaselineJson(const NoBaseline& why) {
  return {{"reason", why.reason}, {"message", why.message}};
}

// Returns true if there is a view, and the exact picture of every view is empty.
bool ShowsNothing(const Json& views) {
  for (const Json& view : views)
    if (view.at("direct").at("hits").get<std::uint64_t>() > 0) return false;
  return !views.empty();
}

// The parts that all runs share, with a mesh or without: cameras, the clock, the report's common entries and
// its files.
class Run {
 public:
  Run(const ImportedModel& imported, const RunOptions& options, const std::string& directory,
      const RunContext& context, const char* command)
      : imported_(imported),
        options_(options),
        directory_(directory),
        context_(context),
        command_(command),
        timeout_s_(options.timeout_s.value_or(kRunTimeoutS)),
        deadline_(timeout_s_, context.execution.cancel) {}

  // The execution ends at the run's deadline.
  Execution execution() const { return context_.execution.WithFlag(deadline_.flag()); }
  // Makes the scene, which does not depend on the view.
  Scene MakeScene() {
    const Stopwatch stopwatch;
    Scene scene(*imported_.model);
    scene_ms_ = stopwatch.Milliseconds();
    return scene;
  }
  const std::string& directory() const { return directory_; }
  // Stores a value that belongs to no single view under `key` of the report; null is not stored.
  void Note(const std::string& key, Json value) {
    if (!value.is_null()) notes_[key] = std::move(value);
  }
  // The files that the run leaves in its directory.
  RunFiles& files() { return result_.files; }
  // Records the rays and the time of the exact view, and a warning if its picture needs one.
  void NoteExact(const std::string& name, const View& view) {
    constexpr double kMillisecond = 1e-3;
    if (view.direct)
      result_.traced.push_back(
          {static_cast<double>(view.direct->rays), view.direct->trace_ms * kMillisecond});
    const std::string note = view.inspection ? SideNote(*view.inspection) : "";
    if (!note.empty()) result_.warnings.push_back(name + ": " + note);
  }

  // Renders all frames around the first view.
  Result<void> Turntable(const Representation& exact, const ViewOptions& view) {
    if (options_.picture.turntable == 0) return {};
    const auto progress = [this](double fraction) {
      if (context_.progress) context_.progress("turntable", fraction);
    };
    auto turntable =
        RenderTurntable({exact, *imported_.model, options_, view, directory_, progress}, files());
    if (!turntable) return Explained(turntable.error());
    Note("turntable", std::move(turntable).value());
    return {};
  }

  // Resolves the section planes and measures their cuts through the model and, if there is one, the mesh.
  Result<std::vector<SectionPlane>> Sections(const Scene& scene, const Mesh* mesh) {
    auto planes = ResolveSections(options_.sections, imported_.model->bounds);
    if (!planes || planes.value().empty()) return planes;
    SectionAreaOptions area;
    area.execution = execution();
    auto measured = SectionsJson(scene, mesh, planes.value(), area);
    if (!measured) return Explained(measured.error());
    Note("sections", std::move(measured).value());
    return planes;
  }

  // Calls `one` for each camera; `one` returns the view's entry in the report.
  template <typename One>
  Result<Json> ForEachView(One one) {
    if (auto made = MakeDirectories(directory_); !made) return made.error();
    auto cameras = ResolveCameras(options_, imported_.model->bounds);
    if (!cameras) return cameras.error();
    Json views = Json::array();
    for (const Camera& camera : cameras.value()) {
      Progress(static_cast<double>(views.size()) / static_cast<double>(cameras.value().size()));
      Result<Json> view =
          execution().cancelled() ? Result<Json>(Error{ErrorCode::kCancelled, "stopped"}) : one(camera);
      if (!view) return Explained(view.error());
      views.push_back(std::move(view).value());
    }
    Progress(1);
    return views;
  }

  // Adds a sentence of the verdict that fails the run. It is written once, not per view.
  void Problem(const std::string& sentence) { findings_.problems.push_back(sentence); }
  void LacksBaseline(const NoBaseline& why) {
    findings_.no_baseline = why.message;
    result_.no_baseline = why;
    Note("no_baseline", NoBaselineJson(why));
  }
  // Adds the findings about the mesh itself and, if requested, its deviation.
  Result<void> JudgeMesh(const Mesh& mesh, const MeshCheck& check) {
    if (options_.mesh_deviation) {
      auto measured = WriteMeshDeviation(*imported_.model, mesh, directory_, execution());
      if (!measured) return Explained(measured.error());
      Note("mesh_deviation", std::move(measured).value());
      files().Add("", "mesh", "mesh.bin");
    }
    for (const std::string& problem : check.Problems()) Problem(problem);
    if (const std::size_t turned = TrianglesAgainstNormals(mesh); turned > 0)
      Problem("the mesh is turned inside out: " + std::to_string(turned) +
              " of its triangles run against the normals at their corners");
    findings_.unmeshed = mesh.faces_unmeshed.size();
    return {};
  }

  // Returns the times of this run. An import that was made for an earlier run took none of its time, and is
  // listed separately.
  Json TimingJson() const {
    const double import_ms = imported_.import_kept ? 0 : imported_.import_ms;
    Json timing = {{"import", import_ms},
                   {"load", imported_.load_ms},
                   {"scene", scene_ms_},
                   {"total", import_ms + imported_.load_ms + stopwatch_.Milliseconds()}};
    const ImportInfo& info = imported_.model->info;
    if (imported_.import_kept)
      timing["import_kept"] = imported_.import_ms;
    else
      timing.update({{"import_read", info.read_ms},
                     {"import_transfer", info.transfer_ms},
                     {"import_convert", info.convert_ms}});
    return timing;
  }

  // Completes the report and writes it.
  Result<RunResult> Finish(Json views, const std::vector<ViewValues>& values) {
    if (!options_.sections.empty() && ShowsNothing(views))
      Problem("no view shows anything: the section planes remove all of the model that the views look at");
    for (const Json& view : views) NoteContradictions(view);
    findings_.lost = LossCount(*imported_.model);
    findings_.unit_known = KnowsUnit(*imported_.model);
    result_.verdict = Judge(options_, values, findings_);
    Json report = {{"facetless", ProgramJson(context_.execution.threads)},
                   {"command", command_},
                   {"options",
                    {{"samples", options_.samples},
                     {"method", options_.method.method->name},
                     {"precision", PrecisionName(options_.accuracy.precision)},
                     {"shade", FormatInspection(options_.inspection)},
                     {"orient", options_.orient == Orient::kViewer ? "viewer" : "file"},
                     {"edges", options_.edges},
                     {"audit", options_.audit}}},
                   {"model", ImportedModelJson(imported_)},
                   {"views", std::move(views)},
                   {"timing_ms", TimingJson()},
                   {"verdict", VerdictJson(result_.verdict)}};
    if (ShowsSmoothness(options_.inspection.kind)) {
      const auto continuity = MeasureContinuity(*imported_.model, execution());
      if (!continuity) return Explained(continuity.error());
      report["continuity"] = ContinuityJson(continuity.value(), *imported_.model);
    }
    for (const auto& [key, value] : notes_.items())
      if (!value.is_null()) report[key] = value;
    if (Json files = result_.files.Json(""); !files.is_null()) report["files"] = std::move(files);
    result_.report = std::move(report);
    if (auto written = WriteReport(result_, directory_); !written) return written.error();
    return std::move(result_);
  }

  // Returns an error that names --timeout if the time limit stopped the run; otherwise returns `error`.
  Error Explained(const Error& error) const {
    if (error.code != ErrorCode::kCancelled || !deadline_.expired()) return error;
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, "%g", timeout_s_);
    return {ErrorCode::kLimitExceeded, imported_.model->info.file + ": rendering took longer than " +
                                           seconds + " s; use --timeout to allow more"};
  }

 private:
  void Progress(double fraction) const {
    if (context_.progress) context_.progress(command_, fraction);
  }

  // Records certificates that the check contradicts. They are a defect of this program, and fail the run.
  void NoteContradictions(const Json& view) {
    const Json& check = view.at("direct").at("check");
    if (check.is_null()) return;
    const auto count = [&](const char* key) { return check.at(key).get<std::uint64_t>(); };
    const std::uint64_t contradicted = count("roots_contradicted") + count("rays_contradicted");
    if (contradicted == 0) return;
    Problem("view '" + view.at("name").get<std::string>() +
            "': an independent check contradicts the certificates of " + std::to_string(contradicted) +
            " samples; this is a defect of Facetless, please report it with the file");
  }

  const ImportedModel& imported_;
  const RunOptions& options_;
  const std::string directory_;
  const RunContext& context_;
  const char* command_;
  const Stopwatch stopwatch_;
  double scene_ms_ = 0;
  Findings findings_;
  RunResult result_;
  Json notes_ = Json::object();
  const double timeout_s_;
  Deadline deadline_;
};

// The candidates of a comparison other than the mesh.
class Candidates {
 public:
  // Makes the representations. The objects that `input` refers to must outlive the result. A method that
  // exceeds its limits is left out, and `run` receives a sentence that says why. Errors: all others.
  static Result<Candidates> Make(const std::vector<MethodChoice>& choices, const MethodInput& input,
                                 Run& run) {
    Candidates candidates;
    for (const MethodChoice& choice : choices) {
      auto made = MakeRepresentation(choice, input);
      if (made) {
        candidates.owned_.push_back(std::move(made).value());
        continue;
      }
      const std::string sentence = "--with " + FormatMethod(choice) + ": " + made.error().message;
      if (made.error().code != ErrorCode::kLimitExceeded) return Error{made.error().code, sentence};
      run.Problem(sentence);
    }
    return candidates;
  }

  // Returns `mesh`, if there is one, followed by the methods.
  std::vector<const Representation*> All(const Representation* mesh) const {
    std::vector<const Representation*> all;
    if (mesh != nullptr) all.push_back(mesh);
    for (const auto& one : owned_) all.push_back(one.get());
    return all;
  }

 private:
  std::vector<std::unique_ptr<const Representation>> owned_;
};

// Writes the files of one view and makes its entry in the report.
class ViewReport {
 public:
  // `baseline` is the tree of the mesh, the first candidate; null if there is no mesh.
  ViewReport(const ImportedModel& imported, const RunOptions& options, const std::string& directory,
             const BaselineScene* baseline)
      : imported_(imported), options_(options), directory_(directory), baseline_(baseline) {}

  // Writes the files, and returns the view's entry. Draws into the pictures of `view`, whose comparison is
  // finished.
  Result<Json> Write(ViewComparison& view, ContactSheet& sheet, RunFiles& left) const {
    const Camera& camera = view.camera;
    if (auto drawn = Finish(view.reference.image, camera, view, sheet, "exact"); !drawn) return drawn.error();
    for (CandidateView& candidate : view.candidates) {
      const bool mesh = IsBaseline(candidate);
      for (const auto& [image, what] :
           {std::pair{&candidate.view.image, mesh ? "mesh" : candidate.title},
            {&candidate.picture.image, mesh ? "difference" : candidate.title + ", difference"}})
        if (auto drawn = Finish(*image, camera, view, sheet, what); !drawn) return drawn.error();
    }
    ViewFiles files(directory_, camera.name);
    files.Png("direct", view.reference.image);
    if (options_.svg) files.Svg("lines", SvgOf(imported_, camera, view.reference));
    files.Depth("depth", view.reference.samples);
    files.Inspection(view.reference.inspection, view.reference.samples);
    files.Aovs(view.reference.samples, options_);
    std::vector<std::optional<PixelData>> pixels(view.candidates.size());
    for (std::size_t i = 0; i < view.candidates.size(); ++i) {
      auto made = AddCandidate(view, view.candidates[i], files);
      if (!made) return made.error();
      pixels[i] = std::move(made).value();
      if (pixels[i]) files.Pixels(*pixels[i], i == 0 ? "" : view.candidates[i].name);
    }
    Json json = ComparisonJson(view, baseline_);
    if (!view.candidates.empty())
      json["pixel_data"] =
          pixels.front() ? Json{{"depth_mm", {pixels.front()->near_mm, pixels.front()->far_mm}}} : Json();
    if (auto written = files.Write(json, options_.threads, left); !written) return written.error();
    NoteInspections(view, json);
    return json;
  }

 private:
  static bool IsBaseline(const CandidateView& candidate) { return candidate.name == "baseline"; }

  // Draws the scale bar and the axes, and adds the picture to the contact sheet.
  Result<void> Finish(Image8& image, const Camera& camera, const ViewComparison& view, ContactSheet& sheet,
                      const std::string& what) const {
    Decorate(image, camera, view.reference.frame, options_.picture);
    return sheet.Add(image, camera, view.candidates.empty() ? camera.name : camera.name + ": " + what);
  }

  // Adds the candidate's files, and its pixel data if the view has any.
  Result<std::optional<PixelData>> AddCandidate(const ViewComparison& view, const CandidateView& candidate,
                                                ViewFiles& files) const {
    const bool baseline = IsBaseline(candidate);
    files.Png(candidate.name, candidate.view.image);
    files.Png(baseline ? "difference" : candidate.name + "-difference", candidate.picture.image);
    files.Depth(candidate.name + "-depth", candidate.view.samples);
    if (candidate.light) files.Png(baseline ? "light" : candidate.name + "-light", candidate.light->picture);
    if (view.reference.samples.size() > kMostPixelData ||
        imported_.model->PlacedFaceCount() > kMostPixelFaces)
      return std::optional<PixelData>();
    auto made = MakePixelData(view.reference.samples, candidate.view.samples, view.reference.frame,
                              candidate.difference.faces_known, candidate.difference.noise_mm);
    if (!made) return made.error();
    return std::optional<PixelData>(std::move(made).value());
  }

  void NoteInspections(const ViewComparison& view, Json& json) const {
    if (!view.reference.inspection) return;
    json["inspection"]["direct"] = InspectionJson(*view.reference.inspection, *imported_.model);
    for (const CandidateView& candidate : view.candidates)
      if (candidate.view.inspection)
        json["inspection"][candidate.name] = InspectionJson(*candidate.view.inspection, *imported_.model);
  }

  const ImportedModel& imported_;
  const RunOptions& options_;
  const std::string& directory_;
  const BaselineScene* baseline_;
};

// Reads the panorama, if there is one.
Result<void> ReadSurroundings(LightOptions& light) {
  if (light.environment.empty()) return {};
  if (light.materials.empty())
    return Error{ErrorCode::kBadUsage,
                 "environment is visible only in mirrors, metals and glasses; give material, too"};
  auto map = ReadRadianceMap(light.environment);
  if (!map) return map.error();
  light.panorama = std::make_shared<const RadianceMap>(std::move(map).value());
  return {};
}

// The mesh that a run shows beside the exact surfaces, or the reason why it has none although it should.
struct RunSubject {
  const char* command;
  const Mesh* mesh = nullptr;       // the mesh of the whole model; null: there is none
  const NoBaseline* why = nullptr;  // null: no mesh is missing
};

// Makes the views of the exact surfaces, alone or compared with a mesh and the methods of --with. A mesh of
// our own that cannot be traced is left out.
Result<RunResult> RunViews(const ImportedModel& whole, const RunSubject& subject, const RunOptions& options,
                           const std::string& directory, const RunContext& context) {
  const auto shown = ShownModel::Of(whole, subject.mesh, options.picture.arrangement);
  if (!shown) return shown.error();
  const ImportedModel& imported = shown.value().imported();
  const Model& model = *imported.model;
  const Mesh* mesh = subject.mesh != nullptr ? &shown.value().mesh() : nullptr;
  const auto without_mesh = [&](const Error& error) {
    const NoBaseline why = NoBaselineFor(error);
    return RunViews(whole, {.command = subject.command, .why = &why}, options, directory, context);
  };
  Run run(imported, options, directory, context, subject.command);
  if (subject.why != nullptr) run.LacksBaseline(*subject.why);
  run.Note("arrangement", shown.value().report());
  const Scene scene = run.MakeScene();
  std::optional<BaselineScene> tree;
  if (mesh != nullptr) {
    auto built =
        BaselineScene::Build(*mesh, run.execution(), !options.sections.empty(), options.accuracy.max_bytes);
    if (!built) {
      const Error error = {built.error().code, model.info.file + ": " + built.error().message};
      if (!mesh->from_model || !CostsTheBaselineOnly(error.code)) return error;
      return without_mesh(error);
    }
    tree.emplace(std::move(built).value());
  }
  const auto sections = run.Sections(scene, mesh);
  if (!sections) return sections.error();

  // The leaves may use the memory that the tree does not.
  const DirectOptions direct = ToDirectOptions(options, sections.value(), tree ? tree->bvh_bytes() : 0);
  const auto made = MakeExactSide(options, scene, direct, run.execution());
  if (!made) return run.Explained(made.error());
  const Representation& exact = *made.value();
  std::optional<Triangles> triangles;
  if (tree) triangles.emplace(*tree, model, sections.value(), direct.accuracy.max_bytes);
  const auto methods = Candidates::Make(options.MethodsBeside(),
                                        {.scene = scene,
                                         .direct = direct,
                                         .execution = run.execution(),
                                         .max_bytes = direct.accuracy.max_bytes,
                                         .solver = options.solver,
                                         .voxels = options.voxel_look()},
                                        run);
  if (!methods) return run.Explained(methods.error());
  const std::vector<const Representation*> candidates =
      methods.value().All(triangles ? &*triangles : nullptr);

  ViewOptions view_options = ToViewOptions(options, sections.value(), run.execution());
  if (auto read = ReadSurroundings(view_options.light); !read) return read.error();
  const ViewReport report(imported, options, run.directory(), tree ? &*tree : nullptr);
  ContactSheet sheet(options.picture.sheet,
                     candidates.empty() ? 0 : 1 + 2 * static_cast<int>(candidates.size()));
  MeshCheck check(model.Diagonal());
  std::vector<ViewValues> values;
  auto views = run.ForEachView([&](const Camera& camera) -> Result<Json> {
    auto compared = CompareView(exact, candidates, model, camera, view_options);
    if (!compared) return compared.error();
    if (triangles) {
      const Difference& d = compared.value().candidates.front().difference;
      check.Add(d);
      values.push_back({camera.name, d.deviation_mm.max, d.depth_mm.max, d.silhouette.max_distance_px,
                        d.color.flip_mean, d.color.share_over_threshold});
    }
    run.NoteExact(camera.name, compared.value().reference);
    return report.Write(compared.value(), sheet, run.files());
  });
  if (!views) {
    const Error& error = views.error();
    if (!tree || !mesh->from_model || error.code != ErrorCode::kLimitExceeded || run.execution().cancelled())
      return error;
    return without_mesh(BesideTree(imported, *tree, error));
  }
  if (auto written = sheet.Write(run.directory(), run.files()); !written) return written.error();
  if (auto turned = run.Turntable(exact, view_options); !turned) return turned.error();
  if (mesh != nullptr)
    if (auto judged = run.JudgeMesh(*mesh, check); !judged) return judged.error();
  return run.Finish(std::move(views).value(), values);
}

}  // namespace

Result<ImportedModel> Import(const ImportRequest& request) {
  auto files = RunImporter(request);
  if (!files) return files.error();
  ImportedModel imported;
  imported.import_ms = files.value().wall_ms;
  imported.import_peak_bytes = files.value().peak_bytes;
  imported.import_peak_address_bytes = files.value().peak_address_bytes;
  const Stopwatch stopwatch;
  auto model = ReadModel(files.value().model_path);
  if (!model) return model.error();
  imported.model = std::make_unique<const Model>(std::move(model).value());
  for (const std::string& path : files.value().mesh_paths) {
    auto mesh = LoadMesh(path, {}, imported.model.get());
    if (!mesh) return mesh.error();
    imported.meshes.push_back(std::move(mesh).value());
  }
  imported.load_ms = stopwatch.Milliseconds();
  return imported;
}

NoBaseline NoBaselineFor(const MeshFailure& failure) {
  return {failure.reason, failure.error.message +
                              "; the exact pictures are written without a baseline, and a render (facetless "
                              "render, POST /v1/renders) needs no mesh"};
}

NoBaseline NoBaselineFor(const Error& unusable) {
  return NoBaselineFor(
      MeshFailure{unusable.code == ErrorCode::kLimitExceeded ? "memory" : "unusable", unusable});
}

Result<Mesh> LoadOwnMesh(const std::string& path, const Model& model) {
  auto mesh = LoadMesh(path, {}, &model);
  if (mesh) return mesh;
  if (mesh.error().code == ErrorCode::kNothingUsable)
    return Error{mesh.error().code, model.info.file +
                                        ": the mesher made no triangle of any face; a finer "
                                        "--deflection may make some"};
  return Error{mesh.error().code, model.info.file + ": " + mesh.error().message};
}

bool CostsTheBaselineOnly(ErrorCode code) {
  return code == ErrorCode::kNothingUsable || code == ErrorCode::kLimitExceeded;
}

NoBaseline PendingBaseline(const std::string& file) {
  return {"pending", file + ": the mesher still works; this report has the exact half alone until it ends"};
}

Json ImportedModelJson(const ImportedModel& imported) {
  Json json = ModelJson(*imported.model);
  json["import_ms"] = imported.import_ms;
  if (imported.import_peak_bytes > 0) json["import_peak_bytes"] = imported.import_peak_bytes;
  return json;
}

bool KnowsUnit(const Model& model) {
  return !model.info.unit.empty();
}

std::size_t LossCount(const Model& model) {
  return model.info.faces_lost.size() + model.info.loops_lost.size() + model.info.edges_lost.size();
}

Result<void> WriteReport(RunResult& result, const std::string& directory) {
  constexpr const char *kReport = "report.json", *kPage = "report.html";
  if (auto written = WriteFileAtomically(directory + "/" + kReport, JsonText(result.report) + "\n"); !written)
    return written.error();
  auto html = ReportHtml(result.report, directory);
  if (!html) return html.error();
  result.files.Add("", "report", kReport);
  result.files.Add("", "page", kPage);
  return WriteFileAtomically(directory + "/" + kPage, html.value());
}

Result<RunResult> RunRender(const ImportedModel& whole, const RunOptions& options,
                            const std::string& directory, const RunContext& context) {
  return RunViews(whole, {.command = "render"}, options, directory, context);
}

Result<RunResult> RunWithoutBaseline(const ImportedModel& whole, const NoBaseline& why,
                                     const RunOptions& options, const std::string& directory,
                                     const RunContext& context) {
  return RunViews(whole, {.command = "compare", .why = &why}, options, directory, context);
}

Result<RunResult> RunCompare(const ImportedModel& whole, const Mesh& mesh, const RunOptions& options,
                             const std::string& directory, const RunContext& context) {
  return RunViews(whole, {.command = "compare", .mesh = &mesh}, options, directory, context);
}

Result<RunResult> WithReason(RunResult result, const NoBaseline& why, const std::string& directory) {
  for (std::string& problem : result.verdict.problems)
    if (problem == result.no_baseline->message) problem = why.message;
  result.no_baseline = why;
  result.report["no_baseline"] = NoBaselineJson(why);
  result.report["verdict"] = VerdictJson(result.verdict);
  if (auto written = WriteReport(result, directory); !written) return written.error();
  return result;
}

}  // namespace facetless
