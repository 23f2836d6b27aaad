#include "server/run/run.h"

#include <cmath>
#include <utility>

#include "render/base/stopwatch.h"
#include "render/baseline/mesh_file.h"
#include "render/baseline/tracer.h"
#include "render/compare/compare_view.h"
#include "render/compare/mesh_deviation.h"
#include "render/compare/pixel_data.h"
#include "render/compare/report.h"
#include "render/compare/section_report.h"
#include "render/inspect/report.h"
#include "render/lines/draw_lines.h"
#include "render/model/model_file.h"
#include "server/base/files.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"
#include "server/options/shade_option.h"
#include "server/run/pictures.h"
#include "server/run/report_html.h"
#include "server/run/shown_model.h"
#include "server/run/verdict.h"
#include "server/run/view_files.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

ViewOptions ToViewOptions(const RunOptions& options, const std::vector<SectionPlane>& sections,
                          const std::atomic<bool>* cancel) {
  ViewOptions view;
  view.sections = sections;
  view.samples = options.samples;
  view.precision = options.precision;
  view.max_bytes = options.max_view_bytes;
  view.check = options.check;
  view.edges = options.edges;
  view.lines = options.lines;
  view.find_lines = options.svg;
  view.background = options.background;
  view.inspection = options.inspection;
  view.inspection.orient = options.orient;
  view.coloring = options.picture.coloring;
  view.newton_tolerance = options.newton_tolerance;
  view.uv = options.WantsAov("uv");
  view.depth_error = options.WantsAov("certificate");
  view.audit = options.audit;
  view.execution = {options.threads, cancel};
  return view;
}

std::string SvgOf(const ImportedModel& imported, const Camera& camera, const DirectView& view) {
  const bool flat = camera.projection == Projection::kOrthographic;
  return LinesSvg(view.lines, camera.width_px, camera.height_px, flat ? view.frame.pixel_x : 0,
                  imported.model->info.file + ", " + camera.name);
}

// Measures every triangle, and writes the file of it: the report's "mesh_deviation".
Result<Json> WriteMeshDeviation(const Model& model, const Mesh& mesh, const std::string& directory,
                                const std::atomic<bool>* cancel) {
  const auto measured = MeasureMeshDeviation(model, mesh, cancel);
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

// A view that finds no memory beside the tree may well find it without.
Error BesideTree(const ImportedModel& imported, const BaselineScene& tree, const Error& error) {
  char text[100];
  std::snprintf(text, sizeof text, ": beside the mesh's search tree of %.4g MB, ",
                static_cast<double>(tree.bvh_bytes()) / (1 << 20));
  return {error.code, imported.model->info.file + text + error.message};
}

Json NoBaselineJson(const NoBaseline& why) {
  return {{"reason", why.reason}, {"message", why.message}};
}

// Whether there is a view, and the exact picture of each is empty.
bool ShowsNothing(const Json& views) {
  for (const Json& view : views)
    if (view.at("direct").at("hits").get<std::uint64_t>() > 0) return false;
  return !views.empty();
}

// What says that a mesh has nothing to do with the model, or is turned inside out: of all views together.
class MeshCheck {
 public:
  explicit MeshCheck(double diagonal_mm) : diagonal_mm_(diagonal_mm) {}

  void Add(const Difference& difference) {
    direct_ += difference.direct_hits;
    baseline_ += difference.baseline_hits;
    both_ += difference.both_hit;
    oriented_ += difference.oriented_pixels;
    opposite_ += difference.opposite_pixels;
    nearest_mm_ =
        difference.depth_mm.count > 0 ? std::min(nearest_mm_, difference.depth_mm.p50) : nearest_mm_;
  }
  // Sentences, none where nothing is wrong.
  std::vector<std::string> Problems() const {
    std::vector<std::string> problems;
    const std::uint64_t any = direct_ + baseline_ - both_;
    if (direct_ > 0 && baseline_ > 0 &&
        static_cast<double>(both_) < kLeastShared * static_cast<double>(any)) {
      problems.push_back("the mesh has hardly anything in common with the model: of " + std::to_string(any) +
                         " pixels that show at least one of the two, " + std::to_string(both_) +
                         " show both");
    } else if (direct_ > 0 && baseline_ == 0) {
      problems.push_back("the mesh is not visible: none of the " + std::to_string(direct_) +
                         " pixels that show the model shows it");
    } else if (both_ > 0 && nearest_mm_ > kMostApart * diagonal_mm_) {
      char text[160];
      std::snprintf(text, sizeof text,
                    "the mesh has hardly anything in common with the model: in every view half of the depths "
                    "differ by more than %.3g mm, and the model is %.3g mm large",
                    nearest_mm_, diagonal_mm_);
      problems.push_back(text);
    }
    if (oriented_ > 0 && static_cast<double>(opposite_) > kMostOpposite * static_cast<double>(oriented_))
      problems.push_back("the mesh is turned inside out: " + std::to_string(opposite_) + " of " +
                         std::to_string(oriented_) +
                         " pixels show its inside where the model shows its outside");
    return problems;
  }

 private:
  // A coarse mesh shares nine tenths of its pixels with the model, a part of an assembly rarely less than a
  // tenth.
  static constexpr double kLeastShared = 0.05;
  // Shares of the model's size, and of the pixels.
  static constexpr double kMostApart = 0.1, kMostOpposite = 0.9;

  const double diagonal_mm_;
  std::uint64_t direct_ = 0, baseline_ = 0, both_ = 0, oriented_ = 0, opposite_ = 0;
  double nearest_mm_ = INFINITY;
};

// What both kinds of run share: cameras, the clock, the report's envelope and its files.
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
        deadline_(timeout_s_, context.cancel) {}

  const std::atomic<bool>* cancel() const { return deadline_.flag(); }
  // What does not depend on the view.
  Scene MakeScene() {
    const Stopwatch stopwatch;
    Scene scene(*imported_.model);
    scene_ms_ = stopwatch.Milliseconds();
    return scene;
  }
  const std::string& directory() const { return directory_; }
  // Says under `key` of the report what is not of one view; null says nothing.
  void Note(const std::string& key, Json value) {
    if (!value.is_null()) notes_[key] = std::move(value);
  }
  // The report's "files": what is not of one view.
  Json& files() { return notes_["files"]; }

  // All frames around the first view.
  Result<void> Turntable(const Scene& scene, const ViewOptions& view) {
    if (options_.picture.turntable == 0) return {};
    const auto progress = [this](double fraction) {
      if (context_.progress) context_.progress("turntable", fraction);
    };
    auto turntable = RenderTurntable({scene, options_, view, directory_, progress}, files());
    if (!turntable) return Explained(turntable.error());
    Note("turntable", std::move(turntable).value());
    return {};
  }

  // Resolves the section planes and measures their cuts, through the mesh too where there is one.
  Result<std::vector<SectionPlane>> Sections(const Scene& scene, const Mesh* mesh) {
    auto planes = ResolveSections(options_.sections, imported_.model->bounds);
    if (!planes || planes.value().empty()) return planes;
    SectionAreaOptions area;
    area.execution = {options_.threads, cancel()};
    auto measured = SectionsJson(scene, mesh, planes.value(), area);
    if (!measured) return Explained(measured.error());
    Note("sections", std::move(measured).value());
    return planes;
  }

  // Calls `one` for each camera; it returns the view's entry of the report.
  template <typename One>
  Result<Json> ForEachView(One one) {
    if (auto made = MakeDirectories(directory_); !made) return made.error();
    auto cameras = ResolveCameras(options_, imported_.model->bounds);
    if (!cameras) return cameras.error();
    Json views = Json::array();
    for (const Camera& camera : cameras.value()) {
      Progress(static_cast<double>(views.size()) / static_cast<double>(cameras.value().size()));
      Result<Json> view = *cancel() ? Result<Json>(Error{ErrorCode::kCancelled, "stopped"}) : one(camera);
      if (!view) return Explained(view.error());
      views.push_back(std::move(view).value());
    }
    Progress(1);
    return views;
  }

  // Says a sentence that fails the run, once.
  void Problem(const std::string& sentence) { findings_.problems.push_back(sentence); }
  void LacksBaseline(const NoBaseline& why) {
    findings_.no_baseline = why.message;
    Note("no_baseline", NoBaselineJson(why));
  }
  void Unmeshed(std::size_t faces) { findings_.unmeshed = faces; }

  // What this run took. An import that was made for an earlier one took no time of it, and stands apart.
  Json TimingJson() const {
    const double import_ms = imported_.import_kept ? 0 : imported_.import_ms;
    Json timing = {{"import", import_ms},
                   {"load", imported_.load_ms},
                   {"scene", scene_ms_},
                   {"total", import_ms + imported_.load_ms + stopwatch_.Milliseconds()}};
    if (imported_.import_kept) timing["import_kept"] = imported_.import_ms;
    return timing;
  }

  // Completes the report and writes it.
  Result<Json> Finish(Json views, const std::vector<ViewValues>& values) {
    if (!options_.sections.empty() && ShowsNothing(views))
      Problem("no view shows anything: the section planes remove all of the model that the views look at");
    for (const Json& view : views) NoteContradictions(view);
    findings_.lost = LossCount(*imported_.model);
    findings_.unit_known = KnowsUnit(*imported_.model);
    Json report = {{"facetless", ProgramJson(options_.threads)},
                   {"command", command_},
                   {"options",
                    {{"samples", options_.samples},
                     {"precision", PrecisionName(options_.precision)},
                     {"shade", FormatInspection(options_.inspection)},
                     {"orient", options_.orient == Orient::kViewer ? "viewer" : "file"},
                     {"edges", options_.edges},
                     {"audit", options_.audit}}},
                   {"model", ImportedModelJson(imported_)},
                   {"views", std::move(views)},
                   {"timing_ms", TimingJson()},
                   {"verdict", VerdictJson(options_, values, findings_)}};
    if (ShowsSmoothness(options_.inspection.kind))
      report["continuity"] =
          ContinuityJson(MeasureContinuity(*imported_.model, options_.threads), *imported_.model);
    for (const auto& [key, value] : notes_.items())
      if (!value.is_null()) report[key] = value;
    if (auto written = WriteReport(report, directory_); !written) return written.error();
    return report;
  }

  // A stop that the clock caused names the option that allows more.
  Error Explained(const Error& error) const {
    if (error.code != ErrorCode::kCancelled || !deadline_.expired()) return error;
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, "%g", timeout_s_);
    return {ErrorCode::kLimitExceeded, imported_.model->info.file + ": rendering took longer than " +
                                           seconds + " s; --timeout allows more"};
  }

 private:
  void Progress(double fraction) const {
    if (context_.progress) context_.progress(command_, fraction);
  }

  // A certificate that does not hold is a defect of this program, and fails the run.
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
  Json notes_ = Json::object();
  const double timeout_s_;
  Deadline deadline_;
};

// Pictures, depths and lines of the exact surfaces alone: a render, or a comparison that has nothing to
// compare with.
Result<Json> RunExact(const ImportedModel& whole, const NoBaseline* why, const RunOptions& options,
                      const std::string& directory, const RunContext& context) {
  const auto shown = ShownModel::Of(whole, nullptr, options.picture.arrangement);
  if (!shown) return shown.error();
  const ImportedModel& imported = shown.value().imported();
  Run run(imported, options, directory, context, why == nullptr ? "render" : "compare");
  if (why != nullptr) run.LacksBaseline(*why);
  run.Note("arrangement", shown.value().report());
  const Scene scene = run.MakeScene();
  const auto sections = run.Sections(scene, nullptr);
  if (!sections) return sections.error();
  ContactSheet sheet(options.picture.sheet, 0);
  auto views = run.ForEachView([&](const Camera& camera) -> Result<Json> {
    auto view = RenderView(scene, camera, ToViewOptions(options, sections.value(), run.cancel()));
    if (!view) return view.error();
    Decorate(view.value().image, camera, view.value().frame, options.picture);
    if (auto added = sheet.Add(view.value().image, camera, camera.name); !added) return added.error();
    ViewFiles files(run.directory(), camera.name);
    files.Png("direct", view.value().image);
    if (options.svg) files.Svg("lines", SvgOf(imported, camera, view.value()));
    files.Depth("depth", view.value().samples);
    files.Inspection(view.value().inspection, view.value().samples);
    files.Aovs(view.value().samples, options);
    Json json = RenderJson(camera, view.value());
    if (auto written = files.Write(json, options.threads); !written) return written.error();
    if (view.value().inspection)
      json["inspection"] = {{"direct", InspectionJson(*view.value().inspection, *imported.model)}};
    return json;
  });
  if (!views) return views.error();
  if (auto written = sheet.Write(run.directory(), run.files()); !written) return written.error();
  if (auto turned = run.Turntable(scene, ToViewOptions(options, sections.value(), run.cancel())); !turned)
    return turned.error();
  return run.Finish(std::move(views).value(), {});
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

Result<void> WriteReport(const Json& report, const std::string& directory) {
  if (auto written = WriteFileAtomically(directory + "/report.json", JsonText(report) + "\n"); !written)
    return written.error();
  auto html = ReportHtml(report, directory);
  if (!html) return html.error();
  return WriteFileAtomically(directory + "/report.html", html.value());
}

Result<Json> RunRender(const ImportedModel& whole, const RunOptions& options, const std::string& directory,
                       const RunContext& context) {
  return RunExact(whole, nullptr, options, directory, context);
}

Result<Json> RunWithoutBaseline(const ImportedModel& whole, const NoBaseline& why, const RunOptions& options,
                                const std::string& directory, const RunContext& context) {
  return RunExact(whole, &why, options, directory, context);
}

Result<Json> WithReason(Json report, const NoBaseline& why, const std::string& directory) {
  const Json before = report.at("no_baseline").at("message");
  report["no_baseline"] = NoBaselineJson(why);
  for (Json& problem : report.at("verdict").at("problems"))
    if (problem == before) problem = why.message;
  if (auto written = WriteReport(report, directory); !written) return written.error();
  return report;
}

Result<Json> RunCompare(const ImportedModel& whole, const Mesh& whole_mesh, const RunOptions& options,
                        const std::string& directory, const RunContext& context) {
  const auto shown = ShownModel::Of(whole, &whole_mesh, options.picture.arrangement);
  if (!shown) return shown.error();
  const ImportedModel& imported = shown.value().imported();
  const Mesh& mesh = shown.value().mesh();
  Run run(imported, options, directory, context, "compare");
  run.Note("arrangement", shown.value().report());
  const Scene scene = run.MakeScene();
  const auto baseline =
      BaselineScene::Build(mesh, options.threads, !options.sections.empty(), options.max_view_bytes);
  if (!baseline) {
    const Error error = {baseline.error().code, imported.model->info.file + ": " + baseline.error().message};
    if (!whole_mesh.from_model || !CostsTheBaselineOnly(error.code)) return error;
    return RunWithoutBaseline(whole, NoBaselineFor(error), options, directory, context);
  }
  const auto sections = run.Sections(scene, &mesh);
  if (!sections) return sections.error();
  MeshCheck check(imported.model->Diagonal());
  ContactSheet sheet(options.picture.sheet, 3);
  std::vector<ViewValues> values;
  auto views = run.ForEachView([&](const Camera& camera) -> Result<Json> {
    // The leaves have what the tree leaves of the memory.
    ViewOptions view_options = ToViewOptions(options, sections.value(), run.cancel());
    view_options.max_bytes -= std::min(view_options.max_bytes, baseline.value().bvh_bytes());
    auto compared = CompareView(scene, baseline.value(), camera, view_options);
    if (!compared) return compared.error();
    ViewComparison& view = compared.value();
    // The pictures are compared: now they may be drawn into.
    for (const auto& [image, what] : {std::pair{&view.direct.image, "exact"},
                                      {&view.baseline.image, "mesh"},
                                      {&view.picture.image, "difference"}}) {
      Decorate(*image, camera, view.direct.frame, options.picture);
      if (auto added = sheet.Add(*image, camera, camera.name + ": " + what); !added) return added.error();
    }
    ViewFiles files(run.directory(), camera.name);
    files.Png("direct", view.direct.image);
    files.Png("baseline", view.baseline.image);
    files.Png("difference", view.picture.image);
    if (options.svg) files.Svg("lines", SvgOf(imported, camera, view.direct));
    files.Depth("depth", view.direct.samples);
    files.Depth("baseline-depth", view.baseline.samples);
    files.Inspection(view.direct.inspection, view.direct.samples);
    files.Aovs(view.direct.samples, options);
    std::optional<PixelData> pixels;
    if (view.direct.samples.size() <= kMostPixelData &&
        imported.model->PlacedFaceCount() <= kMostPixelFaces) {
      auto made = MakePixelData(view.direct.samples, view.baseline.samples, view.direct.frame,
                                mesh.from_model, view.difference.noise_mm);
      if (!made) return made.error();
      pixels = std::move(made).value();
      files.Pixels(*pixels);
    }
    const Difference& d = view.difference;
    check.Add(d);
    values.push_back({camera.name, d.deviation_mm.max, d.depth_mm.max, d.silhouette.max_distance_px,
                      d.color.flip_mean, d.color.share_over_threshold});
    Json json = ComparisonJson(view, baseline.value());
    json["pixel_data"] = pixels ? Json{{"depth_mm", {pixels->near_mm, pixels->far_mm}}} : Json(nullptr);
    if (auto written = files.Write(json, options.threads); !written) return written.error();
    if (view.direct.inspection && view.baseline.inspection)
      json["inspection"] = {{"direct", InspectionJson(*view.direct.inspection, *imported.model)},
                            {"baseline", InspectionJson(*view.baseline.inspection, *imported.model)}};
    return json;
  });
  if (!views) {
    const Error& error = views.error();
    if (!whole_mesh.from_model || error.code != ErrorCode::kLimitExceeded || *run.cancel()) return error;
    return RunWithoutBaseline(whole, NoBaselineFor(BesideTree(imported, baseline.value(), error)), options,
                              directory, context);
  }
  if (auto written = sheet.Write(run.directory(), run.files()); !written) return written.error();
  if (options.mesh_deviation) {
    auto measured = WriteMeshDeviation(*imported.model, mesh, directory, run.cancel());
    if (!measured) return run.Explained(measured.error());
    run.Note("mesh_deviation", std::move(measured).value());
    run.files()["mesh"] = "mesh.bin";
  }
  // With sections an empty picture is the planes' doing.
  for (const std::string& problem : check.Problems()) run.Problem(problem);
  if (const std::size_t turned = TrianglesAgainstNormals(mesh); turned > 0)
    run.Problem("the mesh is turned inside out: " + std::to_string(turned) +
                " of its triangles run against the normals at their corners");
  run.Unmeshed(mesh.faces_unmeshed.size());
  return run.Finish(std::move(views).value(), values);
}

}  // namespace facetless
