#include "server/options/option_binding.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "render/compare/compare_view.h"
#include "server/options/shade_option.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Result<void> ParseSize(const OptionRow&, const Json& json, RunOptions& options) {
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

Result<void> ParseSamples(const OptionRow& row, const Json& json, RunOptions& options) {
  auto samples = ParseInteger(json, row.name, static_cast<int>(row.low), static_cast<int>(row.high));
  if (!samples) return samples.error();
  // Pixels are square, so a grid that is much finer along one axis wastes its samples.
  const SampleGrid grid = EvenSampleGrid(samples.value());
  if (std::max(grid.x, grid.y) > 2 * std::min(grid.x, grid.y)) {
    std::string allowed;
    for (int n = 1; n <= 64; ++n) {
      const SampleGrid other = EvenSampleGrid(n);
      if (std::max(other.x, other.y) <= 2 * std::min(other.x, other.y)) allowed += " " + std::to_string(n);
    }
    return BadUsage("samples is " + Quoted(json) + ", which makes no near-square grid; use one of" + allowed);
  }
  options.samples = samples.value();
  return {};
}

Result<void> ParseCameras(const OptionRow&, const Json& json, RunOptions& options) {
  options.cameras = json.is_array() ? json : Json::array({json});
  if (options.cameras.empty()) return BadUsage("camera is an empty list");
  for (const Json& camera : options.cameras) {
    if (!camera.is_object()) return BadUsage("camera is " + Quoted(camera) + ", but must be an object");
  }
  return {};
}

Result<void> ParseViews(const OptionRow&, const Json& json, RunOptions& options) {
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

// Parses a unit, given by its name or by its length in millimetres, as a number or as text.
Result<void> ParseUnit(const OptionRow&, const Json& json, RunOptions& options) {
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

Result<void> ParseAovs(const OptionRow& row, const Json& json, RunOptions& options) {
  auto aovs = ParseWords(json, "aov");
  if (!aovs) return aovs.error();
  for (const std::string& aov : aovs.value()) {
    if (std::find(row.choices.begin(), row.choices.end(), aov) == row.choices.end())
      return BadUsage("there is no AOV \"" + aov + "\"; the AOVs are " + Joined(row.choices));
  }
  options.aovs = std::move(aovs).value();
  return {};
}

// Parses the methods. A method with the same number may occur only once, because file names contain its name.
Result<std::vector<MethodChoice>> ParseMethods(const OptionRow& row, const Json& json) {
  auto words = ParseWords(json, row.name);
  if (!words) return words.error();
  std::vector<MethodChoice> choices;
  for (const std::string& word : words.value()) {
    auto choice = ParseMethod(word, row.name);
    if (!choice) return choice.error();
    for (const MethodChoice& other : choices)
      if (other.Name() == choice.value().Name())
        return BadUsage(row.name + " lists \"" + FormatMethod(other) + "\" twice");
    choices.push_back(choice.value());
  }
  return choices;
}

// Parses numbers of voxels, and at the end at most one name of an encoding.
Result<void> ParseVoxelsBeside(const OptionRow& row, const Json& json, RunOptions& options) {
  auto words = ParseWords(json, row.name);
  if (!words) return words.error();
  std::string encodings;
  bool has_encoding = false;
  for (const VoxelEncoding& encoding : VoxelEncodings()) {
    encodings += (encodings.empty() ? "" : ", ") + std::string(encoding.name);
    if (words.value().empty() || words.value().back() != encoding.name) continue;
    options.voxel_encoding = encoding.name;
    has_encoding = true;
  }
  if (has_encoding) words.value().pop_back();
  std::vector<MethodChoice> choices;
  for (const std::string& word : words.value()) {
    const bool digits =
        !word.empty() && word.size() <= 5 && word.find_first_not_of("0123456789") == std::string::npos;
    const int number = digits ? std::stoi(word) : 0;
    if (number < 2 || number > kMostVoxelsPerAxis)
      return BadUsage(row.name + " lists \"" + word + "\", which is no number of voxels from 2 to " +
                      std::to_string(kMostVoxelsPerAxis) +
                      "; at the end it may name an encoding: " + encodings);
    auto choice = ParseMethod("voxels:" + std::to_string(number), row.name);
    if (!choice) return choice.error();
    choices.push_back(choice.value());
  }
  if (has_encoding && choices.empty())
    return BadUsage(row.name + " names an encoding, but no number of voxels; write for example 128," +
                    options.voxel_encoding);
  options.voxels_beside = std::move(choices);
  return {};
}

Json MethodsJson(const std::vector<MethodChoice>& methods) {
  Json choices = Json::array();
  // A choice without a number means the method's usual ones.
  for (const MethodChoice& choice : methods)
    choices.push_back(choice.given ? FormatMethod(choice) : choice.method->name);
  return choices;
}

// Parses "N", "N,RADIUS", a number, or an object with rays and radius_mm.
Result<void> ParseOcclusion(const OptionRow& row, const Json& json, RunOptions& options) {
  const Error error =
      BadUsage("ambient_occlusion is " + Quoted(json) + ", but must be N or N,R: 0 to " +
               std::to_string(kMostOcclusionRays) + " rays per sample, and a radius R above 0 in mm");
  Json rays = json, radius = 0;
  if (json.is_string()) {
    auto numbers = ParseNumbers(json, row.name, 0, row.high);
    if (!numbers || numbers.value().size() > 2) return error;
    rays = numbers.value()[0];
    if (numbers.value().size() == 2) radius = numbers.value()[1];
    if (numbers.value().size() == 2 && !(numbers.value()[1] > 0)) return error;
  } else if (json.is_object()) {
    for (const auto& [key, value] : json.items())
      if (key != "rays" && key != "radius_mm") return error;
    rays = json.value("rays", Json());
    if (json.contains("radius_mm")) {
      radius = json["radius_mm"];
      if (!radius.is_number() || !(radius.get<double>() > 0)) return error;
    }
  }
  if (!rays.is_number()) return error;
  const double count = rays.get<double>();
  if (!(count >= 0 && count <= kMostOcclusionRays) || count != std::floor(count)) return error;
  options.light.occlusion_rays = static_cast<int>(count);
  options.light.occlusion_radius_mm = radius.get<double>();
  return {};
}

// Parses "face", "part" or "#rrggbb".
Result<Coloring> ParseColoring(const Json& json) {
  const std::string text = json.is_string() ? json.get<std::string>() : "";
  if (text == "face") return Coloring{};
  if (text == "part") return Coloring{ColorSource::kPart, {}};
  std::uint32_t rgb = 0;
  const char* const end = text.data() + text.size();
  if (text.size() == 7 && text[0] == '#') {
    const auto parsed = std::from_chars(text.data() + 1, end, rgb, 16);
    if (parsed.ec == std::errc{} && parsed.ptr == end) {
      const auto channel = [rgb](int shift) { return static_cast<float>(rgb >> shift & 255u) / 255.0f; };
      return Coloring{ColorSource::kOne, {channel(16), channel(8), channel(0)}};
    }
  }
  return BadUsage("color is " + Quoted(json) + ", but must be face, part or a colour such as #c8b496");
}

// Parses one pattern or a list of patterns. A text is one pattern, because names may contain commas.
Result<std::vector<std::string>> ParsePatterns(const Json& json, const std::string& name) {
  auto patterns = ParseWords(json.is_string() ? Json::array({json}) : json, name);
  if (!patterns) return patterns.error();
  for (const std::string& pattern : patterns.value())
    if (pattern.empty()) return BadUsage(name + " holds an empty name, which would be everybody's");
  return patterns;
}

Json ColoringJson(const Coloring& coloring) {
  if (coloring.source == ColorSource::kFile) return "face";
  if (coloring.source == ColorSource::kPart) return "part";
  return {coloring.one.r, coloring.one.g, coloring.one.b};
}

Json SectionJson(const SectionRequest& request) {
  const Vec3 point = request.plane.point, normal = request.plane.normal;
  return {{point.x, point.y, point.z}, {normal.x, normal.y, normal.z}, request.axis, request.share};
}

}  // namespace

OptionBinding ViewsBinding() {
  return {ParseViews, [](const OptionRow&, const RunOptions& o) -> Json { return o.views; }};
}

OptionBinding CamerasBinding() {
  return {ParseCameras, [](const OptionRow&, const RunOptions& o) { return o.cameras; }};
}

OptionBinding SizeBinding() {
  return {ParseSize, [](const OptionRow&, const RunOptions& o) -> Json {
            return std::to_string(o.width) + "x" + std::to_string(o.height);
          }};
}

OptionBinding SamplesBinding() {
  return {ParseSamples, [](const OptionRow&, const RunOptions& o) -> Json { return o.samples; }};
}

OptionBinding ViewMemoryBinding() {
  constexpr double kMegabyte = 1 << 20;
  return {[](const OptionRow& row, const Json& json, RunOptions& o) -> Result<void> {
            auto number = ParseNumber(json, row.name, row.low, row.high);
            if (!number) return number.error();
            o.accuracy.max_bytes = static_cast<std::uint64_t>(number.value() * kMegabyte);
            return {};
          },
          [](const OptionRow&, const RunOptions& o) -> Json {
            return static_cast<double>(o.accuracy.max_bytes) / kMegabyte;
          }};
}

OptionBinding UnitBinding() {
  return {ParseUnit,
          [](const OptionRow&, const RunOptions& o) { return o.unit_mm > 0 ? Json(o.unit_mm) : Json(); }};
}

OptionBinding AovsBinding() {
  return {ParseAovs, [](const OptionRow&, const RunOptions& o) -> Json { return o.aovs; }};
}

OptionBinding WithBinding() {
  return {[](const OptionRow& row, const Json& json, RunOptions& o) {
            return StoreInto(ParseMethods(row, json), o.with);
          },
          [](const OptionRow&, const RunOptions& o) { return MethodsJson(o.with); }};
}

OptionBinding VoxelsBesideBinding() {
  return {ParseVoxelsBeside, [](const OptionRow&, const RunOptions& o) {
            Json words = Json::array();
            for (const MethodChoice& choice : o.voxels_beside)
              words.push_back(std::to_string(std::lround(choice.setting)));
            if (!words.empty()) words.push_back(o.voxel_encoding);
            return words;
          }};
}

OptionBinding MethodsBinding() {
  return {[](const OptionRow& row, const Json& json, RunOptions& o) {
            Json words = json;
            if (json == "all" || json == Json::array({"all"})) {
              words = Json::array();
              // The sweep has the settings of our own tracer anyway; methods with a number are other representations.
              for (const Method* method : Methods())
                if (method->solver != nullptr) words.push_back(method->name);
            }
            return StoreInto(ParseMethods(row, words), o.trade.methods);
          },
          [](const OptionRow&, const RunOptions& o) { return MethodsJson(o.trade.methods); }};
}

OptionBinding MethodBinding() {
  return {[](const OptionRow& row, const Json& json, RunOptions& o) -> Result<void> {
            auto index = ParseWord(json, row.name, row.choices);
            if (!index) return index.error();
            return StoreInto(ParseMethod(row.choices[static_cast<std::size_t>(index.value())], row.name),
                             o.method);
          },
          [](const OptionRow&, const RunOptions& o) -> Json { return o.method.method->name; }};
}

OptionBinding StructureBinding() {
  return {[](const OptionRow& row, const Json& json, RunOptions& o) -> Result<void> {
            auto index = ParseWord(json, row.name, row.choices);
            if (!index) return index.error();
            o.light.structure = row.choices[static_cast<std::size_t>(index.value())];
            o.solver.structure =
                o.light.structure == kUsualStructure ? kUsualSolverStructure : o.light.structure;
            return {};
          },
          [](const OptionRow&, const RunOptions& o) -> Json { return o.light.structure; }};
}

OptionBinding ShadeBinding() {
  return {[](const OptionRow&, const Json& json, RunOptions& o) {
            return StoreInto(ParseShade(json), o.inspection);
          },
          [](const OptionRow&, const RunOptions& o) -> Json { return FormatInspection(o.inspection); }};
}

OptionBinding OcclusionBinding() {
  return {ParseOcclusion, [](const OptionRow&, const RunOptions& o) -> Json {
            return {o.light.occlusion_rays, o.light.occlusion_radius_mm};
          }};
}

OptionBinding MaterialsBinding() {
  return {[](const OptionRow& row, const Json& json, RunOptions& o) -> Result<void> {
            auto texts = ParsePatterns(json, row.name);
            if (!texts) return texts.error();
            std::vector<MaterialRule> rules;
            for (const std::string& text : texts.value()) {
              auto rule = ParseMaterial(text);
              if (!rule) return rule.error();
              rules.push_back(std::move(rule).value());
            }
            o.light.materials = std::move(rules);
            return {};
          },
          [](const OptionRow&, const RunOptions& o) -> Json {
            Json rules = Json::array();
            for (const MaterialRule& rule : o.light.materials) rules.push_back(FormatMaterial(rule));
            return rules;
          }};
}

OptionBinding SectionsBinding() {
  return {[](const OptionRow&, const Json& json, RunOptions& o) {
            return StoreInto(ParseSections(json), o.sections);
          },
          [](const OptionRow&, const RunOptions& o) {
            Json planes = Json::array();
            for (const SectionRequest& request : o.sections) planes.push_back(SectionJson(request));
            return planes;
          }};
}

OptionBinding PointLightsBinding() {
  return {
      [](const OptionRow& row, const Json& json, RunOptions& o) -> Result<void> {
        std::vector<PointLight> lights;
        for (const Json& light : json.is_array() ? json : Json::array({json})) {
          const Result<std::vector<double>> parsed = ParseNumbers(light, row.name, -1e12, 1e12);
          if (!parsed) return parsed.error();
          const std::vector<double>& n = parsed.value();
          if (n.size() != 3 && n.size() != 6)
            return BadUsage(row.name + " is X,Y,Z in mm, and may have a color R,G,B; it has " +
                            std::to_string(n.size()) + " numbers");
          PointLight point{.at = {n[0], n[1], n[2]}};
          if (n.size() == 6) point.color = {n[3], n[4], n[5]};
          if (point.color.x < 0 || point.color.y < 0 || point.color.z < 0)
            return BadUsage(row.name + ": no channel of the color of a light may be negative");
          lights.push_back(point);
        }
        o.voxel_picture.lights = std::move(lights);
        return {};
      },
      [](const OptionRow&, const RunOptions& o) {
        Json lights = Json::array();
        for (const PointLight& light : o.voxel_picture.lights)
          lights.push_back({light.at.x, light.at.y, light.at.z, light.color.x, light.color.y, light.color.z});
        return lights;
      }};
}

OptionBinding ColorBinding() {
  return {[](const OptionRow&, const Json& json, RunOptions& o) {
            return StoreInto(ParseColoring(json), o.picture.coloring);
          },
          [](const OptionRow&, const RunOptions& o) { return ColoringJson(o.picture.coloring); }};
}

OptionBinding TurntableBinding() {
  return {[](const OptionRow& row, const Json& json, RunOptions& o) -> Result<void> {
            auto frames = ParseInteger(json, row.name, static_cast<int>(row.low), static_cast<int>(row.high));
            if (!frames) return frames.error();
            if (frames.value() == 1) return BadUsage("turntable is 1, but a turn has at least 2 frames");
            o.picture.turntable = frames.value();
            return {};
          },
          [](const OptionRow&, const RunOptions& o) -> Json { return o.picture.turntable; }};
}

OptionBinding PatternsBinding(std::vector<std::string> ArrangementRequest::*member) {
  return {[member](const OptionRow& row, const Json& json, RunOptions& o) {
            return StoreInto(ParsePatterns(json, row.name), o.picture.arrangement.*member);
          },
          [member](const OptionRow&, const RunOptions& o) -> Json { return o.picture.arrangement.*member; }};
}

}  // namespace facetless
