#include "server/options/picture_options.h"

#include <charconv>
#include <functional>
#include <map>

#include "server/options/option_values.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using Parser = std::function<Result<void>(const Json&, PictureOptions&)>;

constexpr int kMostFrames = 360;
// Farther apart, an assembly is dust.
constexpr double kMostExplode = 100;

template <typename Parsed, typename Target>
Result<void> Store(Parsed parsed, Target& target) {
  if (!parsed) return parsed.error();
  target = std::move(parsed).value();
  return {};
}

Result<UpAxis> ParseUp(const Json& json) {
  auto index = ParseWord(json, "up", {"x", "y", "z"});
  if (!index) return index.error();
  return static_cast<UpAxis>(index.value());
}

// "face", "part" or "#rrggbb".
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

// A pattern, or a list of them: a comma may belong to a name.
Result<std::vector<std::string>> ParsePatterns(const Json& json, const std::string& name) {
  auto patterns = ParseWords(json.is_string() ? Json::array({json}) : json, name);
  if (!patterns) return patterns.error();
  for (const std::string& pattern : patterns.value())
    if (pattern.empty()) return BadUsage(name + " holds an empty name, which would be everybody's");
  return patterns;
}

Parser BoolParser(const char* name, bool PictureOptions::*member) {
  return [=](const Json& json, PictureOptions& o) { return Store(ParseBool(json, name), o.*member); };
}

const std::map<std::string, Parser>& Parsers() {
  static const std::map<std::string, Parser> parsers = {
      {"margin",
       [](const Json& json, PictureOptions& o) {
         return Store(ParseNumber(json, "margin", 0, kMostMargin), o.margin);
       }},
      {"up", [](const Json& json, PictureOptions& o) { return Store(ParseUp(json), o.up); }},
      {"color", [](const Json& json, PictureOptions& o) { return Store(ParseColoring(json), o.coloring); }},
      {"parts", [](const Json& json,
                   PictureOptions& o) { return Store(ParsePatterns(json, "parts"), o.arrangement.parts); }},
      {"hide", [](const Json& json,
                  PictureOptions& o) { return Store(ParsePatterns(json, "hide"), o.arrangement.hide); }},
      {"explode",
       [](const Json& json, PictureOptions& o) {
         return Store(ParseNumber(json, "explode", 0, kMostExplode), o.arrangement.explode);
       }},
      {"show_hidden",
       [](const Json& json, PictureOptions& o) {
         return Store(ParseBool(json, "show_hidden"), o.arrangement.show_hidden);
       }},
      {"scale_bar", BoolParser("scale_bar", &PictureOptions::scale_bar)},
      {"axes", BoolParser("axes", &PictureOptions::axes)},
      {"sheet", BoolParser("sheet", &PictureOptions::sheet)},
      {"turntable",
       [](const Json& json, PictureOptions& o) -> Result<void> {
         auto frames = ParseInteger(json, "turntable", 0, kMostFrames);
         if (!frames) return frames.error();
         if (frames.value() == 1) return BadUsage("turntable is 1, but a turn has at least 2 frames");
         o.turntable = frames.value();
         return {};
       }},
      {"turntable_seconds",
       [](const Json& json, PictureOptions& o) {
         return Store(ParseNumber(json, "turntable_seconds", 0.1, 600), o.turntable_s);
       }},
  };
  return parsers;
}

}  // namespace

const std::vector<std::string>& PictureOptionNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, parser] : Parsers()) all.push_back(name);
    return all;
  }();
  return names;
}

Result<void> ParsePictureOption(const std::string& name, const Json& json, PictureOptions& options) {
  return Parsers().at(name)(json, options);
}

Result<void> CheckPictureOptions(const PictureOptions& options, const std::string& command) {
  if (command == "render") return {};
  if (options.turntable > 0)
    return BadUsage("turntable is an option of render; " + command + " takes views one by one");
  if (command == "compare") return {};
  const std::pair<const char*, bool> given[] = {{"color", options.coloring.source != ColorSource::kFile},
                                                {"parts", !options.arrangement.parts.empty()},
                                                {"hide", !options.arrangement.hide.empty()},
                                                {"explode", options.arrangement.explode > 0},
                                                {"scale_bar", options.scale_bar},
                                                {"axes", options.axes},
                                                {"sheet", options.sheet}};
  for (const auto& [name, is] : given)
    if (is)
      return BadUsage(std::string(name) + " is an option of render and compare; " + command +
                      " takes models as they are");
  return {};
}

}  // namespace facetless
