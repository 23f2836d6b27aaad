#include "server/command/cli_options.h"

#include <CLI/CLI.hpp>

#include <utility>
#include <vector>

#include "server/base/files.h"
#include "server/base/json_text.h"

namespace facetless {

using Json = nlohmann::json;

// ---- What is collected ----

void OptionCollector::Text(CLI::App* app, const std::string& flag, const std::string& help,
                           const std::string& type) {
  app->add_option_function<std::string>(
         "--" + flag, [=, this](const std::string& v) { json_[flag] = v; }, help)
      ->type_name(type);
}

void OptionCollector::Number(CLI::App* app, const std::string& flag, const std::string& help,
                             const std::string& type) {
  app->add_option_function<double>(
         "--" + flag, [=, this](double v) { json_[flag] = v; }, help)
      ->type_name(type);
}

void OptionCollector::Switch(CLI::App* app, const std::string& flag, const std::string& help) {
  app->add_flag_callback(
      "--" + flag, [=, this] { json_[flag] = true; }, help);
}

void OptionCollector::List(CLI::App* app, const std::string& flag, const std::string& help,
                           const std::string& type) {
  app->add_option_function<std::vector<std::string>>(
         "--" + flag, [=, this](const std::vector<std::string>& v) { json_[flag] = v; }, help)
      ->type_name(type)
      ->expected(1)
      ->take_all();
}

Result<Json> OptionCollector::Take() {
  if (!json_.contains("camera")) return json_;
  std::string text = json_["camera"].get<std::string>();
  if (text.starts_with("@")) {
    constexpr std::size_t kMaxCameraFile = 1 << 20;
    auto file = ReadFile(text.substr(1), kMaxCameraFile);
    if (!file) return Error{ErrorCode::kBadUsage, "--camera: " + file.error().message};
    text = std::move(file).value();
  }
  auto camera = ParseJsonText(text, "--camera");
  if (!camera)
    return Error{ErrorCode::kBadUsage,
                 camera.error().message + "; an example is '{\"eye\":[200,-300,150],\"height\":120}'"};
  json_["camera"] = std::move(camera).value();
  return json_;
}

// ---- What there is ----

void AddCameraOptions(CLI::App* app, OptionCollector& options) {
  std::string names;
  for (const std::string& name : ViewNames()) names += (names.empty() ? "" : ", ") + name;
  options.List(app, "view", "Named view, repeatable (default iso): " + names, "NAME");
  options.Text(app, "camera",
               "Camera instead of a named view: JSON object, list of them, or @FILE (docs/cameras.md)",
               "JSON");
  options.Text(app, "size", "Picture size in pixels (default 1024x1024)", "WxH");
  options.Text(app, "projection", "orthographic (default) or perspective, of named views", "NAME");
  options.Number(app, "margin", "Free share of the picture on each side, 0 … 0.45 (default 0.05)", "SHARE");
  options.Text(app, "up", "The model's axis that named views draw upwards: x, y or z (default)", "AXIS");
  options.Number(app, "threads", "Threads; 0 (default) is one per core", "N");
  options.Number(
      app, "timeout",
      "Seconds that everything after the import may take (default 600, for a trade 3600); 0 means no limit",
      "S");
}

void AddViewOptions(CLI::App* app, OptionCollector& options) {
  AddCameraOptions(app, options);
  options.Number(app, "samples", "Samples per pixel of the colour image: 1, 4 (default), 9, 16, …", "N");
  options.Text(app, "precision", "fast, standard (default) or certified", "NAME");
  options.Text(app, "check",
               "How many of the certified samples an independent check tests again: none, share, all or auto "
               "(default: share with --precision certified, all with --audit)",
               "NAME");
  options.Number(app, "newton-tolerance",
                 "Share of a leaf at which the iteration stops, 1e-13 … 1e-3 (default: the precision's own)",
                 "REL");
  options.Switch(app, "audit", "Also count every crossing of every ray, and compare with the opposite view");
  options.Switch(app, "edges", "Draw feature edges");
  options.Text(app, "lines",
               "Draw the exact edges and silhouettes: none (default), visible or hidden (too, dashed)",
               "NAME");
  options.Switch(app, "svg", "Write the view's lines as NAME.lines.svg");
  options.List(app, "section",
               "Cut away what lies on the side of a plane that its normal points to; repeatable. A point and "
               "a normal, or "
               "a plane across an axis: x=12.5, z=50%, -z=50% (docs/sections.md)",
               "X,Y,Z,NX,NY,NZ");
  options.Text(app, "background", "studio (default) or transparent", "NAME");
  options.Text(
      app, "shade",
      "What pictures show: studio (default), zebra, isophotes, reflection, curvature, draft, thickness, "
      "faces, unseen, back; with settings as in zebra:stripes=24,axis=z (docs/inspection.md)",
      "NAME[:...]");
  options.Text(app, "orient",
               "Which side of a surface is outside, for draft, curvature and thickness: file (default), or "
               "viewer, the side that is seen",
               "NAME");
  options.Number(app, "max-view-memory",
                 "Megabytes that a view may take: its leaves, and the mesh's search tree (default 4096)",
                 "MB");
  options.Text(app, "aov", "Write NAME.aov.exr with: depth,normal,face,uv,certificate", "LIST");
}

void AddShowHiddenOption(CLI::App* app, OptionCollector& options) {
  options.Switch(app, "show-hidden",
                 "Show also what the file hides: invisible items and layers, blanked entities");
}

void AddPictureOptions(CLI::App* app, OptionCollector& options) {
  options.Text(app, "color", "face (default: what the file says), part (a colour for each) or #rrggbb",
               "NAME");
  options.List(app, "parts",
               "Show only occurrences whose path has this in it, or matches it (* and ?); repeatable",
               "NAME");
  options.List(app, "hide", "Leave such occurrences out; repeatable", "NAME");
  options.Number(app, "explode", "Move occurrences apart: 1 doubles their distance from the centre",
                 "FACTOR");
  AddShowHiddenOption(app, options);
  options.Switch(app, "scale-bar", "Draw a scale bar into the pictures (orthographic views)");
  options.Switch(app, "axes", "Draw the model's axes into the pictures");
  options.Switch(app, "sheet", "Write sheet.png: all views on one picture");
}

void AddTurntableOptions(CLI::App* app, OptionCollector& options) {
  options.Number(app, "turntable",
                 "Write N frames, 2 … 360, around the first view, and turntable.webp, which plays them", "N");
  options.Number(app, "turntable-seconds", "Duration of one turn (default 6)", "S");
}

void AddTessellationOptions(CLI::App* app, OptionCollector& options) {
  options.Number(app, "deflection", "Chord error relative to the diagonal of the bounding box (default 1e-3)",
                 "REL");
  options.Number(app, "deflection-mm", "Chord error in millimetres, instead of --deflection", "MM");
  options.Number(app, "angular", "Angle between neighbouring facets in degrees (default 20)", "DEG");
  options.Number(
      app, "mesh-timeout",
      "Seconds that meshing may take (default 300); a comparison without a mesh has its exact half",
      "SECONDS");
}

void AddTradeOptions(CLI::App* app, OptionCollector& options) {
  options.Text(app, "deflections",
               "Meshes to measure: chord errors relative to the diagonal (default 1e-2,1e-3,1e-4,1e-5,1e-6)",
               "LIST");
  options.Text(app, "angles",
               "Angles between facets in degrees; the widest goes with every deflection, the others where "
               "they make a difference (default 30,12,5)",
               "LIST");
  options.Text(app, "tolerances",
               "Newton tolerances of the direct tracer in standard precision, shares of a leaf (default "
               "1e-3,1e-5,1e-8)",
               "LIST");
  options.Number(app, "budget-seconds",
                 "Seconds that meshing, and one view, may take; finer meshes are not tried (default 60)",
                 "S");
  options.Number(app, "budget-memory", "Megabytes that one point may take (default 4096)", "MB");
  options.Number(app, "max-error-mm", "Which mesh keeps the error under this, and for what cost?", "MM");
  options.Number(app, "max-error-px", "The same in pixels (default 0.5, if neither is given)", "PX");
  options.Text(app, "error-measure",
               "What stands for a point's error: mean, p95, p99 (default) or max of the deviation", "NAME");
}

void AddBenchOptions(CLI::App* app, CommandArguments& arguments) {
  BenchSettings& bench = arguments.bench;
  app->add_option("FILE", arguments.files, "STEP, IGES, BREP or model files");
  app->add_option("--repeats", bench.repeats, "Runs of each measurement after a warm-up; the median counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->add_option("--time-limit", bench.time_limit_s, "Seconds of one mesh; it counts at the limit")
      ->type_name("S")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--json", arguments.json_out, "Also write everything that was measured")->type_name("FILE");
  app->add_option("--plot", arguments.plot_out, "Also draw the rows")->type_name("FILE.svg");
  app->add_flag("--markdown", bench.markdown, "Print the tables as Markdown");
  app->add_flag("!--no-growth", bench.growth, "Leave out row 9, which takes about a minute");
  app->add_flag("--published", bench.published, "Measure the tables of the papers instead");
}

void AddImportOptions(CLI::App* app, OptionCollector& options, CommandArguments& arguments) {
  options.Text(app, "unit",
               "Unit of the file: mm, cm, m, in, ft, … or its length in millimetres (default: the file's)",
               "NAME|MM");
  options.Number(app, "import-timeout", "Seconds that the import may take, but for meshing (default 300)",
                 "S");
  options.Number(app, "import-memory", "Megabytes of address space that the import may use (default 8192)",
                 "MB");
  app->add_flag("--progress", arguments.progress, "Print progress even if standard error is no terminal");
}

}  // namespace facetless
