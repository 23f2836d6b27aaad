#include "server/run/methods.h"

#include <utility>
#include <vector>

#include "bench/method_bench.h"
#include "render/compare/compare_view.h"
#include "render/compare/report.h"
#include "render/image/io.h"
#include "render/solve/solver.h"
#include "server/base/files.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"
#include "server/run/shown_model.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

class MethodsRun {
 public:
  MethodsRun(const ImportedModel& imported, const RunOptions& options, const std::string& directory,
             const RunContext& context)
      : imported_(imported),
        options_(options),
        directory_(directory),
        context_(context),
        timeout_s_(options.timeout_s.value_or(kTradeTimeoutS)),
        deadline_(timeout_s_, context.execution.cancel) {}

  Result<MethodsResult> Run() {
    if (!directory_.empty())
      if (auto made = MakeDirectories(directory_); !made) return made.error();
    auto cameras = ResolveCameras(options_, model().bounds);
    if (!cameras) return cameras.error();
    const Scene scene(model());
    const std::vector<MethodTrial> trials = MethodTrials(Choices());
    steps_ = static_cast<int>(cameras.value().size() * (1 + trials.size()));
    MethodsResult result;
    Json views = Json::array();
    for (const Camera& camera : cameras.value()) {
      auto view = MeasureView(scene, camera, trials, result.text);
      if (!view) return Explained(view.error());
      views.push_back(std::move(view).value());
    }
    result.json = {{"facetless", ProgramJson(1)},
                   {"command", "methods"},
                   {"model", ImportedModelJson(imported_)},
                   {"structure", options_.solver.structure},
                   {"views", std::move(views)}};
    if (!directory_.empty())
      if (auto written = WriteFileAtomically(directory_ + "/methods.json", JsonText(result.json) + "\n");
          !written)
        return written.error();
    return result;
  }

 private:
  const Model& model() const { return *imported_.model; }

  std::vector<MethodChoice> Choices() const {
    if (!options_.trade.methods.empty()) return options_.trade.methods;
    std::vector<MethodChoice> choices;
    // Methods with a number are other representations, which trade measures.
    for (const Method* method : Methods())
      if (method->setting.empty()) choices.push_back({method});
    return choices;
  }

  Execution execution() const { return context_.execution.WithFlag(deadline_.flag()); }

  void Step(const std::string& what) {
    if (context_.progress) context_.progress(what, static_cast<double>(steps_done_) / steps_);
    ++steps_done_;
  }

  Result<Json> MeasureView(const Scene& scene, const Camera& camera, const std::vector<MethodTrial>& trials,
                           std::string& text) {
    Step("certified");
    auto reference = MakeMethodReference(scene, camera, execution());
    if (!reference) return reference.error();
    // The picture that is marked has a pixel for each ray.
    std::optional<Image8> picture;
    if (!directory_.empty()) {
      ViewOptions view_options;
      view_options.execution = execution();
      auto view = RenderView(ExactSurfaces(scene, {}), model(), camera, view_options);
      if (!view) return view.error();
      picture = std::move(view.value().image);
      if (auto written = WritePng(PicturePath(camera, "certified"), *picture); !written)
        return written.error();
    }
    std::vector<MethodFigures> figures;
    Json methods = Json::array();
    for (const MethodTrial& trial : trials) {
      Step(MethodTrialName(trial));
      auto measured = MeasureMethod(scene, reference.value(), trial,
                                    {.execution = execution(),
                                     .structure = options_.solver.structure,
                                     .max_bytes = options_.accuracy.max_bytes});
      if (!measured) return measured.error();
      Json json = MethodFiguresJson(measured.value());
      if (picture && measured.value().missing.empty() && trial.choice.method != &CertifiedMethod()) {
        Image8 marked = *picture;
        MarkHitErrors(measured.value().errors, &marked);
        if (auto written = WritePng(PicturePath(camera, MethodTrialStem(trial)), marked); !written)
          return written.error();
        json["file"] = camera.name + "." + MethodTrialStem(trial) + ".png";
      }
      methods.push_back(std::move(json));
      figures.push_back(std::move(measured).value());
      // The table has no use for the errors of single rays.
      std::vector<HitError>().swap(figures.back().errors.of);
    }
    text +=
        TableText(MethodTable(model().info.file + ", view " + camera.name + ", " +
                                  std::to_string(camera.width_px) + "×" + std::to_string(camera.height_px),
                              figures),
                  TableStyle::kText);
    const SampleBuffer& samples = reference.value().view.samples;
    return Json{{"name", camera.name},
                {"camera", CameraJson(camera)},
                {"rays", samples.size()},
                {"hits", reference.value().view.counters.hits},
                {"methods", std::move(methods)}};
  }

  std::string PicturePath(const Camera& camera, const std::string& stem) const {
    return directory_ + "/" + camera.name + "." + stem + ".png";
  }

  Error Explained(const Error& error) const {
    if (error.code != ErrorCode::kCancelled || !deadline_.expired()) return error;
    return {ErrorCode::kLimitExceeded, model().info.file + ": the measurements took longer than " +
                                           std::to_string(static_cast<int>(timeout_s_)) +
                                           " s; use --timeout to allow more, or name fewer --methods"};
  }

  const ImportedModel& imported_;
  const RunOptions& options_;
  const std::string& directory_;
  const RunContext& context_;
  const double timeout_s_;
  Deadline deadline_;
  int steps_ = 0, steps_done_ = 0;
};

}  // namespace

std::string MethodsText() {
  std::string text;
  for (const Method* method : Methods()) {
    text += method->name + "  (" + method->title + ")\n";
    const auto line = [&](const char* label, const std::string& sentence) {
      if (sentence.empty()) return;
      // Wrapped lines are indented.
      text += "    ";
      for (const char c : Wrapped(std::string(label) + ": " + sentence))
        text += c == '\n' ? std::string("\n      ") : std::string(1, c);
      text += '\n';
    };
    line("what it does", method->help);
    line("source", method->source);
    line("what it does not promise", method->does_not);
    if (const SolverInfo* solver = method->solver) {
      std::string takes = "degrees up to " + std::to_string(solver->max_degree) +
                          (solver->rational ? ", rational or not" : ", not rational") + "; starts: pieces";
      if (solver->takes_map)
        takes += ", map, published-map (usual: " +
                 std::string(kSolverStartsNames[static_cast<std::size_t>(solver->starts)]) + ")";
      line("takes", takes);
    }
    if (!method->setting.empty()) line("number", method->setting);
    text += "\n";
  }
  return text;
}

Json MethodsJson() {
  Json list = Json::array();
  for (const Method* method : Methods()) {
    const SolverInfo* solver = method->solver;
    Json starts = Json::array();
    if (solver != nullptr)
      for (std::size_t i = 0; i < kSolverStartsNames.size(); ++i)
        if (i == 0 || solver->takes_map) starts.push_back(kSolverStartsNames[i]);
    list.push_back({{"name", method->name},
                    {"title", method->title},
                    {"does", method->help},
                    {"source", method->source},
                    {"does_not", method->does_not},
                    {"setting", method->setting.empty() ? Json(nullptr) : Json(method->setting)},
                    {"starts", std::move(starts)},
                    {"usual_starts", solver != nullptr
                                         ? Json(kSolverStartsNames[static_cast<std::size_t>(solver->starts)])
                                         : Json(nullptr)},
                    {"tolerance_px", solver != nullptr ? Json(solver->tolerance_px) : Json(nullptr)},
                    {"certified", method == &CertifiedMethod()}});
  }
  return {{"methods", std::move(list)}};
}

Result<MethodsResult> RunMethods(const ImportedModel& imported, const RunOptions& options,
                                 const std::string& directory, const RunContext& context) {
  const auto shown = ShownModel::Of(imported, nullptr, options.picture.arrangement);
  if (!shown) return shown.error();
  return MethodsRun(shown.value().imported(), options, directory, context).Run();
}

}  // namespace facetless
