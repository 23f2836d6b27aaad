#include "server/run/regress.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "render/compare/compare_view.h"
#include "render/image/metrics.h"
#include "server/base/exit_code.h"
#include "server/base/files.h"
#include "server/base/json_text.h"
#include "server/base/version.h"
#include "server/options/option_values.h"
#include "server/run/report_html.h"
#include "server/run/shown_model.h"
#include "server/run/trace_options.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t kMaxManifestBytes = 16 << 20;

// The names of the tolerances; "lost" applies to a file, the others to a view.
constexpr std::array<const char*, 8> kTolerances = {
    "max", "mean", "rms", "share_over_threshold", "flip", "depth_mm", "silhouette_px", "lost"};

struct Entry {
  std::string file;        // path
  std::string name;        // stem of the references
  std::string references;  // directory
  RunOptions options;
  Json tolerances;  // name -> number
};

Error BadManifest(const std::string& what) {
  return {ErrorCode::kBadUsage, "the manifest: " + what};
}

// Returns `under` with the values of `over` in place of its own.
Json Merged(Json under, const Json& over) {
  for (const auto& [key, value] : over.items()) {
    if (key == "tolerances" && under.contains(key)) {
      under[key].update(value);
    } else {
      under[key] = value;
    }
  }
  return under;
}

Result<Json> Tolerances(const Json& given) {
  if (!given.is_object()) return BadManifest("tolerances must be an object");
  for (const auto& [name, value] : given.items()) {
    if (std::find(kTolerances.begin(), kTolerances.end(), name) == kTolerances.end())
      return BadManifest("there is no tolerance \"" + name +
                         "\"; they are max, mean, rms, share_over_threshold, flip, depth_mm, "
                         "silhouette_px and lost");
    if (!value.is_number() || !(value.get<double>() >= 0))
      return BadManifest("the tolerance " + name + " must be a number of at least 0");
  }
  Json tolerances = given;
  // The tolerances "max" and "lost" are 0 unless they are given.
  for (const char* name : {"max", "lost"}) {
    if (!tolerances.contains(name)) tolerances[name] = 0;
  }
  return tolerances;
}

Result<Entry> ParseEntry(Json json, const fs::path& base, const RegressRequest& request) {
  if (!json.is_object() || !json.contains("file") || !json["file"].is_string())
    return BadManifest("each of \"files\" must be an object with a \"file\"");
  Entry entry;
  const fs::path file = json["file"].get<std::string>();
  entry.file = (base / file).string();
  for (const char* key : {"name", "references"}) {
    if (json.contains(key) && !json[key].is_string())
      return BadManifest(std::string(key) + " must be a string");
  }
  entry.name = json.value("name", file.stem().string());
  if (entry.name.empty() || entry.name.find('/') != std::string::npos)
    return BadManifest("name must be a file name without directories");
  entry.references = (base / json.value("references", "references")).string();
  auto tolerances = Tolerances(json.value("tolerances", Json::object()));
  if (!tolerances) return tolerances.error();
  entry.tolerances = std::move(tolerances).value();

  // The remaining keys are options of a rendering.
  for (const char* key : {"file", "name", "references", "tolerances"}) json.erase(key);
  std::vector<std::string> taken;
  for (const OptionRow& row : AllOptions())
    if ((row.commands & kManifest) != 0) taken.push_back(row.name);
  for (const auto& [key, value] : json.items())
    if (const OptionRow* row = FindOption(key); row != nullptr && (row->commands & kManifest) == 0)
      return BadManifest("the option " + row->name + " has no meaning here; the options of an entry are " +
                         Joined(taken));
  auto options = ParseOptions(json);
  if (!options) return BadManifest(options.error().message);
  entry.options = std::move(options).value();
  if (!json.contains("unit")) entry.options.unit_mm = request.unit_mm;
  if (!json.contains("import_timeout"))
    entry.options.import_limits.timeout_s = request.import_limits.timeout_s;
  if (!json.contains("import_memory"))
    entry.options.import_limits.memory_mb = request.import_limits.memory_mb;
  return entry;
}

Result<std::vector<Entry>> ParseManifest(const RegressRequest& request) {
  auto text = ReadFile(request.manifest, kMaxManifestBytes);
  if (!text) return text.error();
  const auto parsed = ParseJsonText(text.value(), request.manifest, /*ignore_comments=*/true);
  if (!parsed) return parsed.error();
  const Json& json = parsed.value();
  if (!json.is_object() || !json.contains("files") || !json["files"].is_array())
    return BadManifest("it must be a JSON object with a list \"files\"");
  for (const auto& [key, value] : json.items()) {
    if (key != "files" && key != "defaults")
      return BadManifest("there is no \"" + key + "\"; it has files and defaults");
  }
  const Json defaults = json.value("defaults", Json::object());
  if (!defaults.is_object()) return BadManifest("defaults must be an object");
  const fs::path base = fs::path(request.manifest).parent_path();
  std::vector<Entry> entries;
  std::set<std::string> stems;
  for (const Json& file : json["files"]) {
    auto entry = ParseEntry(file.is_object() ? Merged(defaults, file) : file, base, request);
    if (!entry) return entry.error();
    if (!stems.insert(entry.value().references + "/" + entry.value().name).second)
      return BadManifest("two files are named " + entry.value().name + "; give one of them a \"name\"");
    entries.push_back(std::move(entry).value());
  }
  if (entries.empty()) return BadManifest("it lists no file, so that nothing would be compared");
  return entries;
}

bool NeedsDepth(const Json& tolerances) {
  return tolerances.contains("depth_mm") || tolerances.contains("silhouette_px");
}

struct Outcome {
  Json entry;  // the verdict's, of a view or of a file
  int exit_code = 0;
  std::vector<std::string> failures;  // sentences; of a view without its name
};

Outcome Failure(const std::string& name, const std::string& status, int exit_code) {
  return {{{"name", name}, {"passed", false}, {"status", status}}, exit_code, {status}};
}

Result<void> WriteReference(const Entry& entry, const std::string& stem, const View& view) {
  if (auto made = MakeDirectories(entry.references); !made) return made;
  if (auto written = WritePng(stem + ".png", view.image); !written) return written;
  if (!NeedsDepth(entry.tolerances)) return {};
  return WriteDepth(stem + ".depth.tif", view.samples.width, view.samples.height, view.samples.depth);
}

// The image, the reference and the difference, and a picture of the three side by side.
Result<Json> WriteFailure(const std::string& out, const std::string& stem, const Image8& image,
                          const Image8& reference, double pixels_per_degree) {
  if (auto made = MakeDirectories(out); !made) return made.error();
  auto flip = FlipMap(reference, image, pixels_per_degree);
  if (!flip) return flip.error();
  const Image8 difference = ErrorPicture(flip.value(), image.width, image.height);
  const std::pair<const char*, Image8> pictures[] = {
      {"image", image},
      {"reference", reference},
      {"difference", difference},
      {"side-by-side", SideBySide(image, reference, difference)}};
  Json files = Json::object();
  for (const auto& [role, picture] : pictures) {
    const std::string path = out + "/" + stem + "." + role + ".png";
    if (auto written = WritePng(path, picture); !written) return written.error();
    files[role] = path;
  }
  return files;
}

// Compares one view with its reference.
Result<Outcome> Compare(const Entry& entry, const Camera& camera, const View& view, const std::string& stem,
                        const std::string& out) {
  auto reference = ReadPng(stem + ".png");
  if (!reference && reference.error().code == ErrorCode::kFileUnreadable)
    return Failure(camera.name, "no reference: run with --update to write " + stem + ".png", kExitFailed);
  if (!reference) return reference.error();
  const ColorMetricOptions color;
  auto metrics = CompareColors(reference.value(), view.image, color);
  if (!metrics && metrics.error().code == ErrorCode::kSizeMismatch)
    return Failure(camera.name, metrics.error().message, kExitSize);
  if (!metrics) return metrics.error();
  Json values = {
      {"max", metrics.value().max},        {"mean", metrics.value().mean},
      {"rms", metrics.value().rms},        {"share_over_threshold", metrics.value().share_over_threshold},
      {"flip", metrics.value().flip_mean}, {"ssim", metrics.value().ssim}};
  if (NeedsDepth(entry.tolerances)) {
    auto depth = ReadDepth(stem + ".depth.tif");
    if (!depth) return Failure(camera.name, depth.error().message + "; run with --update", kExitFailed);
    auto difference =
        CompareDepths(depth.value(), {view.samples.width, view.samples.height, view.samples.depth});
    if (!difference)
      return Failure(camera.name, difference.error().message, ExitCodeForError(difference.error()));
    values["depth_mm"] = difference.value().max_mm;
    values["silhouette_px"] = difference.value().silhouette_pixels;
  }

  // Check every tolerance in the form that fails for NaN.
  Json broken = Json::array();
  std::vector<std::string> failures;
  for (const auto& [name, limit] : entry.tolerances.items()) {
    if (name == "lost") continue;
    const Json& value = values.at(name);
    if (value.get<double>() <= limit.get<double>()) continue;
    broken.push_back({{"tolerance", name}, {"limit", limit}, {"value", value}});
    failures.push_back("the tolerance " + name + " is broken: the value is " + value.dump() +
                       ", the limit is " + limit.dump());
  }
  const bool passed = broken.empty();
  Outcome outcome = {{{"name", camera.name},
                      {"passed", passed},
                      {"status", passed ? "passed" : "different"},
                      {"values", values},
                      {"broken", broken}},
                     passed ? kExitDone : kExitFailed,
                     std::move(failures)};
  if (!passed && !out.empty()) {
    auto files = WriteFailure(out, entry.name + "." + camera.name, view.image, reference.value(),
                              color.pixels_per_degree);
    if (!files) return files.error();
    outcome.entry["files"] = std::move(files).value();
  }
  return outcome;
}

// Checks one file with all its views. Errors: a failure of this file alone, or kCancelled.
Result<Outcome> RunEntry(const Entry& entry, const RegressRequest& request) {
  ImportRequest import;
  import.input = entry.file;
  import.limits = entry.options.import_limits;
  import.unit_mm = entry.options.unit_mm;
  import.execution = request.context.execution;
  auto imported = Import(import);
  if (!imported) return imported.error();
  const auto shown = ShownModel::Of(imported.value(), nullptr, entry.options.picture.arrangement);
  if (!shown) return shown.error();
  const Model& model = *shown.value().imported().model;
  auto cameras = ResolveCameras(entry.options, model.bounds);
  if (!cameras) return cameras.error();
  const Scene scene(model);
  auto sections = ResolveSections(entry.options.sections, model.bounds);
  if (!sections) return sections.error();
  ViewOptions view_options = ToViewOptions(entry.options, sections.value(), request.context.execution);
  // References are kept for years, and a tolerance of 0 is the default: a picture must not depend on how pixels are
  // chosen for refinement.
  view_options.uniform_samples = true;
  const ExactSurfaces exact(scene, ToDirectOptions(entry.options, sections.value()));

  const std::size_t lost = LossCount(model);
  const bool lost_too_much = static_cast<double>(lost) > entry.tolerances.at("lost").get<double>();
  Outcome file = {{{"lost", lost}, {"views", Json::array()}}, lost_too_much ? kExitFailed : kExitDone, {}};
  for (const Camera& camera : cameras.value()) {
    auto view = RenderView(exact, model, camera, view_options);
    if (!view) return view.error();
    const std::string stem = entry.references + "/" + entry.name + "." + camera.name;
    if (request.update) {
      if (auto written = WriteReference(entry, stem, view.value()); !written) return written.error();
      file.entry["views"].push_back({{"name", camera.name}, {"passed", true}, {"status", "written"}});
      continue;
    }
    auto outcome = Compare(entry, camera, view.value(), stem, request.out);
    if (!outcome) return outcome.error();
    file.exit_code = std::max(file.exit_code, outcome.value().exit_code);
    for (const std::string& failure : outcome.value().failures)
      file.failures.push_back(entry.name + ", view '" + camera.name + "': " + failure);
    file.entry["views"].push_back(std::move(outcome).value().entry);
  }
  if (lost_too_much)
    file.failures.push_back(entry.name + ": the tolerance \"lost\" is broken: the import lost " +
                            std::to_string(lost) + " faces, loops or edges");
  return file;
}

Result<void> WritePage(const Json& verdict, const std::string& out) {
  if (auto made = MakeDirectories(out); !made) return made;
  auto html = RegressHtml(verdict);
  if (!html) return html.error();
  return WriteFileAtomically(out + "/report.html", html.value());
}

}  // namespace

Result<RegressResult> RunRegress(const RegressRequest& request) {
  auto entries = ParseManifest(request);
  if (!entries) return entries.error();
  Json files = Json::array();
  RegressResult result;
  for (const Entry& entry : entries.value()) {
    if (request.context.progress)
      request.context.progress(
          "regress", static_cast<double>(files.size()) / static_cast<double>(entries.value().size()));
    auto outcome = RunEntry(entry, request);
    if (!outcome &&
        (outcome.error().code == ErrorCode::kCancelled || outcome.error().code == ErrorCode::kWriteFailed))
      return outcome.error();
    Json file =
        outcome
            ? outcome.value().entry
            : Json{{"error",
                    {{"code", ErrorCodeName(outcome.error().code)}, {"message", outcome.error().message}}}};
    const int file_code = outcome ? outcome.value().exit_code : ExitCodeForError(outcome.error());
    file["file"] = entry.file;
    file["name"] = entry.name;
    file["passed"] = file_code == kExitDone;
    files.push_back(std::move(file));
    result.exit_code = std::max(result.exit_code, file_code);
    if (!outcome) {
      result.failures.push_back(entry.name + ": " + outcome.error().message);
      continue;
    }
    result.failures.insert(result.failures.end(), outcome.value().failures.begin(),
                           outcome.value().failures.end());
  }
  result.verdict = {{"facetless", ProgramJson(request.context.execution.threads)},
                    {"command", "regress"},
                    {"manifest", request.manifest},
                    {"updated", request.update},
                    {"passed", result.exit_code == kExitDone},
                    {"exit_code", result.exit_code},
                    {"files", std::move(files)}};
  if (!request.out.empty()) {
    if (auto written = WritePage(result.verdict, request.out); !written) return written.error();
  }
  return result;
}

}  // namespace facetless
