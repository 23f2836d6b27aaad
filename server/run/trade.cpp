#include "server/run/trade.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "render/baseline/mesh_file.h"
#include "render/compare/report.h"
#include "render/image/io.h"
#include "render/trade/quantity_text.h"
#include "render/trade/trade_measure.h"
#include "render/trade/trade_report.h"
#include "server/base/files.h"
#include "server/base/interrupt.h"
#include "server/base/load_average.h"
#include "server/base/version.h"
#include "server/run/shown_model.h"
#include "server/run/trace_options.h"
#include "server/run/verdict.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMegabyte = 1024 * 1024;

// Half a pixel: an image cannot show smaller errors.
constexpr double kDefaultLimitPx = 0.5;

std::string Seconds(double seconds) {
  return NumberText(seconds) + " s (--budget-seconds)";
}

// One tessellation, from the importer to a tree that can be traced.
struct Tessellation {
  std::unique_ptr<const Mesh> mesh;  // must not move, because the tree points to it
  std::optional<BaselineScene> tree;
  double mesh_ms = 0, build_ms = 0;
  int repetitions = 1;
  std::uint64_t mesher_peak_bytes = 0;
  // The reason if a budget was exceeded, else empty.
  std::string over_budget;
};

class Sweep {
 public:
  // `whole` is the import; `shown` is the part of it that is measured.
  Sweep(const ImportRequest& request, const ImportedModel& whole, const ShownModel& shown,
        const RunOptions& options, const std::string& directory, const RunContext& context)
      : request_(request),
        whole_(whole),
        imported_(shown.imported()),
        arrangement_(shown.report()),
        options_(options),
        directory_(directory),
        context_(context),
        timeout_s_(options.timeout_s.value_or(kTradeTimeoutS)),
        deadline_(timeout_s_, context.execution.cancel) {}

  Result<TradeResult> Run() {
    auto done = Measure();
    if (!done) return Explained(done.error());
    return Report();
  }

 private:
  const Model& model() const { return *imported_.model; }
  const TradeOptions& trade() const { return options_.trade; }

  Execution execution() const { return context_.execution.WithFlag(deadline_.flag()); }

  TradeViewOptions ViewOptionsOf(const std::atomic<bool>* budget) const { return {execution(), budget}; }

  void Step(const std::string& what) {
    if (context_.progress) context_.progress(what, static_cast<double>(steps_done_) / std::max(steps_, 1));
    ++steps_done_;
  }

  // The methods of --with, --voxels, --methods and --method, each once.
  std::vector<MethodChoice> MethodChoices() const {
    std::vector<MethodChoice> choices = options_.MethodsBeside();
    const auto add = [&](const MethodChoice& choice) {
      const bool listed = std::any_of(choices.begin(), choices.end(), [&](const MethodChoice& other) {
        return other.method == choice.method && other.given == choice.given &&
               other.setting == choice.setting;
      });
      if (!listed) choices.push_back(choice);
    };
    for (const MethodChoice& choice : trade().methods) add(choice);
    if (options_.method.method != &CertifiedMethod()) add(options_.method);
    return choices;
  }

  Result<void> Measure() {
    if (auto made = MakeDirectories(directory_); !made) return made.error();
    load_at_start_ = LoadAverage();
    auto cameras = ResolveCameras(options_, model().bounds);
    if (!cameras) return cameras.error();
    const std::vector<DirectSetting> direct = DirectSettings(trade().tolerances);
    const std::vector<MeshSetting> meshes = MeshSettings(trade().deflections, trade().angles_deg);
    const std::vector<MethodChoice> methods = MethodSettings(MethodChoices());
    steps_ = static_cast<int>(cameras.value().size() * (1 + direct.size()) + meshes.size() + methods.size());

    // Make the scene, which all views share, and the references.
    const Scene scene(model());
    scene_ms_ = MedianMs([&] { const Scene again(model()); });
    for (const Camera& camera : cameras.value()) {
      Step("reference");
      auto reference = MeasureReference(scene, camera, ViewOptionsOf(nullptr));
      if (!reference) return reference.error();
      TradeView view;
      view.context = {camera.name, trade().measure, reference.value().floor_mm,
                      reference.value().mm_per_pixel};
      view.reference = std::move(reference).value();
      views_.push_back(std::move(view));
    }
    // Measure the points.
    for (TradeView& view : views_)
      for (const DirectSetting& setting : direct)
        if (auto measured = MeasureDirectPoint(scene, setting, view); !measured) return measured;
    for (const MeshSetting& setting : meshes)
      if (auto measured = MeasureMeshPoints(setting); !measured) return measured;
    for (const MethodChoice& choice : methods)
      if (auto measured = MeasureMethodPoints(scene, choice); !measured) return measured;
    return {};
  }

  // Measures one point of one view. Its `skipped` says which budget was exceeded, if any. `timed` is limited
  // to the budget's memory, `picture` is not. An error ends the run.
  Result<TradePoint> MeasureWithin(const Representation& timed, const Representation& picture,
                                   const TradeSetting& setting, const TradeView& view) {
    const Deadline budget(trade().budget_s, deadline_.flag());
    auto point = MeasurePoint(timed, picture, model(), view.reference, setting, ViewOptionsOf(budget.flag()));
    if (point || Stopped(point.error(), budget)) return point;
    return Skipped(
        setting, budget.expired() ? "a view takes longer than " + Seconds(trade().budget_s) : MemoryReason());
  }

  static TradePoint Skipped(const TradeSetting& setting, const std::string& reason) {
    TradePoint point;
    point.setting = setting;
    point.skipped = reason;
    return point;
  }

  Result<void> MeasureDirectPoint(const Scene& scene, const DirectSetting& setting, TradeView& view) {
    Step("direct");
    DirectOptions options;
    options.accuracy = setting;
    const ExactSurfaces picture(scene, options);
    options.accuracy.max_bytes = trade().budget_mb * kMegabyte;
    auto point = MeasureWithin(ExactSurfaces(scene, options), picture, setting, view);
    if (!point) return point.error();
    point.value().convert_ms = model().info.convert_ms;
    point.value().scene_ms = scene_ms_;
    CompleteCosts(point.value());
    view.points.push_back(std::move(point).value());
    return {};
  }

  // Makes one mesh, and measures every view with it.
  Result<void> MeasureMeshPoints(const MeshSetting& setting) {
    Step("meshes");
    std::string reason = RefusedBefore(setting);
    Tessellation tessellation;
    std::optional<Triangles> triangles;
    if (reason.empty()) {
      auto made = Tessellate(setting);
      if (!made) return made.error();
      tessellation = std::move(made).value();
      reason = tessellation.over_budget;
      if (!reason.empty()) over_budget_.push_back(setting);
    }
    if (reason.empty())
      triangles.emplace(*tessellation.tree, model(), std::span<const SectionPlane>(),
                        trade().budget_mb * kMegabyte);
    for (TradeView& view : views_) {
      auto point = triangles ? MeasureWithin(*triangles, *triangles, setting, view)
                             : Result<TradePoint>(Skipped(setting, reason));
      if (!point) return point.error();
      if (triangles) StoreMeshCosts(tessellation, point.value());
      view.points.push_back(std::move(point).value());
    }
    return {};
  }

  static void StoreMeshCosts(const Tessellation& tessellation, TradePoint& point) {
    point.triangles = tessellation.tree->triangles();
    point.mesh_ms = tessellation.mesh_ms;
    point.build_ms = tessellation.build_ms;
    point.mesh_repetitions = tessellation.repetitions;
    point.mesher_peak_bytes = tessellation.mesher_peak_bytes;
    point.deflection_mm = tessellation.mesh->deflection_mm;
    CompleteCosts(point);
  }

  // Makes the representation once, and measures every view with it.
  Result<void> MeasureMethodPoints(const Scene& scene, const MethodChoice& choice) {
    Step("methods");
    const Deadline budget(trade().budget_s, deadline_.flag());
    const DirectOptions direct;
    const auto made = MakeRepresentation(choice, {.scene = scene,
                                                  .direct = direct,
                                                  .execution = execution().WithFlag(budget.flag()),
                                                  .max_bytes = trade().budget_mb * kMegabyte,
                                                  .solver = options_.solver,
                                                  .voxels = options_.voxel_look()});
    const auto cannot = [](const Error& error) { return error.code == ErrorCode::kBadUsage; };
    if (!made && !cannot(made.error()) && Stopped(made.error(), budget)) return made.error();
    const std::string reason = made                   ? ""
                               : cannot(made.error()) ? made.error().message
                               : budget.expired() ? "making it takes longer than " + Seconds(trade().budget_s)
                                                  : MemoryReason();
    for (TradeView& view : views_) {
      auto point = made ? MeasureWithin(*made.value(), *made.value(), choice, view)
                        : Result<TradePoint>(Skipped(choice, reason));
      // A method may not take the surfaces of this model.
      if (!point && cannot(point.error())) point = Skipped(choice, point.error().message);
      if (!point) return point.error();
      point.value().make_ms = made ? made.value()->make_ms() : 0;
      point.value().convert_ms = model().info.convert_ms;
      point.value().scene_ms = scene_ms_;
      CompleteCosts(point.value());
      view.points.push_back(std::move(point).value());
    }
    return {};
  }

  // Returns the reason why a setting need not be tried; empty if it must be.
  std::string RefusedBefore(const MeshSetting& setting) const {
    for (const MeshSetting& refused : over_budget_)
      if (Refines(setting, refused))
        return "not tried, since " + SettingName(refused) + " exceeded its budget";
    return "";
  }

  // Runs the importer for one deflection, and builds the tree.
  Result<Tessellation> Tessellate(const MeshSetting& setting) {
    // If meshing was quick last time, several meshes of one import give a median. From one setting to the
    // next the time grows by far less than a factor of 600.
    constexpr double kQuickMeshMs = 100;
    constexpr int kMeshRepetitions = 3;
    const int repetitions = last_mesh_ms_ < kQuickMeshMs ? kMeshRepetitions : 1;
    ImportRequest request = request_;
    request.meshes.assign(
        static_cast<std::size_t>(repetitions),
        {.deflection = setting.deflection, .deflection_mm = 0, .angular_deg = setting.angular_deg});
    // The budget applies to meshing alone: neither method is charged for reading the file.
    request.execution = execution();
    request.progress = nullptr;
    request.limits.mesh_timeout_s = trade().budget_s * repetitions;
    request.model_suffices = true;
    // The memory limit is what reading the file took plus the budget, but never more than --import-memory.
    const std::uint64_t reading_mb = imported_.import_peak_address_bytes / kMegabyte;
    if (reading_mb > 0)
      request.limits.memory_mb = std::min(request.limits.memory_mb, reading_mb + trade().budget_mb);

    Tessellation tessellation;
    auto files = RunImporter(request);
    if (!files) {
      if (*deadline_.flag()) return files.error();
      tessellation.over_budget = files.error().message;
      return tessellation;
    }
    if (const auto& failure = files.value().mesh_failure) {
      tessellation.over_budget = failure->reason == "timeout"
                                     ? "meshing takes longer than " + Seconds(trade().budget_s)
                                 : failure->reason == "memory" ? MemoryReason()
                                                               : failure->error.message;
      return tessellation;
    }
    StoreMesherCosts(files.value().summary, tessellation);
    last_mesh_ms_ = tessellation.mesh_ms;
    tessellation.repetitions = repetitions;

    // Read the mesh and build the tree.
    auto mesh = LoadMesh(files.value().mesh_paths.front(),
                         {.max_memory_bytes = trade().budget_mb * kMegabyte}, whole_.model.get());
    if (!mesh) return Refused(mesh.error(), std::move(tessellation));
    auto shown = Shown(std::move(mesh).value());
    if (!shown) return shown.error();
    tessellation.mesh = std::make_unique<const Mesh>(std::move(shown).value());
    return BuildTree(std::move(tessellation));
  }

  // Returns the part of a mesh of the whole model that is shown.
  Result<Mesh> Shown(Mesh mesh) const {
    const auto shown = ShownModel::Of(whole_, &mesh, options_.picture.arrangement);
    if (!shown) return shown.error();
    if (shown.value().report().is_null()) return mesh;
    return shown.value().mesh();
  }

  // Requires a mesh.
  static void StoreMesherCosts(const ImportSummary& summary, Tessellation& tessellation) {
    std::vector<double> times;
    for (const MesherReport& mesh : summary.meshes) {
      times.push_back(mesh.mesh_ms);
      // Later meshes reuse memory of the first one, so the largest peak is that of the first.
      tessellation.mesher_peak_bytes = std::max(tessellation.mesher_peak_bytes, mesh.peak_bytes);
    }
    std::sort(times.begin(), times.end());
    tessellation.mesh_ms = times[times.size() / 2];
  }

  Result<Tessellation> BuildTree(Tessellation tessellation) {
    auto tree = BaselineScene::Build(*tessellation.mesh, execution(), false, trade().budget_mb * kMegabyte);
    if (!tree) return Refused(tree.error(), std::move(tessellation));
    if (tree.value().build_ms() > 1000 * trade().budget_s)
      tessellation.over_budget = "building the tree takes longer than " + Seconds(trade().budget_s);
    else if (tree.value().mesh_bytes() + tree.value().bvh_peak_bytes() > trade().budget_mb * kMegabyte)
      tessellation.over_budget = MemoryReason();
    std::vector<double> times = {tree.value().build_ms()};
    while (times.front() < kCheapMs && times.size() < kRepetitions) {
      auto again = BaselineScene::Build(*tessellation.mesh, execution());
      if (!again) return again.error();
      times.push_back(again.value().build_ms());
    }
    std::sort(times.begin(), times.end());
    tessellation.build_ms = times[times.size() / 2];
    tessellation.tree.emplace(std::move(tree).value());
    return tessellation;
  }

  // Handles an error after meshing: a mesh that is too large or empty exceeds the budget, other errors are
  // returned.
  Result<Tessellation> Refused(const Error& error, Tessellation tessellation) const {
    if (error.code != ErrorCode::kLimitExceeded && error.code != ErrorCode::kNothingUsable) return error;
    tessellation.over_budget = error.code == ErrorCode::kLimitExceeded ? MemoryReason() : error.message;
    return tessellation;
  }

  std::string MemoryReason() const {
    return "it needs more than " + std::to_string(trade().budget_mb) + " MB (--budget-memory)";
  }

  // Returns true if the error ends the run, and not just the point.
  bool Stopped(const Error& error, const Deadline& budget) const {
    if (*deadline_.flag()) return true;
    return error.code != ErrorCode::kLimitExceeded &&
           !(error.code == ErrorCode::kCancelled && budget.expired());
  }

  // Returns an error that names --timeout if the time limit stopped the run; otherwise returns `error`.
  Error Explained(const Error& error) const {
    if (!deadline_.expired()) return error;
    return {ErrorCode::kLimitExceeded, model().info.file + ": the measurements took longer than " +
                                           NumberText(timeout_s_) + " s; use --timeout to allow more"};
  }

  Result<TradeResult> Report() {
    TradeLimits limits = trade().limits;
    if (!limits.error_mm && !limits.error_px) limits.error_px = kDefaultLimitPx;
    TradeResult result;
    result.text = BusyText();
    Json views = Json::array(), points = Json::array(), answers = Json::array();
    for (TradeView& view : views_) {
      AnswerQuestions(view, limits);
      auto entry = ViewJson(view);
      if (!entry) return entry.error();
      views.push_back(std::move(entry).value());
      for (const TradePoint& point : view.points) points.push_back(TradePointJson(point, view.context.view));
      for (const LimitAnswer& answer : view.limits) answers.push_back(LimitAnswerJson(answer, view));
      for (const CrossoverAnswer& answer : view.crossovers)
        answers.push_back(CrossoverAnswerJson(answer, view));
      for (const std::string& sentence : view.methods)
        answers.push_back({{"question", "method"}, {"view", view.context.view}, {"sentence", sentence}});
      if (!view.next_view.empty())
        answers.push_back(
            {{"question", "next_view"}, {"view", view.context.view}, {"sentence", view.next_view}});
      result.text += TradeTable(view) + "\n";
      for (const std::string& sentence : Sentences(view)) result.text += sentence + "\n";
    }
    const ImportInfo& info = model().info;
    result.run.verdict =
        Judge(options_, {}, {.problems = {}, .lost = LossCount(model()), .unit_known = KnowsUnit(model())});
    result.run.files = std::move(files_);
    result.run.report = {{"facetless", ProgramJson(context_.execution.threads)},
                         {"command", "trade"},
                         {"model", ImportedModelJson(imported_)},
                         {"views", std::move(views)},
                         {"trade",
                          {{"points", std::move(points)},
                           {"answers", std::move(answers)},
                           {"error_measure", MeasureName(trade().measure)},
                           {"limits",
                            {{"error_mm", limits.error_mm ? Json(*limits.error_mm) : Json(nullptr)},
                             {"error_px", limits.error_px ? Json(*limits.error_px) : Json(nullptr)}}},
                           {"budget", {{"seconds", trade().budget_s}, {"memory_mb", trade().budget_mb}}},
                           {"mesher_threads", 1},
                           {"load_at_start", load_at_start_},
                           {"shared_ms", {{"read", info.read_ms}, {"transfer", info.transfer_ms}}}}},
                         {"verdict", VerdictJson(result.run.verdict)}};
    if (!arrangement_.is_null()) result.run.report["arrangement"] = arrangement_;
    if (auto written = WriteReport(result.run, directory_); !written) return written.error();
    return result;
  }

  // Returns a sentence if other programs used more than half of a core. The load average of the last minute
  // includes reading the file.
  std::string BusyText() const {
    constexpr double kQuiet = 1.5;
    if (load_at_start_ <= kQuiet) return "";
    return "The machine had other work (load " + NumberText(load_at_start_) + " on " +
           std::to_string(std::thread::hardware_concurrency()) +
           " cores): times are longer than they need be.\n";
  }

  // Writes the picture and the plots of a view, and returns its entry in the report.
  Result<Json> ViewJson(const TradeView& view) {
    const TradeReference& reference = view.reference;
    const std::string name = view.context.view, picture = name + ".direct.png";
    if (auto written = WritePng(directory_ + "/" + picture, reference.view.image); !written)
      return written.error();
    files_.Add(name, "direct", picture);
    const std::string prefix = views_.size() > 1 ? name + "." : "";
    Json plots = Json::object();
    for (const TradeCost cost : {TradeCost::kTime, TradeCost::kMemory}) {
      const char* role = cost == TradeCost::kTime ? "time" : "memory";
      const std::string stem = prefix + "trade-" + role;
      const LogPlot plot = TradePlot(view, cost, model().info.file);
      for (const auto& [extension, draw] : {std::pair{".svg", &PlotSvg}, {".png", &PlotPng}}) {
        auto bytes = draw(plot);
        if (!bytes) return bytes.error();
        if (auto written = WriteFileAtomically(directory_ + "/" + stem + extension, bytes.value()); !written)
          return written.error();
        files_.Add(name, std::string("trade-") + role + extension, stem + extension);
      }
      plots[role] = {{"svg", stem + ".svg"}, {"png", stem + ".png"}};
    }
    return Json{{"name", name},
                {"camera", CameraJson(reference.camera)},
                {"files", {{"direct", picture}}},
                {"plots", std::move(plots)},
                {"sentences", Sentences(view)},
                {"reference",
                 {{"precision", "certified"},
                  {"picture_samples", reference.samples},
                  {"mm_per_pixel", reference.mm_per_pixel},
                  {"floor_mm", reference.floor_mm},
                  {"outline_pixels", reference.outline_pixels},
                  {"hits", reference.view.counters.hits},
                  {"certified", reference.view.direct->certified},
                  {"converged", reference.view.direct->converged},
                  {"unresolved", reference.view.direct->unresolved}}}};
  }

  const ImportRequest& request_;
  const ImportedModel &whole_, &imported_;
  const Json& arrangement_;  // null if everything is shown as in the file
  const RunOptions& options_;
  const std::string directory_;
  const RunContext& context_;
  const double timeout_s_;
  Deadline deadline_;
  std::vector<TradeView> views_;
  RunFiles files_;
  std::vector<MeshSetting> over_budget_;
  double scene_ms_ = 0, last_mesh_ms_ = 0, load_at_start_ = 0;
  int steps_ = 0, steps_done_ = 0;
};

}  // namespace

Result<TradeResult> RunTrade(const ImportRequest& request, const ImportedModel& imported,
                             const RunOptions& options, const std::string& directory,
                             const RunContext& context) {
  if (!options.sections.empty())
    return Error{ErrorCode::kBadUsage, "trade measures whole models; it takes no section"};
  if (auto used = CheckMethodOptions(options); !used) return used.error();
  const auto shown = ShownModel::Of(imported, nullptr, options.picture.arrangement);
  if (!shown) return shown.error();
  return Sweep(request, imported, shown.value(), options, directory, context).Run();
}

}  // namespace facetless
