#include "server/options/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>
#include <utility>

#include "render/compare/compare_view.h"
#include "server/options/option_values.h"
#include "server/options/shade_option.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Result<void> ParseSize(const Json& json, RunOptions& options) {
  constexpr int kMaxPixels = 65536;
  const Error error =
      BadUsage("size is " + Quoted(json) + ", but must be WIDTHxHEIGHT, each from 1 to 65536 pixels");
  int width = 0, height = 0;
  if (json.is_array() && json.size() == 2 && json[0].is_number_integer() && json[1].is_number_integer()) {
    width = static_cast<int>(std::clamp<std::int64_t>(json[0].get<std::int64_t>(), 0, kMaxPixels + 1));
    height = static_cast<int>(std::clamp<std::int64_t>(json[1].get<std::int64_t>(), 0, kMaxPixels + 1));
  } else if (json.is_string()) {
    const std::string text = json.get<std::string>();
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, width);
    if (first.ec != std::errc{} || first.ptr == end || *first.ptr != 'x') return error;
    const auto second = std::from_chars(first.ptr + 1, end, height);
    if (second.ec != std::errc{} || second.ptr != end) return error;
  }
  if (width < 1 || width > kMaxPixels || height < 1 || height > kMaxPixels) return error;
  options.width = width;
  options.height = height;
  return {};
}

Result<void> ParseSamples(const Json& json, RunOptions& options) {
  auto samples = ParseInteger(json, "samples", 1, 64);
  if (!samples) return samples.error();
  // Pixels are square, so a grid that is much finer along one axis wastes its samples.
  const SampleGrid grid = GridOf(samples.value());
  if (std::max(grid.x, grid.y) > 2 * std::min(grid.x, grid.y)) {
    std::string allowed;
    for (int n = 1; n <= 64; ++n) {
      const SampleGrid other = GridOf(n);
      if (std::max(other.x, other.y) <= 2 * std::min(other.x, other.y)) allowed += " " + std::to_string(n);
    }
    return BadUsage("samples is " + Quoted(json) + ", which makes no near-square grid; use one of" + allowed);
  }
  options.samples = samples.value();
  return {};
}

// Parsers by name. Each stores into the options what it read.
using Parser = std::function<Result<void>(const Json&, RunOptions&)>;

template <typename Parsed, typename Target>
Result<void> Store(Parsed parsed, Target& target) {
  if (!parsed) return parsed.error();
  target = std::move(parsed).value();
  return {};
}

Parser NumberParser(const char* name, double low, double high,
                    const std::function<void(RunOptions&, double)>& store) {
  return [=](const Json& json, RunOptions& options) -> Result<void> {
    auto number = ParseNumber(json, name, low, high);
    if (!number) return number.error();
    store(options, number.value());
    return {};
  };
}

template <typename Enum>
Parser WordParser(const char* name, const std::vector<std::string>& words, Enum RunOptions::*member) {
  return [=](const Json& json, RunOptions& options) -> Result<void> {
    auto index = ParseWord(json, name, words);
    if (!index) return index.error();
    if constexpr (std::is_same_v<Enum, std::string>) {
      options.*member = words[static_cast<std::size_t>(index.value())];
    } else {
      options.*member = static_cast<Enum>(index.value());
    }
    return {};
  };
}

Parser BoolParser(const char* name, bool RunOptions::*member) {
  return [=](const Json& json, RunOptions& options) { return Store(ParseBool(json, name), options.*member); };
}

Parser LimitParser(const char* name, std::optional<double> Thresholds::*member) {
  return NumberParser(name, 0, INFINITY,
                      [=](RunOptions& options, double value) { options.fail.*member = value; });
}

Parser NumbersParser(const char* name, double low, double high, std::vector<double> TradeOptions::*member) {
  return [=](const Json& json, RunOptions& options) {
    return Store(ParseNumbers(json, name, low, high), options.trade.*member);
  };
}

Result<void> ParseCameras(const Json& json, RunOptions& options) {
  options.cameras = json.is_array() ? json : Json::array({json});
  if (options.cameras.empty()) return BadUsage("camera is an empty list");
  for (const Json& camera : options.cameras) {
    if (!camera.is_object()) return BadUsage("camera is " + Quoted(camera) + ", but must be an object");
  }
  return {};
}

Result<void> ParseViews(const Json& json, RunOptions& options) {
  auto views = ParseWords(json, "view");
  if (!views) return views.error();
  if (views.value().empty()) return BadUsage("view is an empty list");
  for (const std::string& view : views.value()) {
    if (std::find(ViewNames().begin(), ViewNames().end(), view) == ViewNames().end())
      return BadUsage("there is no view \"" + view + "\"; the views are " + Joined(ViewNames()));
  }
  options.views = std::move(views).value();
  return {};
}

// A unit by its name, or its length in millimetres, as a number or as text.
Result<void> ParseUnit(const Json& json, RunOptions& options) {
  constexpr std::array<std::pair<const char*, double>, 20> kUnits{
      {{"mm", 1},       {"millimetre", 1},      {"cm", 10},        {"centimetre", 10},
       {"m", 1000},     {"metre", 1000},        {"km", 1e6},       {"kilometre", 1e6},
       {"um", 1e-3},    {"micrometre", 1e-3},   {"in", 25.4},      {"inch", 25.4},
       {"ft", 304.8},   {"foot", 304.8},        {"yd", 914.4},     {"yard", 914.4},
       {"mil", 0.0254}, {"microinch", 2.54e-5}, {"mile", 1609344}, {"dm", 100}}};
  constexpr double kLeast = 1e-9, kMost = 1e9;
  double value = 0;
  if (json.is_number()) {
    value = json.get<double>();
  } else if (json.is_string()) {
    const std::string text = json.get<std::string>();
    const auto named =
        std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& unit) { return text == unit.first; });
    if (named != kUnits.end()) {
      value = named->second;
    } else {
      const auto end = text.data() + text.size();
      const auto parsed = std::from_chars(text.data(), end, value);
      if (parsed.ec != std::errc{} || parsed.ptr != end) value = 0;
    }
  }
  if (!(value >= kLeast && value <= kMost))
    return Error{
        ErrorCode::kBadUsage,
        "unit must be a name (mm, cm, m, km, um, in, ft, yd, mil) or its length in millimetres, 1e-9 to 1e9"};
  options.unit_mm = value;
  return {};
}

Result<void> ParseAovs(const Json& json, RunOptions& options) {
  static const std::vector<std::string> kNames = {"depth", "normal", "face", "uv", "certificate"};
  auto aovs = ParseWords(json, "aov");
  if (!aovs) return aovs.error();
  for (const std::string& aov : aovs.value()) {
    if (std::find(kNames.begin(), kNames.end(), aov) == kNames.end())
      return BadUsage("there is no AOV \"" + aov + "\"; the AOVs are " + Joined(kNames));
  }
  options.aovs = std::move(aovs).value();
  return {};
}

std::vector<std::pair<std::string, Parser>> MakeParsers() {
  std::vector<std::pair<std::string, Parser>> parsers = {
      {"view", ParseViews},
      {"camera", ParseCameras},
      {"size", ParseSize},
      {"projection", WordParser("projection", {"orthographic", "perspective"}, &RunOptions::projection)},
      {"samples", ParseSamples},
      {"precision", WordParser("precision", {"fast", "standard", "certified"}, &RunOptions::precision)},
      {"check", WordParser("check", {"auto", "none", "share", "all"}, &RunOptions::check)},
      {"newton_tolerance", NumberParser("newton_tolerance", 1e-13, 1e-3,
                                        [](RunOptions& o, double v) { o.newton_tolerance = v; })},
      {"threads", [](const Json& json,
                     RunOptions& o) { return Store(ParseInteger(json, "threads", 0, 1024), o.threads); }},
      {"timeout", NumberParser("timeout", 0, INFINITY, [](RunOptions& o, double v) { o.timeout_s = v; })},
      {"audit", BoolParser("audit", &RunOptions::audit)},
      {"edges", BoolParser("edges", &RunOptions::edges)},
      {"mesh_deviation", BoolParser("mesh_deviation", &RunOptions::mesh_deviation)},
      {"background", WordParser("background", {"studio", "transparent"}, &RunOptions::background)},
      {"shade", [](const Json& json, RunOptions& o) { return Store(ParseShade(json), o.inspection); }},
      {"orient", WordParser("orient", {"file", "viewer"}, &RunOptions::orient)},
      {"lines", WordParser("lines", {"none", "visible", "hidden"}, &RunOptions::lines)},
      {"svg", BoolParser("svg", &RunOptions::svg)},
      {"section", [](const Json& json, RunOptions& o) { return Store(ParseSections(json), o.sections); }},
      {"aov", ParseAovs},
      {"mesh", [](const Json& json, RunOptions& o) { return Store(ParseText(json, "mesh"), o.mesh); }},
      {"mesh_unit", WordParser("mesh_unit", {"mm", "cm", "m", "in", "ft"}, &RunOptions::mesh_unit)},
      {"mesh_up", WordParser("mesh_up", {"y", "z"}, &RunOptions::mesh_up)},
      {"deflection",
       NumberParser("deflection", 1e-9, 1, [](RunOptions& o, double v) { o.tessellation.deflection = v; })},
      // The smallest normal double stands for "greater than 0".
      {"deflection_mm", NumberParser("deflection_mm", std::numeric_limits<double>::min(), 1e12,
                                     [](RunOptions& o, double v) { o.tessellation.deflection_mm = v; })},
      {"angular",
       NumberParser("angular", 0.1, 90, [](RunOptions& o, double v) { o.tessellation.angular_deg = v; })},
      {"mesh_timeout", NumberParser("mesh_timeout", 0.01, 1e6,
                                    [](RunOptions& o, double v) { o.import_limits.mesh_timeout_s = v; })},
      {"import_timeout", NumberParser("import_timeout", 0.01, 1e6,
                                      [](RunOptions& o, double v) { o.import_limits.timeout_s = v; })},
      {"import_memory", NumberParser("import_memory", 64, 1e9,
                                     [](RunOptions& o, double v) {
                                       o.import_limits.memory_mb = static_cast<std::uint64_t>(v);
                                     })},
      {"max_view_memory", NumberParser("max_view_memory", 1, 1e9,
                                       [](RunOptions& o, double v) {
                                         o.max_view_bytes = static_cast<std::uint64_t>(v * (1 << 20));
                                       })},
      {"unit", ParseUnit},
      {"strict", BoolParser("strict", &RunOptions::strict)},
      {"deflections", NumbersParser("deflections", 1e-9, 1, &TradeOptions::deflections)},
      {"angles", NumbersParser("angles", 0.1, 90, &TradeOptions::angles_deg)},
      {"tolerances", NumbersParser("tolerances", 1e-13, 1e-3, &TradeOptions::tolerances)},
      {"budget_seconds",
       NumberParser("budget_seconds", 0.01, 1e6, [](RunOptions& o, double v) { o.trade.budget_s = v; })},
      {"budget_memory", NumberParser("budget_memory", 16, 1e9,
                                     [](RunOptions& o, double v) {
                                       o.trade.budget_mb = static_cast<std::uint64_t>(v);
                                     })},
      // The smallest normal double stands for "greater than 0".
      {"max_error_mm", NumberParser("max_error_mm", std::numeric_limits<double>::min(), 1e12,
                                    [](RunOptions& o, double v) { o.trade.limits.error_mm = v; })},
      {"max_error_px", NumberParser("max_error_px", std::numeric_limits<double>::min(), 65536,
                                    [](RunOptions& o, double v) { o.trade.limits.error_px = v; })},
      {"error_measure",
       [](const Json& json, RunOptions& o) -> Result<void> {
         auto index = ParseWord(json, "error_measure", {"mean", "p95", "p99", "max"});
         if (!index) return index.error();
         o.trade.measure = static_cast<ErrorMeasure>(index.value());
         return {};
       }},
      {"fail_deviation_mm", LimitParser("fail_deviation_mm", &Thresholds::deviation_mm)},
      {"fail_depth_mm", LimitParser("fail_depth_mm", &Thresholds::depth_mm)},
      {"fail_silhouette_px", LimitParser("fail_silhouette_px", &Thresholds::silhouette_px)},
      {"fail_flip", LimitParser("fail_flip", &Thresholds::flip)},
      {"fail_share", LimitParser("fail_share", &Thresholds::share)},
  };
  for (const std::string& name : PictureOptionNames())
    parsers.emplace_back(name, [name](const Json& json, RunOptions& options) {
      return ParsePictureOption(name, json, options.picture);
    });
  return parsers;
}

const std::vector<std::pair<std::string, Parser>>& Parsers() {
  static const std::vector<std::pair<std::string, Parser>> parsers = MakeParsers();
  return parsers;
}

Result<Vec3> ParsePoint(const Json& json, const std::string& name) {
  const Error error = BadUsage("camera." + name + " is " + Quoted(json) + ", but must be [x, y, z]");
  if (!json.is_array() || json.size() != 3) return error;
  double xyz[3];
  for (std::size_t i = 0; i < 3; ++i) {
    if (!json[i].is_number() || !std::isfinite(json[i].get<double>())) return error;
    xyz[i] = json[i].get<double>();
  }
  return Vec3{xyz[0], xyz[1], xyz[2]};
}

// Whether a view of the options is one in perspective.
bool HasPerspective(const RunOptions& options) {
  const bool usual = options.projection == Projection::kPerspective;
  if (!options.cameras.is_array()) return usual;
  return std::any_of(options.cameras.begin(), options.cameras.end(), [usual](const Json& camera) {
    return camera.contains("projection") ? camera["projection"] == "perspective" : usual;
  });
}

bool IsFileStem(const std::string& name) {
  if (name.empty() || name.size() > 64) return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

}  // namespace

bool RunOptions::WantsAov(const std::string& name) const {
  return std::find(aovs.begin(), aovs.end(), name) != aovs.end();
}

Result<RunOptions> ParseOptions(const Json& json) {
  if (!json.is_object()) return BadUsage("the options must be a JSON object");
  RunOptions options;
  std::set<std::string> given;
  for (const auto& [key, value] : json.items()) {
    std::string name = key;
    std::replace(name.begin(), name.end(), '-', '_');
    const auto parser = std::find_if(Parsers().begin(), Parsers().end(),
                                     [&](const auto& entry) { return entry.first == name; });
    if (parser == Parsers().end())
      return BadUsage("there is no option " + Shortened(key) + Suggestion(name, OptionNames()) +
                      "; the options are " + Joined(OptionNames()));
    if (!given.insert(name).second) return BadUsage("the option " + name + " is given twice");
    if (auto parsed = parser->second(value, options); !parsed) return parsed.error();
  }
  // Options that exclude each other.
  const std::pair<const char*, const char*> exclusive[] = {
      {"view", "camera"},  {"deflection", "deflection_mm"}, {"mesh", "deflection"}, {"mesh", "deflection_mm"},
      {"mesh", "angular"}, {"mesh", "mesh_timeout"}};
  for (const auto& [a, b] : exclusive) {
    if (given.contains(a) && given.contains(b)) return BadUsage(std::string("give either ") + a + " or " + b);
  }
  if (options.picture.scale_bar && HasPerspective(options))
    return BadUsage("scale_bar needs an orthographic view: in perspective no length has one size");
  return options;
}

const std::vector<std::string>& OptionNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, parser] : Parsers()) all.push_back(name);
    return all;
  }();
  return names;
}

namespace {

// A camera as it is written, whose place is not looked at yet: `bounds` says what is not written.
Result<Camera> ReadCamera(const Json& json, const RunOptions& options, const Box3& bounds,
                          const std::string& default_name) {
  static const std::set<std::string> kKeys = {"name",   "eye",       "target", "up",       "projection",
                                              "height", "fov_y_deg", "width",  "height_px"};
  for (const auto& [key, value] : json.items()) {
    if (!kKeys.contains(key))
      return BadUsage("a camera has no " + Shortened(key) +
                      Suggestion(key, std::vector<std::string>(kKeys.begin(), kKeys.end())) +
                      "; it has name, eye, target, up, projection, height or fov_y_deg, width, height_px");
  }
  Camera camera;
  camera.name = default_name;
  camera.target = bounds.center();
  camera.projection = options.projection;
  camera.width_px = options.width;
  camera.height_px = options.height;

  // Name and projection.
  if (json.contains("name")) {
    auto name = ParseText(json["name"], "camera.name");
    if (!name) return name.error();
    camera.name = name.value();
  }
  if (!IsFileStem(camera.name))
    return BadUsage("camera.name \"" + camera.name +
                    "\" must be 1 to 64 letters, digits, _ or -, since files are named after it");
  if (json.contains("projection")) {
    auto index = ParseWord(json["projection"], "camera.projection", {"orthographic", "perspective"});
    if (!index) return index.error();
    camera.projection = static_cast<Projection>(index.value());
  }

  // Where it stands and looks.
  if (!json.contains("eye")) return BadUsage("a camera needs an \"eye\": [x, y, z] in millimetres");
  for (auto [key, point] : {std::pair{"eye", &camera.eye}, {"target", &camera.target}, {"up", &camera.up}}) {
    if (!json.contains(key)) continue;
    if (auto stored = Store(ParsePoint(json[key], key), *point); !stored) return stored.error();
  }
  if (!json.contains("up")) {
    const Vec3 forward = Normalized(camera.target - camera.eye);
    // Within 0.06 degrees of the vertical, a rounded direction would roll the picture visibly.
    constexpr double kSineOfVertical = 1e-3;
    const Vec3 up = TurnedTo(options.picture.up, {0, 0, 1});
    camera.up = Length(Cross(forward, up)) > kSineOfVertical ? up : TurnedTo(options.picture.up, {0, 1, 0});
  }

  // What it sees.
  const bool orthographic = camera.projection == Projection::kOrthographic;
  if (json.contains(orthographic ? "fov_y_deg" : "height"))
    return BadUsage(orthographic ? "an orthographic camera has a height, no fov_y_deg"
                                 : "a perspective camera has a fov_y_deg, no height");
  for (auto [key, size] : {std::pair{"width", &camera.width_px}, {"height_px", &camera.height_px}}) {
    if (!json.contains(key)) continue;
    if (auto stored = Store(ParseInteger(json[key], std::string("camera.") + key, 1, 65536), *size); !stored)
      return stored.error();
  }
  const double aspect = static_cast<double>(camera.width_px) / camera.height_px;
  camera.height = (1 + options.picture.margin) * bounds.diagonal() / std::min(1.0, aspect);
  if (json.contains("height")) {
    auto height = ParseNumber(json["height"], "camera.height", std::numeric_limits<double>::min(), 1e15);
    if (auto stored = Store(std::move(height), camera.height); !stored) return stored.error();
  }
  if (json.contains("fov_y_deg")) {
    auto angle = ParseNumber(json["fov_y_deg"], "camera.fov_y_deg", 1e-3, 179);
    if (auto stored = Store(std::move(angle), camera.fov_y_deg); !stored) return stored.error();
  }
  return camera;
}

// "camera", "camera-2", …: of the camera at `index`.
std::string DefaultCameraName(std::size_t index) {
  return index == 0 ? "camera" : "camera-" + std::to_string(index + 1);
}

}  // namespace

Result<Camera> ParseCamera(const Json& json, const RunOptions& options, const Box3& bounds,
                           const std::string& default_name) {
  auto camera = ReadCamera(json, options, bounds, default_name);
  if (!camera) return camera.error();
  if (auto frame = MakeFrame(camera.value(), bounds.diagonal()); !frame) return frame.error();
  return camera;
}

Result<std::uint64_t> CountSamples(const RunOptions& options) {
  const auto of_picture = [&](int width, int height) {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) *
           static_cast<std::uint64_t>(options.samples);
  };
  std::vector<std::uint64_t> views;
  if (options.cameras.is_array()) {
    Box3 any;
    any.Add({0, 0, 0});
    any.Add({1, 1, 1});
    for (const Json& json : options.cameras) {
      const auto camera = ReadCamera(json, options, any, DefaultCameraName(views.size()));
      if (!camera) return camera.error();
      views.push_back(of_picture(camera.value().width_px, camera.value().height_px));
    }
  } else {
    views.assign(options.views.size(), of_picture(options.width, options.height));
  }
  std::uint64_t count = 0;
  for (std::uint64_t view : views) count += view;
  if (!views.empty()) count += static_cast<std::uint64_t>(options.picture.turntable) * views.front();
  return count;
}

Result<std::vector<Camera>> ResolveCameras(const RunOptions& options, const Box3& bounds) {
  std::vector<Camera> cameras;
  if (options.cameras.is_array()) {
    for (const Json& json : options.cameras) {
      auto camera = ParseCamera(json, options, bounds, DefaultCameraName(cameras.size()));
      if (!camera) return camera.error();
      cameras.push_back(std::move(camera).value());
    }
  } else {
    for (const std::string& view : options.views) {
      auto camera = NamedView(view, bounds, options.projection, options.width, options.height,
                              {options.picture.margin, options.picture.up});
      if (!camera) return camera.error();
      cameras.push_back(std::move(camera).value());
    }
  }
  std::set<std::string> names;
  for (const Camera& camera : cameras) {
    if (!names.insert(camera.name).second)
      return BadUsage("two views are named " + camera.name + ", but files are named after them");
  }
  return cameras;
}

const char* PrecisionName(Precision precision) {
  constexpr const char* kNames[] = {"fast", "standard", "certified"};
  return kNames[static_cast<int>(precision)];
}

const char* ProjectionName(Projection projection) {
  return projection == Projection::kOrthographic ? "orthographic" : "perspective";
}

}  // namespace facetless
